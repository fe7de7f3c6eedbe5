"""The field of a point by dense grids of rays: slow, and without any of what scheme paths decides.

A coarse grid over the aperture goes through the whole tree; where neighbours tell that a path may
be detected between them, its rays are followed from a dense grid of midpoints and summed as they
come. No polynomial, no survey, no tile. Two grids of different steps tell the error.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.compiled import compiled
from octsim.base.records import room
from octsim.optics.beam import Beam, aim
from octsim.optics.detector import Acceptance, Detector, falloff, rim_margin
from octsim.optics.scene import Scene
from octsim.optics.turned_rays import STRAIGHT
from octsim.tracing.faces import Faces, faces_at
from octsim.tracing.follow import FOLLOW_ROOM, Bundle, FollowRoom, bundle_of, follow
from octsim.tracing.kernel import AT_VX, AT_VY, AT_X, AT_Y, FIRST_CARRIED, trace_amplitudes
from octsim.tracing.lanes import LANES
from octsim.tracing.light_paths import LONGEST, steps_of

Array = NDArray[np.float64]
COLUMNS, ROWS = 320, 240
"""Cells of the coarse grid, along ξ and along asin y, of a quarter of the aperture."""
_AT_ONCE = 16  # rows of the coarse grid that are traced together
_FINEST = 2500.0  # cells along each side of a patch, at most
_RAYS = 6_000_000  # of one path, at most


class Dense(NamedTuple):
    """A field by dense grids, and how sure it is."""

    field: NDArray[np.complex128]
    """Over the wavenumbers, (K,)."""
    error: float
    """Difference of two grids, summed over the paths: the largest over the band."""


class _Part(NamedTuple):
    """Where a path may be detected: cells of the coarse grid, and its largest amplitude there."""

    code: int
    columns: NDArray[np.int64]
    rows: NDArray[np.int64]
    slopes: Array
    """By how much the margin at the objective's rim varies along each cell, (2, cells)."""
    strongest: float


@compiled()
def _within(margin: float, across: float, along: float) -> float:
    """Return the part of a square in which a margin is above zero, from that at its centre.

    It varies by `across` from side to side and by `along` from end to end, evenly.
    """
    large, small = max(across, along), min(across, along)
    beyond = 0.5 * (large + small) - abs(margin)
    if beyond <= 0:
        return 1.0 if margin > 0 else 0.0
    if beyond >= small:
        return 0.5 + margin / large
    corner = beyond * beyond / (2 * large * small)
    return 1 - corner if margin > 0 else corner


