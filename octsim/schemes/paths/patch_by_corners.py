"""Where in a partially covered tile a patch can be, and what it may contribute.

Not all rays of such a tile take the path, so that nothing is fitted: the cells between its nodes
are judged by their corners.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.schemes.paths.aperture_tiles import Tile, between, fraction
from octsim.schemes.paths.check_rays import CheckRays, field_seen
from octsim.tracing.follow import Bundle

USUALLY, NEAR_AN_EDGE = 0.5, 1.0
"""How far a quantity may go on past known corners; and where light can miss a cylinder."""
_ELSEWHERE = 2.0  # what it may vary by, over what it does elsewhere in a tile


@register_jitable(forceinline=True)
def _difference(
    values: NDArray[np.float64], followed: NDArray[np.bool_], n: int, m: int, p: int, q: int,
    here: float,
) -> float:  # fmt: skip
    """Return how far a quantity at a node is from a value; −1 if the node is not known."""
    if 0 <= p < n and 0 <= q < m and followed[p * m + q]:
        there: float = values[p * m + q]
        return abs(there - here)
    return -1.0


@register_jitable
def _variation(
    values: NDArray[np.float64], followed: NDArray[np.bool_], n: int, m: int, along_v: bool
) -> float:
    """Return the largest difference of a tile's neighbours along one axis; −1 without any."""
    most = -1.0
    for p in range(n):
        for q in range(m):
            if followed[p * m + q]:
                here = values[p * m + q]
                there = (p, q + 1) if along_v else (p + 1, q)
                most = max(most, _difference(values, followed, n, m, there[0], there[1], here))
    return most


@register_jitable
def _span(
    values: NDArray[np.float64],
    followed: NDArray[np.bool_],
    n: int,
    m: int,
    i: int,
    j: int,
    extrapolation: float,
) -> tuple[float, float, float]:
    """Return the bounds of a quantity in a cell, as its corners tell, and its variation."""
    least, most, known = np.inf, -np.inf, 0
    vary_s, vary_v = -1.0, -1.0
    for p in (i, i + 1):
        for q in (j, j + 1):
            if followed[p * m + q]:
                here = values[p * m + q]
                least, most = min(least, here), max(most, here)
                for step in (-1, 1):
                    vary_s = max(vary_s, _difference(values, followed, n, m, p + step, q, here))
                    vary_v = max(vary_v, _difference(values, followed, n, m, p, q + step, here))
                known += 1
    if known == 4:
        vary = most - least
        return least - 0.5 * vary, most + 0.5 * vary, vary
    # what the cell's own corners do not tell, the tile's others do, less surely
    if vary_s < 0:
        vary_s = _ELSEWHERE * _variation(values, followed, n, m, False)
    if vary_v < 0:
        vary_v = _ELSEWHERE * _variation(values, followed, n, m, True)
    vary = max(vary_s, vary_v)
    if min(vary_s, vary_v) < 0 or vary == 0:
        # along one axis nothing tells how it varies, so that may be by all of it
        return min(least, 0.0), max(most, 0.0), max(abs(least), abs(most))
    return least - extrapolation * vary, most + extrapolation * vary, vary


@register_jitable(forceinline=True)
def _part_within(span: tuple[float, float, float], radius: float) -> float:
    """Estimate the part of a cell in which a quantity is within a radius; 0 if in none.

    As where it turns back there, like a square: where it varies evenly the part is less.
    """
    low, high, vary = span
    if low > radius or high < -radius:
        return 0.0
    return math.sqrt(min(1.0, 2 * radius / (high - low))) if vary > 0 else 1.0


@register_jitable(forceinline=True)
def _part_at_axis(value: float, place: float, width: float, radius: float) -> float:
    """Estimate that part for a cell at an axis, of a quantity that is odd in a coordinate.

    By its slope there, known from its value at a place close to the axis.
    """
    reach = abs(value) * width / place
    return min(1.0, radius / reach) if reach > 0 else 1.0


