"""The intensity over the focus by light paths, for a scheme whose own has no peak there."""

from octsim.config.derive import by_light_paths
from octsim.config.models import Config
from octsim.datasets.layout import Layout
from octsim.datasets.streams import Stream, Streamed
from octsim.instrument.points import Points
from octsim.stages.focus_sweep import law_foci, swept_foci
from octsim.stages.scatter import WHOLE, Share


@Streamed
def ray_focus_sweep(
    config: Config, threads: int = 1, points: Points | None = None, share: Share = WHOLE
) -> Stream:
    """Measure the intensity at fractions of the diameter by light paths.

    By Maxwell's equations it mostly has no peak over the fractions that a focus law could be fitted
    to.

    Returns
    -------
    Dataset
        As that of `focus_sweep`, by scheme paths, for combinations of schemes without rays.

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "tracing": {"preset": "exact"},
    ...         "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
    ...     }
    ... )
    >>> dict(octsim.ray_focus_sweep(config).sizes)
    {'diameter': 3, 'fraction': 9}
    """
    title = "Intensity over the focus by light paths, for the focus law of a scheme without rays"
    layout = Layout("ray_focus_sweep", config, title, law_foci, "diameter")
    parts = swept_foci(layout, by_light_paths, points or Points(), threads, share)
    return Stream(layout, parts)