@compiled()
def _sum_cells(
    faces: Faces, detector: Detector, focus: float, code: int, columns: NDArray[np.int64],
    rows: NDArray[np.int64], slopes: Array, finer: int, first: float, step: float, real: Array,
    imaginary: Array, bundle: Bundle, rays: FollowRoom,
) -> None:  # fmt: skip
    """Add a path's rays from a grid of midpoints over some cells."""
    face, through = np.empty(LONGEST, np.int64), np.empty(LONGEST, np.bool_)
    meetings = steps_of(faces, code, face, through)
    beam = Beam(np.empty(LANES), np.empty(LANES), np.empty(LANES), np.ones(LANES), np.arange(LANES))
    areas, across, along = np.empty(LANES), np.empty(LANES), np.empty(LANES)
    width, height = 1 / (COLUMNS * finer), 1 / (ROWS * finer)
    count = 0
    total = columns.size * finer * finer
    for number in range(total):
        cell, place = number // (finer * finer), number % (finer * finer)
        xi = (columns[cell] * finer + place // finer + 0.5) * width
        angle = 0.5 * math.pi * (rows[cell] * finer + place % finer + 0.5) * height
        y, half = math.sin(angle), math.cos(angle)
        radius = detector.objective_radius
        beam.vx[count], beam.vy[count], beam.vz[count] = aim(
            xi * half * radius, y * radius, detector.focus_distance
        )
        areas[count] = 2 * half * half * width * height
        across[count], along[count] = slopes[0, cell] / finer, slopes[1, cell] / finer
        count += 1
        if count < LANES and number + 1 < total:
            continue
        follow(faces, face, through, meetings, beam, count, detector, focus, STRAIGHT, rays, bundle)
        for i in range(count):
            if not bundle.followed[i]:
                continue
            part = _within(bundle.inside[i], across[i], along[i])
            scale = 1 / (bundle.cos[i] * detector.radius)
            weight = falloff((bundle.x[i] * scale) ** 2, (bundle.y[i] * scale) ** 2)
            if not weight * part > 0:
                continue
            weight *= part * bundle.amplitude[i] * areas[i]
            path = bundle.optical_path_length[i]
            cos, sin = weight * math.cos(first * path), weight * math.sin(first * path)
            turn, turn_i = math.cos(step * path), math.sin(step * path)
            for k in range(real.size):
                real[k] += cos
                imaginary[k] += sin
                cos, sin = cos * turn - sin * turn_i, cos * turn_i + sin * turn
        count = 0


def _grown(flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the flags with those of the eight neighbours."""
    grown = flags.copy()
    for axis in (0, 1):
        before = grown.copy()
        shifted = np.moveaxis(grown, axis, 0)
        old = np.moveaxis(before, axis, 0)
        shifted[1:] |= old[:-1]
        shifted[:-1] |= old[1:]
    return grown


def _corners(values: Array) -> Array:
    """Return the values at the four corners of each cell, (4, columns, rows)."""
    return np.stack([values[:-1, :-1], values[1:, :-1], values[:-1, 1:], values[1:, 1:]])


def _may_hold(known: NDArray[np.bool_], values: Array, limit: Array) -> NDArray[np.bool_]:
    """Return the cells in which a quantity may be within limits of zero, as their corners tell."""
    corners, there = _corners(values), _corners(known)
    low = np.where(there, corners, np.inf).min(axis=0)
    high = np.where(there, corners, -np.inf).max(axis=0)
    with np.errstate(invalid="ignore"):
        vary = 0.6 * (high - low)
    limits = np.where(there, _corners(limit), 0.0).max(axis=0)
    some, every = there.any(axis=0), there.all(axis=0)
    held: NDArray[np.bool_] = (low - vary <= limits) & (high + vary >= -limits)
    return some & (held | ~every)


def parts_of(faces: Faces, detector: Detector, focus: float, max_intersections: int) -> list[_Part]:
    """Return where on the aperture each light path may be detected."""
    xi, y = np.linspace(0, 1, COLUMNS + 1), np.sin(np.linspace(0, np.pi / 2, ROWS + 1))
    xi[0], y[0], y[-1] = 1e-9, 1e-9, 1 - 1e-9
    found: dict[int, Array] = {}
    for begin in range(0, ROWS + 1, _AT_ONCE):
        rows = np.arange(begin, min(begin + _AT_ONCE, ROWS + 1))
        at_xi, at_y = np.meshgrid(xi, y[rows], indexing="ij")
        radius = detector.objective_radius
        places = at_xi * np.sqrt(1 - at_y**2) * radius, at_y * radius
        directions = aim(places[0].ravel(), places[1].ravel(), detector.focus_distance)
        beam = Beam(*directions, np.ones(at_xi.size), np.arange(at_xi.size))
        labels, numbers, _, _ = trace_amplitudes(
            faces, beam, detector, Acceptance(np.inf, np.inf), focus, max_intersections, 0.0
        )
        vx, vy = numbers[AT_VX], numbers[AT_VY]
        cos = np.sqrt(np.maximum(1 - vx * vx - vy * vy, 0.0))
        x, to_y = numbers[AT_X] * cos, numbers[AT_Y] * cos
        inside = rim_margin(detector, x, to_y, vx, vy, cos)
        columns, row = np.divmod(labels[0], rows.size)
        for code in np.unique(labels[1]):
            of = labels[1] == code
            grid = found.setdefault(int(code), np.full((5, COLUMNS + 1, ROWS + 1), np.nan))
            for quantity, values in enumerate((x, to_y, cos, inside, numbers[FIRST_CARRIED])):
                grid[quantity, columns[of], rows[row[of]]] = values[of]
    parts = []
    for code, (x, to_y, cos, inside, amplitude) in found.items():
        known = np.isfinite(x)
        limit = np.where(known, cos, 0.0) * detector.radius
        flags = (
            _may_hold(known, np.nan_to_num(x), limit)
            & _may_hold(known, np.nan_to_num(to_y), limit)
            & _may_hold(known, np.minimum(np.nan_to_num(inside), 0.0), np.zeros_like(x))
        )
        partly = flags & ~_corners(known).all(axis=0)
        flags |= _grown(partly) & ~_corners(known).all(axis=0)
        strength = np.where(known, np.abs(np.nan_to_num(amplitude)), 0.0)
        strongest = np.where(_grown(flags), _corners(strength).max(axis=0), 0.0)
        across = np.abs(np.diff(inside, axis=0)[:, :-1] + np.diff(inside, axis=0)[:, 1:]) / 2
        along = np.abs(np.diff(inside, axis=1)[:-1] + np.diff(inside, axis=1)[1:]) / 2
        slopes = np.nan_to_num(np.stack([across[flags], along[flags]]))
        if flags.any():
            parts.append(_Part(code, *np.nonzero(flags), slopes, float(strongest.max())))
    return parts


def dense_field(
    scene: Scene, detector: Detector, focus: float, wavenumber: Array, accuracy: float,
    max_intersections: int = 11,
) -> Dense:  # fmt: skip
    """Return the field of all light paths by dense grids, well within an accuracy where it can.

    Parameters
    ----------
    scene : Scene
        Symmetric in x and y.
    detector : Detector
        What receives the light.
    focus : float
        Height of the focus, µm.
    wavenumber : ndarray, shape (K,)
        Evenly spaced, 1/µm.
    accuracy : float
        Of the intensity, over its largest.
    max_intersections : int
        Surfaces that one ray may meet.
    """
    middle = float(wavenumber[0] + wavenumber[-1]) / 2
    faces = faces_at(scene, middle)
    first, step = float(wavenumber[0]), float(wavenumber[1] - wavenumber[0])

    def by_grid(part: _Part, finer: int) -> Any:
        real, imaginary = np.zeros(wavenumber.size), np.zeros(wavenumber.size)
        _sum_cells(
            faces, detector, focus, part.code, part.columns, part.rows, part.slopes, finer, first,
            step, real, imaginary, room(bundle_of(LANES)), room(FOLLOW_ROOM),
        )  # fmt: skip
        return real + 1j * imaginary

    parts = parts_of(faces, detector, focus, max_intersections)
    rough = [by_grid(part, _finer(part, 100.0)) for part in parts]
    scale = max(np.abs(sum(rough)).max(), 1e-300) if rough else 1e-300
    total, error = np.zeros(wavenumber.size, complex), 0.0
    for part, field in zip(parts, rough, strict=True):
        allowed = 0.02 * accuracy * scale
        size = max(np.abs(field).max(), _faintest(part))
        side = 40.0
        while True:
            side = min(max(side, (2 * size / allowed) ** 0.4), _FINEST)
            fine = _finer(part, side)
            less = max(1, round(0.71 * fine))
            better = by_grid(part, fine)
            off = float(np.abs(better - by_grid(part, less)).max())
            if off <= allowed or side >= _FINEST or part.rows.size * fine * fine > _RAYS:
                break
            side *= 1.7
        total += better
        error += off
    return Dense(total, error)


def _faintest(part: _Part) -> float:
    """Return the field of a tenth of a cell."""
    return 0.1 * part.strongest / (COLUMNS * ROWS)


def _finer(part: _Part, side: float) -> int:
    """Return into how many parts cells are cut along each axis for a patch of so many parts."""
    return max(2, math.ceil(side / math.sqrt(part.rows.size)))
