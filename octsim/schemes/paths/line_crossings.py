"""Lines through a tile, and where they cross the patch whose light is detected.

On a tile the line along which a ray returns is a polynomial; where light is detected, and with what
falloff, follows from that without tracing another ray. How far inside the detector's image and the
objective's rim light returns are then polynomials along a line too, whose roots are all found
(`polynomial_roots`): between two of them light is detected everywhere or nowhere. A returning line
is known by its moments about the focus, (X cos θ, Y cos θ) for one that crosses the focal plane at
(X, Y) at an angle θ: they stay finite where θ comes near a right angle.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.records import layout
from octsim.schemes.paths.aperture_tiles import Tile
from octsim.schemes.paths.chebyshev import HIGHEST, polynomials
from octsim.schemes.paths.falloffs import Parabola, Series, falloff_at
from octsim.schemes.paths.polynomial_roots import (
    HALVES,
    MOST_COEFFICIENTS,
    BernsteinTables,
    add_square,
    append_roots,
    sort,
    to_bernstein,
    unscale,
    value_at,
)

MOST_CROSSINGS = MOST_COEFFICIENTS + 2 * HIGHEST
LESS_S, LESS_V = 2, 1
"""Orders that a rougher rule has less along s and v. Errors along s can alternate in size."""


class Map:
    """Where the rays of a tile return to, as Chebyshev coefficients in (s, v)."""

    x: NDArray[np.float64]
    """X cos θ, µm; over x for a symmetric scene."""
    y: NDArray[np.float64]
    """Y cos θ over y, µm."""
    cos: NDArray[np.float64]
    """cos θ."""
    inside: NDArray[np.float64]
    """`octsim.optics.detector.rim_margin`."""


class TileLine:
    """A `Map` at one ξ: coefficients in v, and room to work in."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    cos: NDArray[np.float64]
    inside: NDArray[np.float64]
    rough_x: NDArray[np.float64]
    """The same from a rougher map, by `LESS_S` and `LESS_V` orders."""
    rough_y: NDArray[np.float64]
    t: NDArray[np.float64]
    """Polynomials in s."""
    u: NDArray[np.float64]
    """Polynomials in v, where last evaluated."""
    cuts: NDArray[np.float64]
    """Where the line enters and leaves the patch."""
    scaled: NDArray[np.float64]
    """Of one polynomial after the other, as Bernstein coefficients."""
    at_detector: NDArray[np.float64]
    """Margin at the detector's image, cos² θ − (X² + Y²) cos² θ / R_det², as Bernstein's."""
    at_rim: NDArray[np.float64]
    """Margin at the objective's rim, the same."""
    roots: NDArray[np.float64]
    halves: NDArray[np.float64]
    exact: NDArray[np.float64]
    """Integrals along the line."""
    rough: NDArray[np.float64]


_square, _each, _both = (HIGHEST, HIGHEST), (HIGHEST,), (MOST_COEFFICIENTS,)
_crossings = (MOST_CROSSINGS,)
MAP = layout(Map, x=_square, y=_square, cos=_square, inside=_square)
TILE_LINE = layout(
    TileLine, x=_each, y=_each, cos=_each, inside=_each, rough_x=_each, rough_y=_each, t=_each,
    u=_each, cuts=_crossings, scaled=_both, at_detector=_both, at_rim=_both, roots=_crossings,
    halves=HALVES, exact=_each, rough=_each,
)  # fmt: skip


class Cut(NamedTuple):
    """What a tile is cut along: its map, orders n and m along s and v, and the detector."""

    returns: Map
    n: int
    m: int
    tile: Tile
    symmetric: bool
    detector_radius: float
    falloff: Parabola | Series
    bernstein: BernsteinTables


