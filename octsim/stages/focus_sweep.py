"""The intensity over the focus, for the diameters of the focus law."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.base.threads import each_block
from octsim.config.following import fitted_diameters
from octsim.config.grid import Combination
from octsim.config.models import Config
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.instrument.instrument import Brightness, Instrument
from octsim.instrument.points import Points
from octsim.schemes.light import AccuracyStatus
from octsim.stages.scatter import WHOLE, Share


def brightness_variables(
    dimensions: tuple[str, ...], shape: tuple[int, ...], found: list[Brightness]
) -> dict[str, Any]:
    """Return the variables of some points' intensities, arranged in a shape."""
    mean, error, status = (np.array(values).reshape(shape) for values in zip(*found, strict=True))
    return {
        "intensity": (dimensions, mean),
        "intensity_error": (dimensions, error),
        "accuracy_status": (dimensions, *flags(AccuracyStatus, status)),
    }


@Streamed
def focus_sweep(
    config: Config, threads: int = 1, points: Points | None = None, share: Share = WHOLE
) -> Stream:
    """Measure the intensity at fractions of the diameter, for the diameters of the focus law.

    Returns
    -------
    Dataset
        intensity, its estimated error and whether that is as asked, focus (diameter, fraction).

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "tracing": {"rays": 200},
    ...         "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
    ...     }
    ... )
    >>> dict(octsim.focus_sweep(config).sizes)
    {'diameter': 3, 'fraction': 9}
    """
    title = "Intensity over the focus, for the diameters of the focus law"
    layout = Layout("focus_sweep", config, title, law_foci, "diameter")
    return Stream(layout, swept_foci(layout, lambda of: of, points or Points(), threads, share))


def law_foci(config: Config) -> dict[str, Coordinate]:
    """Return the coordinates of a dataset over the focus law's diameters and fractions."""
    return {
        "diameter": ("diameter", fitted_diameters(config).values()),
        "fraction": ("fraction", config.focus_law.fraction.values()),
    }


def swept_foci(
    layout: Layout,
    seen_by: Callable[[Config], Config],
    points: Points,
    threads: int,
    share: Share,
) -> Iterator[Part]:
    """Measure the intensity at every diameter and fraction, block after block.

    Parameters
    ----------
    layout : Layout
        Of the dataset that it is kept in.
    seen_by : callable
        Returns the config whose instrument looks, of a combination's.
    points, threads, share
        Where light is kept, how many threads find it, and which share of it is asked for.
    """

    def foci(at: Combination, span: slice) -> NDArray[np.float64]:
        own = layout.own[at.position]
        return np.outer(own["diameter"][1][span], own["fraction"][1])

    def points_of(block: tuple[Combination, slice]) -> Iterator[tuple[Instrument, float, float]]:
        at, span = block
        instrument = Instrument(seen_by(at.config), points)
        diameters = layout.own[at.position]["diameter"][1][span].tolist()
        for diameter, row in zip(diameters, foci(at, span).tolist(), strict=True):
            yield from ((instrument, diameter, focus) for focus in row)

    def measured(point: tuple[Instrument, float, float]) -> Brightness:
        instrument, diameter, focus = point
        return instrument.brightness(instrument.light(diameter, focus))

    blocks = share.blocks(layout)
    dimensions = ("diameter", "fraction")
    for (at, span), found in each_block(measured, blocks, points_of, threads):
        heights = foci(at, span)
        variables = brightness_variables(dimensions, heights.shape, found)
        variables["focus"] = dimensions, heights
        yield Part(at, span.start, span.stop - span.start, variables)
