"""Where the light is: the intensity over the focus, for one diameter and for several (figure 6)."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from octsim.base.threads import each_block
from octsim.config.grid import Combination
from octsim.config.models import Config
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.stage import Part, Stage, Stream
from octsim.instrument.instrument import Brightness, Tracer, meter
from octsim.instrument.points import Points
from octsim.schemes.light import AccuracyStatus, Light
from octsim.stages.scatter import WHOLE, Share


class _Scanner(NamedTuple):
    """What a point of the scan is looked at with."""

    trace: Tracer
    measure: Any
    spiral: Tracer | None
    """Traces the rays that are counted, where the intensity does not come from those."""

    def __call__(self, diameter: float, focus: float) -> tuple[Brightness, int]:
        light = self.trace(diameter, focus)
        counted = light if self.spiral is None else self.spiral(diameter, focus)
        return self.measure(light), counted.amplitude.size


def _scanner(config: Config, points: Points) -> _Scanner:
    spiral = None
    if config.tracing.scheme != "vogel":
        tracing = config.tracing.model_copy(update={"scheme": "vogel"})
        spiral = points.tracer(config.model_copy(update={"tracing": tracing}))
    return _Scanner(points.tracer(config), meter(config), spiral)


def _brightness(
    dimensions: tuple[str, ...], shape: tuple[int, ...], found: list[Brightness]
) -> dict[str, Any]:
    mean, error, status = (np.array(values).reshape(shape) for values in zip(*found, strict=True))
    return {
        "intensity": (dimensions, mean),
        "intensity_error": (dimensions, error),
        "accuracy_status": (dimensions, *flags(AccuracyStatus, status)),
    }


@Stage
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
    """
    whence = points or Points()

    def own(config: Config) -> dict[str, Coordinate]:
        return {"focus": ("focus", config.focus_scan.focus.values())}

    layout = Layout(
        "focus_scan", config, "Intensity and number of detected rays over the focus, for one "
        "diameter", __name__, own, "focus",
    )  # fmt: skip
    return Stream(layout, _scanned(layout, whence, threads, share))


def _scanned(layout: Layout, whence: Points, threads: int, share: Share) -> Iterator[Part]:
    def points_of(block: tuple[Combination, slice]) -> Iterator[tuple[_Scanner, float, float]]:
        at, span = block
        scanner, diameter = _scanner(at.config, whence), at.config.focus_scan.diameter
        return ((scanner, diameter, z) for z in layout.own[at.position]["focus"][1][span].tolist())

    blocks = share.blocks(layout)
    for (at, span), found in each_block(lambda p: p[0](p[1], p[2]), blocks, points_of, threads):
        light, rays = zip(*found, strict=True)
        variables = {
            **_brightness(("focus",), (len(found),), list(light)),
            "rays_detected": ("focus", np.array(rays)),
            "diameter": at.config.focus_scan.diameter,
        }
        yield Part(at, span.start, span.stop - span.start, variables)


@Stage
def focus_sweep(
    config: Config, threads: int = 1, points: Points | None = None, share: Share = WHOLE
) -> Stream:
    """Measure the intensity at fractions of the diameter, for the diameters of the focus law.

    Returns
    -------
    Dataset
        intensity, its estimated error and whether that is as asked, focus (diameter, fraction).
    """
    whence = points or Points()

    def own(config: Config) -> dict[str, Coordinate]:
        law = config.focus_law
        return {
            "diameter": ("diameter", law.diameters.values()),
            "fraction": ("fraction", law.fraction.values()),
        }

    layout = Layout(
        "focus_sweep", config, "Intensity over the focus, for the diameters of the focus law",
        __name__, own, "diameter",
    )  # fmt: skip
    return Stream(layout, _swept(layout, whence, threads, share))


def _swept(layout: Layout, whence: Points, threads: int, share: Share) -> Iterator[Part]:
    def foci(at: Combination, span: slice) -> Any:
        own = layout.own[at.position]
        return np.outer(own["diameter"][1][span], own["fraction"][1])

    def points_of(block: tuple[Combination, slice]) -> Iterator[tuple[Any, Any, float, float]]:
        at, span = block
        trace_at, measure = whence.tracer(at.config), meter(at.config)
        diameters = layout.own[at.position]["diameter"][1][span].tolist()
        for diameter, row in zip(diameters, foci(at, span).tolist(), strict=True):
            yield from ((trace_at, measure, diameter, focus) for focus in row)

    def measured(point: tuple[Any, Any, float, float]) -> Brightness:
        trace_at, measure, diameter, focus = point
        light: Light = trace_at(diameter, focus)
        found: Brightness = measure(light)
        return found

    blocks = share.blocks(layout)
    dimensions = ("diameter", "fraction")
    for (at, span), found in each_block(measured, blocks, points_of, threads):
        heights = foci(at, span)
        variables = _brightness(dimensions, heights.shape, found) | {"focus": (dimensions, heights)}
        yield Part(at, span.start, span.stop - span.start, variables)