@register_jitable
def set_line(cut: Cut, xi: float, line: TileLine) -> None:
    """Find the polynomials in v of a tile's map along the line at ξ."""
    n, m, returns, tile = cut.n, cut.m, cut.returns, cut.tile
    s = xi * xi if cut.symmetric else xi
    polynomials((s - tile.s_min) / (tile.s_max - tile.s_min), n, line.t)
    for b in range(m):
        x, along, cos, inside = 0.0, 0.0, 0.0, 0.0
        for a in range(n):
            x += returns.x[a, b] * line.t[a]
            along += returns.y[a, b] * line.t[a]
            cos += returns.cos[a, b] * line.t[a]
            inside += returns.inside[a, b] * line.t[a]
        line.x[b], line.y[b], line.cos[b], line.inside[b] = x, along, cos, inside
        for a in range(n - LESS_S, n):
            x -= returns.x[a, b] * line.t[a]
            along -= returns.y[a, b] * line.t[a]
        line.rough_x[b], line.rough_y[b] = x, along


@register_jitable(forceinline=True)
def returning(cut: Cut, line: TileLine, y: float) -> tuple[float, float, float]:
    """Return where light of a place on a line returns to, as a `Map` has it: x, y and cos θ."""
    tile, m = cut.tile, cut.m
    polynomials((y * y - tile.v_min) / (tile.v_max - tile.v_min), m, line.u)
    to_x, to_y, cos = 0.0, 0.0, 0.0
    for b in range(m):
        to_x += line.x[b] * line.u[b]
        to_y += line.y[b] * line.u[b]
        cos += line.cos[b] * line.u[b]
    return to_x, to_y, cos


@register_jitable(forceinline=True)
def across_place(cut: Cut, xi: float, y: float) -> float:
    """Return what a `Map`'s x is multiplied by at a place."""
    return xi * math.sqrt(1 - y * y) if cut.symmetric else 1.0


@register_jitable(forceinline=True)
def falloffs(cut: Cut, xi: float, line: TileLine, y: float) -> tuple[float, float]:
    """Return the falloff at a place on a line, and that from a rougher map."""
    m = cut.m
    to_x, to_y, cos = returning(cut, line, y)
    rough_x, rough_y = 0.0, 0.0
    for b in range(m - LESS_V):
        rough_x += line.rough_x[b] * line.u[b]
        rough_y += line.rough_y[b] * line.u[b]
    scale_x = across_place(cut, xi, y) / (cos * cut.detector_radius)
    scale_y = y / (cos * cut.detector_radius)
    return (
        falloff_at(cut.falloff, (to_x * scale_x) ** 2, (to_y * scale_y) ** 2),
        falloff_at(cut.falloff, (rough_x * scale_x) ** 2, (rough_y * scale_y) ** 2),
    )


@register_jitable
def _margin_at_detector(
    cut: Cut, line: TileLine, n: int, x_0: float, x_1: float, y_0: float, y_1: float
) -> None:
    """Fill in the margin at the detector along a line of the tile, from n coefficients in it.

    `x_0` and `x_1` are what X² is multiplied by at the line's ends, `y_0` and `y_1` what Y² is.
    """
    table, margin, over = cut.bernstein.from_chebyshev[n], line.at_detector, cut.detector_radius**-2
    for j in range(2 * n):
        margin[j] = 0.0
    to_bernstein(line.cos, n, table, line.scaled)
    add_square(1.0, line.scaled, n, 1.0, 1.0, margin)
    to_bernstein(line.x, n, table, line.scaled)
    add_square(-over, line.scaled, n, x_0, x_1, margin)
    to_bernstein(line.y, n, table, line.scaled)
    add_square(-over, line.scaled, n, y_0, y_1, margin)
    unscale(margin, 2 * n, cut.bernstein.binomials)


@register_jitable(forceinline=True)
def _reaches_rim(line: TileLine, n: int) -> bool:
    """Return whether not all of a line is within the objective's rim."""
    least: float = line.inside[0]
    for b in range(1, n):
        least -= abs(line.inside[b])
    return least <= 0


