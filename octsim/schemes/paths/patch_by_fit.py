"""Where in a tile the patch is whose light is detected, as the tile's polynomials tell."""

import math

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.records import layout
from octsim.schemes.paths.aperture_tiles import Tile, across
from octsim.schemes.paths.chebyshev import HIGHEST, polynomials, trailing
from octsim.schemes.paths.line_crossings import Map

_CELLS = 16  # along each side of a tile, to look for the patch in


class Search:
    """Room to look through a tile in."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    inside: NDArray[np.float64]
    t: NDArray[np.float64]
    u: NDArray[np.float64]
    row: NDArray[np.float64]


_grid = (_CELLS + 1, _CELLS + 1)
SEARCH = layout(
    Search, x=_grid, y=_grid, inside=_grid, t=(_CELLS + 1, HIGHEST), u=(HIGHEST,), row=(HIGHEST,)
)


@register_jitable(forceinline=True)
def _reaches(a: float, b: float, c: float, d: float, slack: float, radius: float) -> bool:
    """Return whether a coordinate with these values at a cell's corners may be within a radius."""
    low, high = min(a, b, c, d), max(a, b, c, d)
    more = slack + 0.25 * (high - low)
    return low - more < radius and high + more > -radius


@register_jitable(forceinline=True)
def _exceeds(a: float, b: float, c: float, d: float, slack: float) -> bool:
    """Return whether a quantity with these values at a cell's corners may be above zero."""
    low, high = min(a, b, c, d), max(a, b, c, d)
    return high + slack + 0.25 * (high - low) > 0


@register_jitable
def _spread(
    coefficients: NDArray[np.float64],
    n: int,
    m: int,
    room: Search,
    row: int,
    values: NDArray[np.float64],
) -> None:
    """Evaluate a polynomial along a row of the cells' corners."""
    for a in range(n):
        total = 0.0
        for b in range(m):
            total += coefficients[a, b] * room.u[b]
        room.row[a] = total
    for i in range(_CELLS + 1):
        total = 0.0
        for a in range(n):
            total += room.row[a] * room.t[i, a]
        values[row, i] = total


@register_jitable
def _lay_out(returns: Map, n: int, m: int, tile: Tile, symmetric: bool, room: Search) -> None:
    """Evaluate where the rays of the cells' corners return to."""
    xi_min, xi_max = across(tile.s_min, symmetric), across(tile.s_max, symmetric)
    y_min, y_max = math.sqrt(tile.v_min), math.sqrt(tile.v_max)
    for i in range(_CELLS + 1):
        xi = xi_min + (xi_max - xi_min) * i / _CELLS
        s = xi * xi if symmetric else xi
        polynomials((s - tile.s_min) / (tile.s_max - tile.s_min), n, room.t[i])
    for j in range(_CELLS + 1):
        y = y_min + (y_max - y_min) * j / _CELLS
        polynomials((y * y - tile.v_min) / (tile.v_max - tile.v_min), m, room.u)
        _spread(returns.x, n, m, room, j, room.x)
        _spread(returns.y, n, m, room, j, room.y)
        _spread(returns.inside, n, m, room, j, room.inside)
        for i in range(_CELLS + 1):
            room.y[j, i] *= y
        if symmetric:
            half = math.sqrt(max(1 - y * y, 0.0))
            for i in range(_CELLS + 1):
                room.x[j, i] *= half * (xi_min + (xi_max - xi_min) * i / _CELLS)


@register_jitable
def holding(
    returns: Map, n: int, m: int, tile: Tile, symmetric: bool, detector_radius: float, room: Search
) -> tuple[float, Tile]:
    """Return the part of a tile that the patch can be in, as far as the tile's polynomials tell.

    What the highest order adds is taken for their error.

    Returns
    -------
    filled : float
        Part of the tile's cells that the patch can be in; 0 if there is no patch.
    within : Tile
        The part.
    """
    _lay_out(returns, n, m, tile, symmetric, room)
    xi_min, xi_max = across(tile.s_min, symmetric), across(tile.s_max, symmetric)
    y_min, y_max = math.sqrt(tile.v_min), math.sqrt(tile.v_max)
    slack_x = sum(trailing(returns.x, n, m)) * (xi_max if symmetric else 1.0)
    slack_y = sum(trailing(returns.y, n, m)) * y_max
    slack_inside = sum(trailing(returns.inside, n, m))
    p, q, r = room.x, room.y, room.inside
    left, right, below, above, cells = _CELLS, -1, _CELLS, -1, 0
    for j in range(_CELLS):
        for i in range(_CELLS):
            if (
                _reaches(
                    p[j, i], p[j, i + 1], p[j + 1, i], p[j + 1, i + 1], slack_x, detector_radius
                )
                and _reaches(
                    q[j, i], q[j, i + 1], q[j + 1, i], q[j + 1, i + 1], slack_y, detector_radius
                )
                and _exceeds(r[j, i], r[j, i + 1], r[j + 1, i], r[j + 1, i + 1], slack_inside)
            ):
                left, right = min(left, i), max(right, i)
                below, above = min(below, j), max(above, j)
                cells += 1
    if right < 0:
        return 0.0, tile
    x_step, y_step = (xi_max - xi_min) / _CELLS, (y_max - y_min) / _CELLS
    x_low, x_high = xi_min + x_step * left, xi_min + x_step * (right + 1)
    y_low, y_high = y_min + y_step * below, y_min + y_step * (above + 1)
    s_low = x_low * x_low if symmetric else x_low
    s_high = x_high * x_high if symmetric else x_high
    return cells / (_CELLS * _CELLS), Tile(
        s_low if left > 0 else tile.s_min,
        s_high if right < _CELLS - 1 else tile.s_max,
        y_low * y_low if below > 0 else tile.v_min,
        y_high * y_high if above < _CELLS - 1 else tile.v_max,
    )
