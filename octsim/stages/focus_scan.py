"""Where the light is: the intensity over the focus, for one diameter (figure 6)."""

from collections.abc import Iterator

import numpy as np

from octsim.base.threads import each_block
from octsim.config.derive import counting_rays
from octsim.config.following import scan_diameter, scan_foci
from octsim.config.grid import Combination
from octsim.config.models import Config
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.instrument.instrument import Brightness, Instrument
from octsim.instrument.points import Points
from octsim.stages.focus_sweep import brightness_variables
from octsim.stages.scatter import WHOLE, Share


class _Scanner:
    """Looks at the points of a scan: their intensity, and the rays that are counted."""

    def __init__(self, config: Config, points: Points) -> None:
        self._instrument = Instrument(config, points)
        # whatever the scheme of the intensity, rays are counted on the thesis's spiral
        counts = self._instrument.scheme.counts_rays
        self._counting = self._instrument if counts else Instrument(counting_rays(config), points)

    def __call__(self, diameter: float, focus: float) -> tuple[Brightness, int]:
        counted = self._counting.rays(diameter, focus)
        same = self._counting is self._instrument
        light = counted if same else self._instrument.light(diameter, focus)
        return self._instrument.brightness(light), counted.amplitude.size


@Streamed
def focus_scan(
    config: Config, threads: int = 1, points: Points | None = None, share: Share = WHOLE
) -> Stream:
    """Scan the focus for one diameter (figure 6).

    Rays are counted on the thesis's spiral, whatever the scheme of the intensity.

    Returns
    -------
    Dataset
        intensity(focus), the mean over the band, its estimated error and whether that is as asked,
        and rays_detected(focus).

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {"tracing": {"rays": 200}, "focus_scan": {"focus": {"num": 5}}}
    ... )
    >>> scan = octsim.focus_scan(config)
    >>> scan["focus"].values.tolist()
    [-1.0, 0.25, 1.5, 2.75, 4.0]
    """

    def own(config: Config) -> dict[str, Coordinate]:
        return {"focus": ("focus", scan_foci(config).values())}

    layout = Layout(
        "focus_scan", config, "Intensity and number of detected rays over the focus, for one "
        "diameter", own, "focus",
    )  # fmt: skip
    return Stream(layout, _scanned(layout, points or Points(), threads, share))


def _scanned(layout: Layout, points: Points, threads: int, share: Share) -> Iterator[Part]:
    def points_of(block: tuple[Combination, slice]) -> Iterator[tuple[_Scanner, float, float]]:
        at, span = block
        scanner, diameter = _Scanner(at.config, points), scan_diameter(at.config)
        return ((scanner, diameter, z) for z in layout.own[at.position]["focus"][1][span].tolist())

    blocks = share.blocks(layout)
    for (at, span), found in each_block(lambda p: p[0](p[1], p[2]), blocks, points_of, threads):
        light, rays = zip(*found, strict=True)
        variables = {
            **brightness_variables(("focus",), (len(found),), list(light)),
            "rays_detected": ("focus", np.array(rays)),
            "diameter": scan_diameter(at.config),
        }
        yield Part(at, span.start, span.stop - span.start, variables)