@register_jitable
def _roots(cut: Cut, line: TileLine, n: int, margin: NDArray[np.float64], num: int) -> int:
    """Append the roots of n coefficients to those of a line."""
    return append_roots(margin, n, cut.bernstein.binomials, line.halves, line.roots, num)


@register_jitable(forceinline=True)
def _set_rim(cut: Cut, line: TileLine, n: int) -> None:
    """Fill in the margin at the objective's rim along a line of the tile."""
    to_bernstein(line.inside, n, cut.bernstein.from_chebyshev[n], line.at_rim)
    unscale(line.at_rim, n, cut.bernstein.binomials)


@register_jitable
def cross(cut: Cut, xi: float, line: TileLine) -> int:
    """List where the line at ξ enters and leaves the patch, in pairs; return how many."""
    set_line(cut, xi, line)
    m, tile, binomials = cut.m, cut.tile, cut.bernstein.binomials
    over_x = xi * xi if cut.symmetric else 1.0
    less = over_x if cut.symmetric else 0.0
    _margin_at_detector(
        cut, line, m, over_x - less * tile.v_min, over_x - less * tile.v_max, tile.v_min, tile.v_max
    )
    num, rim = _roots(cut, line, 2 * m, line.at_detector, 0), _reaches_rim(line, m)
    if rim:
        _set_rim(cut, line, m)
        num = _roots(cut, line, m, line.at_rim, num)
        sort(line.roots, num)
    found, begin = 0, 0.0
    for i in range(num + 1):
        end = line.roots[i] if i < num else 1.0
        middle = 0.5 * (begin + end)
        inside = value_at(line.at_detector, 2 * m, binomials, middle) > 0 and not (
            rim and value_at(line.at_rim, m, binomials, middle) <= 0
        )
        if inside != (found % 2 == 1):
            line.cuts[found] = math.sqrt(tile.v_min + (tile.v_max - tile.v_min) * begin)
            found += 1
        begin = end
    if found % 2 == 1:
        line.cuts[found] = math.sqrt(tile.v_max)
        found += 1
    return found


@register_jitable
def crossing_kind(cut: Cut, xi: float, line: TileLine) -> tuple[int, bool, bool]:
    """Return how a line crosses the patch: how often, and whether at its ends."""
    found = cross(cut, xi, line)
    at_low = found > 0 and line.cuts[0] == math.sqrt(cut.tile.v_min)
    at_high = found > 0 and line.cuts[found - 1] == math.sqrt(cut.tile.v_max)
    return found, at_low, at_high


@register_jitable
def cross_edge(cut: Cut, v: float, line: TileLine) -> int:
    """List the places c along s at which light at v is at the edge of the patch, or at x = 0.

    They are put into the line's `roots`, in no order; returns how many.
    """
    n, tile, returns = cut.n, cut.tile, cut.returns
    polynomials((v - tile.v_min) / (tile.v_max - tile.v_min), cut.m, line.u)
    for a in range(n):
        x, along, cos, inside = 0.0, 0.0, 0.0, 0.0
        for b in range(cut.m):
            x += returns.x[a, b] * line.u[b]
            along += returns.y[a, b] * line.u[b]
            cos += returns.cos[a, b] * line.u[b]
            inside += returns.inside[a, b] * line.u[b]
        line.x[a], line.y[a], line.cos[a], line.inside[a] = x, along, cos, inside
    low, high = ((1 - v) * tile.s_min, (1 - v) * tile.s_max) if cut.symmetric else (1.0, 1.0)
    _margin_at_detector(cut, line, n, low, high, v, v)
    num = _roots(cut, line, 2 * n, line.at_detector, 0)
    if _reaches_rim(line, n):
        _set_rim(cut, line, n)
        num = _roots(cut, line, n, line.at_rim, num)
    to_bernstein(line.x, n, cut.bernstein.from_chebyshev[n], line.scaled)
    unscale(line.scaled, n, cut.bernstein.binomials)
    return _roots(cut, line, n, line.scaled, num)
