"""The cells of the stability matrix: one factor at a time from the default and a few corners."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.instrument.build import detector_of
from octsim.optics.beam import vogel_spiral
from octsim.studies.stability.exact import follow, inputs_of

Overlay = Mapping[str, Any]
Positions = NDArray[np.float64]

DIAMETER, FOCUS = 1.4, 0.876  # µm, about the thesis's focus law
NEIGHBOURS = (0, 1, 2, 5, 50, 5000)
"""Rays taken on either side of an edge, in units of the last place."""
WIDE = {"detector": {"core_diameter": "4 mm"}}  # an image of 100 µm: all that returns is seen


@dataclass(frozen=True)
class Cell:
    """One configuration to trace; `positions` (x, y) on the objective if not the config's own."""

    corner: str
    factor: str
    value: str
    overlays: tuple[Overlay, ...]
    diameter: float = DIAMETER
    focus: float = FOCUS
    positions: Callable[[Config, "Cell"], tuple[Positions, Positions]] | None = None

    @property
    def name(self) -> str:
        """Name of the cell: corner / factor / value."""
        return f"{self.corner} / {self.factor} / {self.value}"

    def config(self, base: Config) -> Config:
        """Return the cell's config.

        Raises
        ------
        ConfigError
            If octsim refuses it.
        """
        line = {"sweep": {"focus": {"slope": 0, "intercept": f"{self.focus!r} um"}}}
        scan = {
            "focus_scan": {
                "diameter": f"{self.diameter!r} um",
                "focus": {"start": "-3 mm", "stop": "-2 mm"},
            },
            # nothing but the cell's own focus is to be out of reach
            "focus_law": {"fraction": {"start": -2.0, "stop": -1.0}},
        }
        return load_config(base.to_dict(), scan, line, *self.overlays)


def spiral(config: Config, _: Cell) -> tuple[Positions, Positions]:
    """Return the positions of the config's own rays."""
    radius = detector_of(config).objective_radius
    return vogel_spiral(config.tracing.rays, radius)


def axial(config: Config, _: Cell) -> tuple[Positions, Positions]:
    """Return rays on the axis, in the planes x = 0 and y = 0, and a hair's breadth off them."""
    radius = detector_of(config).objective_radius
    steps = np.concatenate(([0.0], radius * np.array([1e-300, 1e-17, 1e-12, 1e-6, 0.05, 0.5, 0.7])))
    x, y = np.meshgrid(steps, steps)
    return x.ravel(), y.ravel()


def beside_edge(
    code: int, decision: str, which: int = 0, bearings: tuple[float, ...] = (0.0, 0.02, 0.4)
) -> Callable[[Config, Cell], tuple[Positions, Positions]]:
    """Return the function that finds rays on both sides of where a decision on a path turns.

    Parameters
    ----------
    code : int
        Light path, as far as the decision.
    decision, which : str, int
        Name of the decision, and how many of that name come before it on the path.
    bearings : tuple of float
        Angles of the rays about the optical axis, from x, rad.
    """

    def find(config: Config, cell: Cell) -> tuple[Positions, Positions]:
        radius = detector_of(config).objective_radius
        x, y = [], []
        for bearing in bearings:
            across = np.tan(bearing)

            def margin(x: float, across: float = across) -> float | None:
                given = inputs_of(config, cell.diameter, cell.focus, x, x * across)
                margins = [m for name, m in follow(given, code).margins if name == decision]
                return float(margins[which]) if len(margins) > which else None

            low, high = 0.0, radius * np.cos(bearing)
            while np.nextafter(low, high) < high:
                middle = low + (high - low) / 2
                low, high = (middle, high) if (margin(middle) or -1) > 0 else (low, middle)
            if (margin(low) or -1) <= 0 or margin(high) is None or (margin(high) or 1) > 0:
                continue  # another decision comes first
            spacing = np.spacing(low)
            for steps in NEIGHBOURS:
                for at in (low - steps * spacing, high + steps * spacing):
                    x.append(float(at))
                    y.append(float(at * across))
        return np.array(x), np.array(y)

    return find


CORNERS: Mapping[str, tuple[Overlay, float, float]] = {
    # overlay, diameter, focus (µm)
    "default": ({}, DIAMETER, FOCUS),
    "touching, wide": (
        {"scene": {"gap": "0 nm"}, "objective": {"numerical_aperture": 1.5}, **WIDE},
        DIAMETER,
        0.01,
    ),
    "dense, wide": ({"scene": {"refractive_index": {"neuron": 3.33}}, **WIDE}, DIAMETER, FOCUS),
    "thin, wide": (WIDE, 1e-3, 1e-3),
    "large": (
        {"objective": {"focus_distance": "1 m"}, "detector": {"core_diameter": "4 mm"}},
        1000.0,
        580.0,
    ),
}


