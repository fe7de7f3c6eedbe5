"""A cell's light paths in both trees, octsim's and that of 50 digits, and their conditioning."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.instrument.build import detector_of, scene_of
from octsim.optics.beam import Beam, aim, vogel_beam
from octsim.studies.stability.exact import (
    End,
    Inputs,
    follow,
    inputs_of,
    numbers,
    sensitivities,
    tree,
)
from octsim.studies.stability.matrix import Cell, spiral
from octsim.studies.stability.verdict import EPSILON, NOTHING, SAFETY
from octsim.tracing.tree import Detections, trace

RAYS = 100
"""Most rays of a cell that are traced with 50 digits."""


@dataclass(frozen=True)
class Case:
    """A cell made ready: its config, its rays' positions (µm) and what octsim detects."""

    cell: Cell
    config: Config
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    beam: Beam
    detections: Detections
    k_max: float

    def inputs(self, ray: int, diameter: float | None = None) -> Inputs:
        """Return the exact inputs of a ray by its number, maybe for another diameter (µm)."""
        at = float(self.x[ray]), float(self.y[ray])
        return inputs_of(self.config, diameter or self.cell.diameter, self.cell.focus, *at)


def traced(config: Config, beam: Beam, diameter: float, focus: float) -> Detections:
    """Return some rays of a diameter and a focus (µm), traced as octsim does."""
    scene = scene_of(config, diameter)
    return trace(scene, beam, detector_of(config), focus, config.tracing.max_intersections)


def prepared(cell: Cell, config: Config) -> Case:
    """Return a cell with its rays launched and traced as octsim does."""
    x, y = (cell.positions or spiral)(config, cell)
    if cell.positions is None:
        detector = detector_of(config)
        beam = vogel_beam(config.tracing.rays, detector.objective_radius, detector.focus_distance)
    else:
        launched = np.full(x.size, 1 / max(x.size, 1)), np.arange(x.size)
        beam = Beam(*aim(x, y, config.objective.focus_distance), *launched)
    k_max = float(config.spectrum.wavenumbers()[-1])
    detections = traced(config, beam, cell.diameter, cell.focus)
    return Case(cell, config, x, y, beam, detections, k_max)


def sample(case: Case, most: int) -> list[int]:
    """Return at most so many rays: two thirds of them detected ones, the others evenly."""
    if case.x.size <= most:
        return list(range(case.x.size))
    seen = np.unique(case.detections.ray)
    if seen.size:
        seen = seen[np.unique(np.linspace(0, seen.size - 1, 2 * most // 3).astype(int))]
    evenly = np.linspace(0, case.x.size - 1, most - seen.size).astype(int)
    return [int(ray) for ray in np.union1d(seen, evenly)]


Key = tuple[int, int]  # number of the ray, code of the path


class Pair(NamedTuple):
    """A light path in both trees; amplitudes are relative to launch."""

    key: Key
    end: End
    amplitude: float
    path: float


class ConditionNumbers(NamedTuple):
    """Condition numbers Σ|x ∂/∂x| of a light path, over all inputs x."""

    phase: float
    """rad."""
    amplitude: float
    """Relative to the amplitude."""
    margins: tuple[float, ...]
    """Of each decision."""


class Conditions:
    """Condition numbers by perturbing every input of the 50-digit run, each path's only once."""

    def __init__(self, case: Case) -> None:
        self._case = case
        self._known: dict[Key, ConditionNumbers] = {}

    def of(self, key: Key) -> ConditionNumbers:
        """Return the condition numbers of a path."""
        if key not in self._known:
            given = self._case.inputs(key[0])
            end = follow(given, key[1])
            path = amplitude = numbers.mpf(0)
            margins = [numbers.mpf(0)] * len(end.margins)
            for scale, other in sensitivities(given, key[1]):
                path += scale * abs(other.path - end.path)
                amplitude += scale * abs(other.amplitude - end.amplitude)
                pairs = zip(end.margins, other.margins, strict=False)
                for i, ((_, one), (_, two)) in enumerate(pairs):
                    margins[i] += scale * abs(two - one)
            is_light = abs(end.amplitude) > NOTHING
            relative = amplitude / abs(end.amplitude) if is_light else amplitude
            self._known[key] = ConditionNumbers(
                float(path) * self._case.k_max, float(relative), tuple(map(float, margins))
            )
        return self._known[key]

    def at_edge(self, key: Key) -> bool:
        """Return whether a decision on a path is one that rounding can take: |margin| ≤ 8 ε κ."""
        allowed, end = self.of(key).margins, follow(self._case.inputs(key[0]), key[1])
        return any(
            abs(margin) <= SAFETY * EPSILON * condition
            for (_, margin), condition in zip(end.margins, allowed, strict=True)
        )


def compared(case: Case, rays: list[int], conditions: Conditions) -> tuple[list[Pair], int, str]:
    """Return the pairs of octsim's rays with 50 digits', the number at an edge, and a lost path.

    The text names a path that one tree alone has without being at an edge, empty if there is none.
    """
    chosen = np.isin(case.detections.ray, rays)
    fast = {
        (ray, code): (amplitude * case.x.size, path)
        for ray, code, amplitude, path in zip(
            case.detections.ray[chosen].tolist(),
            case.detections.path[chosen].tolist(),
            case.detections.amplitude[chosen].tolist(),
            case.detections.optical_path_length[chosen].tolist(),
            strict=True,
        )
    }
    most = case.config.tracing.max_intersections
    slow = {(ray, end.code): end for ray in rays for end in tree(case.inputs(ray), most)}
    edges, lost = 0, ""
    for key in sorted(fast.keys() ^ slow.keys()):
        if conditions.at_edge(key):
            edges += 1
        else:
            tree_of = "octsim" if key in fast else "50 digits"
            lost = f"ray {key[0]}, path {key[1]} is detected by {tree_of} alone"
    pairs = [Pair(key, end, *fast[key]) for key, end in slow.items() if key in fast]
    return pairs, edges, lost