@register_jitable
def _cell(
    bundle: Bundle, n: int, m: int, i: int, j: int, cell: Tile, start: Tile, symmetric: bool,
    detector_radius: float, extrapolation: float,
) -> float:  # fmt: skip
    """Estimate the field, over that of all light, that a cell between four nodes contributes.

    `start` holds the coordinates of the nodes: those next to an axis are not quite on it.
    """
    followed, here = bundle.followed, i * m + j
    amplitude, known, within = 0.0, 0, False
    for p in (i, i + 1):
        for q in (j, j + 1):
            k = p * m + q
            if followed[k]:
                amplitude += abs(bundle.amplitude[k])
                known += 1
                on_axis = (p == 0 and symmetric and cell.s_min == 0) or (q == 0 and cell.v_min == 0)
                within = within or (
                    not on_axis
                    and max(abs(bundle.x[k]), abs(bundle.y[k])) < detector_radius * bundle.cos[k]
                )
    if amplitude == 0 or _span(bundle.inside, followed, n, m, i, j, extrapolation)[1] < 0:
        return 0.0
    amplitude, all_light = amplitude / known, fraction(cell, symmetric)
    if within:
        return amplitude * all_light
    part_x = _part_within(_span(bundle.x, followed, n, m, i, j, extrapolation), detector_radius)
    part_y = _part_within(_span(bundle.y, followed, n, m, i, j, extrapolation), detector_radius)
    at_axis_x, at_axis_y = i == 0 and symmetric and cell.s_min == 0, j == 0 and cell.v_min == 0
    near_x, near_y = 0.0, 0.0
    if at_axis_x and followed[here]:
        near_x = _part_at_axis(
            bundle.x[here], math.sqrt(start.s_min), math.sqrt(cell.s_max), detector_radius
        )
        if not (followed[here + m] or followed[here + m + 1]):
            part_x = near_x
    if at_axis_y and followed[here]:
        near_y = _part_at_axis(
            bundle.y[here], math.sqrt(start.v_min), math.sqrt(cell.v_max), detector_radius
        )
        if not (followed[here + 1] or followed[here + m + 1]):
            part_y = near_y
    if at_axis_x and at_axis_y and followed[here] and max(near_x, near_y) < 0.7:
        # a small ellipse about the axis, with the falloff's mean: 0.5 π/4, and a margin of 0.1
        at_axis: float = 0.5 * abs(bundle.amplitude[here])
        return at_axis * all_light * near_x * near_y
    return amplitude * all_light * max(part_x, near_x) * max(part_y, near_y)


@register_jitable
def corner(followed: NDArray[np.bool_], n: int, m: int) -> tuple[int, int]:
    """Return the largest p x q nodes at the axes that all take a path, at least 3 x 3, or 0."""
    best, sides, rows = 0, (0, 0), m
    for i in range(n):
        row = 0
        while row < rows and followed[i * m + row]:
            row += 1
        rows = row
        if i >= 2 and rows >= 3 and (i + 1) * rows > best:
            best, sides = (i + 1) * rows, (i + 1, rows)
    return sides


class Cells(NamedTuple):
    """A range of the cells between a tile's nodes; ends are not included."""

    s_begin: int
    s_end: int
    v_begin: int
    v_end: int


@register_jitable
def reached(
    bundle: Bundle, n: int, m: int, along_s: NDArray[np.float64], along_v: NDArray[np.float64],
    tile: Tile, cells: Cells, symmetric: bool, detector_radius: float, extrapolation: float,
    checks: CheckRays,
) -> tuple[float, Tile]:  # fmt: skip
    """Return the part of some cells of a partially covered tile that the patch can be in.

    Nothing is fitted; cells between nodes are left out if their corners are well beside the
    detector or beyond the objective's rim, or if no corner takes the path. Towards a corner that is
    not known a quantity may go on by `extrapolation` times what it varies between known ones.
    A cell where a check ray is detected is not left out.

    Returns
    -------
    field : float
        An estimate of the field, over that of all light; 0 if there is no patch.
    within : Tile
        The part.
    """
    left, right, below, above, field = n, -1, m, -1, 0.0
    s, v = tile.s_max - tile.s_min, tile.v_max - tile.v_min
    for i in range(cells.s_begin, cells.s_end):
        for j in range(cells.v_begin, cells.v_end):
            cell = between(tile, n, m, along_s, along_v, i, i + 1, j, j + 1)
            start = Tile(
                tile.s_min + s * along_s[i], tile.s_max, tile.v_min + v * along_v[j], tile.v_max
            )
            here = _cell(bundle, n, m, i, j, cell, start, symmetric, detector_radius, extrapolation)
            # about both axes the patch's size is known from its slopes
            if here == 0 or i > 0 or j > 0 or not symmetric:
                here = max(here, field_seen(checks, cell, symmetric))
            if here > 0:
                left, right = min(left, i), max(right, i)
                below, above = min(below, j), max(above, j)
                field += here
    if right < 0:
        return 0.0, tile
    return field, between(tile, n, m, along_s, along_v, left, right + 1, below, above + 1)