def _index(**values: float) -> Overlay:
    return {"scene": {"refractive_index": values}}


def _objective(**values: object) -> Overlay:
    return {"objective": values}


def _factors(glass: float, water: float) -> Iterator[tuple[str, str, Overlay, dict[str, Any]]]:
    """Yield for each factor and value an overlay, and fields of the cell that change."""
    for gap in ("0 nm", "1e-6 nm", "1e-3 nm", "1 nm", "1 um", "30 um", "1 mm"):
        yield "gap", gap, {"scene": {"gap": gap}}, {}
    for text, diameter in {
        "1 nm": 1e-3, "10 nm": 1e-2, "100 nm": 0.1, "10 um": 10.0, "100 um": 100.0, "1 mm": 1e3,
    }.items():  # fmt: skip
        yield "diameter", text, {}, {"diameter": diameter}
        focused = {"diameter": diameter, "focus": 0.58 * diameter + 0.064}
        yield "diameter, focus on the law", text, {}, focused
    for contrast in (0.0, 1e-12, 1e-9, 1e-6, 1e-3, 2.0):
        yield "neuron − water", f"{contrast:g}", _index(neuron=water + contrast), {}
        yield "water − glass", f"{contrast:g}", _index(water=glass + contrast), {}
    for contrast in (1e-12, 1e-6):
        yield "glass − water", f"{contrast:g}", _index(water=glass - contrast), {}
    for text, aperture in {
        "1e-6": 1e-6, "1e-3": 1e-3, "0.1": 0.1, "n_water": water,
        "n_glass(1 − 1e-3)": glass * (1 - 1e-3), "n_glass(1 − 1e-9)": glass * (1 - 1e-9),
    }.items():  # fmt: skip
        yield "numerical aperture", text, _objective(numerical_aperture=aperture), {}
    for text, focus in {
        "−1 mm": -1e3, "−30 um": -30.0, "−1 um": -1.0, "0": 0.0, "1 nm": 1e-3, "3 um": 3.0,
        "30 um": 30.0, "1 mm": 1e3,
    }.items():  # fmt: skip
        yield "focus", text, {}, {"focus": focus}
    for distance in ("1 um", "10 um", "1 mm", "1 m"):
        yield "focus distance", distance, _objective(focus_distance=distance), {}
    for rays in (1, 2):
        yield "rays", str(rays), {"tracing": {"rays": rays}}, {}
    yield "rays", "axial", {}, {"positions": axial}
    wide = {"objective": {"numerical_aperture": 0.995 * glass}, **WIDE}
    yield "rays", "tangent", wide, {"positions": beside_edge(0b1_01_10, "meets the cylinder")}
    yield "rays", "critical, glass", wide, {"positions": beside_edge(0b1_01, "refracted")}
    light = {**wide, **_index(neuron=1 + (water - 1) / 2)}
    edge = beside_edge(0b1_01_11, "refracted", which=1)
    yield "rays", "critical, neuron", light, {"positions": edge}


def cells(base: Config) -> list[Cell]:
    """Return all cells of the matrix, from a base config."""
    of, k = base.scene.refractive_index.of, base.spectrum.middle
    glass, water = (of[name].index(k).real for name in ("glass", "water"))
    listed = []
    for corner, (overlay, diameter, focus) in CORNERS.items():
        start = {"diameter": diameter, "focus": focus}
        listed.append(Cell(corner, "none", "", (overlay,), diameter, focus))
        for factor, value, more, fields in _factors(glass, water):
            listed.append(Cell(corner, factor, value, (overlay, more), **(start | fields)))
    many = {"tracing": {"rays": 1_000_000}}
    listed.append(Cell("default", "rays", "1e6", (many,)))
    for samples in (2, 100_000):
        overlay = {"spectrum": {"samples": samples}}
        listed.append(Cell("default", "wavenumbers", f"{samples:g}", (overlay,)))
    far = {**WIDE, "scene": {"gap": "1 m"}}
    for value, diameter, overlay in (
        ("1 nm thick, gap 1 m", 1e-3, far),
        ("1 pm thick, gap 1 m", 1e-6, far),
        ("1 m thick", 1e6, WIDE),
    ):
        listed.append(Cell("default", "warned of", value, (overlay,), diameter, FOCUS))
    return listed
