"""Lines through a tile, and where they cross the patch whose light is detected.

On a tile the line along which a ray returns is a polynomial; where light is detected, and with what
falloff, follows from that without tracing another ray. A returning line is known by its moments
about the focus, (X cos θ, Y cos θ) for one that crosses the focal plane at (X, Y) at an angle θ:
they stay finite where θ comes near a right angle.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.records import layout
from octsim.optics.detector import falloff
from octsim.schemes.paths.aperture_tiles import Tile
from octsim.schemes.paths.chebyshev import HIGHEST, polynomials

_SAMPLES = 6  # of a line through a tile, to see where it enters and leaves the patch
_CUTS = 4 * _SAMPLES
_STEPS = 60
_CLOSE, _ROUGHLY = 1e-13, 1e-8  # the falloff is zero at an edge, so that may be a little off
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
    places: NDArray[np.float64]
    margins: NDArray[np.float64]
    exact: NDArray[np.float64]
    """Integrals along the line."""
    rough: NDArray[np.float64]


_square, _each, _cuts = (HIGHEST, HIGHEST), (HIGHEST,), (_CUTS,)
MAP = layout(Map, x=_square, y=_square, cos=_square, inside=_square)
TILE_LINE = layout(
    TileLine, x=_each, y=_each, cos=_each, inside=_each, rough_x=_each, rough_y=_each, t=_each,
    u=_each, cuts=_cuts, places=_cuts, margins=_cuts, exact=_each, rough=_each,
)  # fmt: skip


class Cut(NamedTuple):
    """What a tile is cut along: its map, orders n and m along s and v, and the detector."""

    returns: Map
    n: int
    m: int
    tile: Tile
    symmetric: bool
    detector_radius: float


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


@register_jitable
def margins(cut: Cut, xi: float, line: TileLine, y: float) -> tuple[float, float, float]:
    """Return how far inside the detector's image, and the objective's rim, light returns (> 0).

    And how far to the side of the focus, over R_det, which changes its sign within a patch.
    """
    tile = cut.tile
    polynomials((y * y - tile.v_min) / (tile.v_max - tile.v_min), cut.m, line.u)
    to_x, to_y, cos, inside = 0.0, 0.0, 0.0, 0.0
    for b in range(cut.m):
        to_x += line.x[b] * line.u[b]
        to_y += line.y[b] * line.u[b]
        cos += line.cos[b] * line.u[b]
        inside += line.inside[b] * line.u[b]
    scale_x = xi * math.sqrt(1 - y * y) if cut.symmetric else 1.0
    to_x, to_y = to_x * scale_x / cut.detector_radius, to_y * y / cut.detector_radius
    return cos * cos - to_x * to_x - to_y * to_y, inside, to_x


@register_jitable(forceinline=True)
def margin(cut: Cut, xi: float, line: TileLine, y: float) -> float:
    """Return how far inside the patch a place on a line is (> 0)."""
    at_detector, at_rim, _ = margins(cut, xi, line, y)
    return min(at_detector, at_rim)


@register_jitable
def falloffs(cut: Cut, xi: float, line: TileLine, y: float) -> tuple[float, float]:
    """Return the falloff at a place on a line, and that from a rougher map."""
    tile, m = cut.tile, cut.m
    polynomials((y * y - tile.v_min) / (tile.v_max - tile.v_min), m, line.u)
    to_x, to_y, cos = 0.0, 0.0, 0.0
    for b in range(m):
        to_x += line.x[b] * line.u[b]
        to_y += line.y[b] * line.u[b]
        cos += line.cos[b] * line.u[b]
    rough_x, rough_y = 0.0, 0.0
    for b in range(m - LESS_V):
        rough_x += line.rough_x[b] * line.u[b]
        rough_y += line.rough_y[b] * line.u[b]
    scale_x = xi * math.sqrt(1 - y * y) if cut.symmetric else 1.0
    scale_x, scale_y = scale_x / (cos * cut.detector_radius), y / (cos * cut.detector_radius)
    return (
        falloff((to_x * scale_x) ** 2, (to_y * scale_y) ** 2),
        falloff((rough_x * scale_x) ** 2, (rough_y * scale_y) ** 2),
    )


@register_jitable
def _falsi(low: float, at_low: float, high: float, at_high: float) -> float:
    """Return where to look next for a zero between two of different sign (false position)."""
    x = (low * at_high - high * at_low) / (at_high - at_low)
    return x if min(low, high) < x < max(low, high) else 0.5 * (low + high)


@register_jitable(forceinline=True)
def _narrowed(
    low: float, at_low: float, high: float, at_high: float, side: int, x: float, here: float
) -> tuple[float, float, float, float, int]:
    """Put a place between two in the stead of that of its sign.

    By the Illinois rule: a value that stays twice counts half. `side` tells which came last.
    """
    if (here > 0) == (at_high > 0):
        return low, (0.5 * at_low if side == 1 else at_low), x, here, 1
    return x, here, high, (0.5 * at_high if side == -1 else at_high), -1


@register_jitable
def edge(cut: Cut, xi: float, line: TileLine, low: float, high: float) -> float:
    """Return where the margin along a line changes its sign (Illinois)."""
    at_low, at_high, side = margin(cut, xi, line, low), margin(cut, xi, line, high), 0
    y = low
    for _ in range(_STEPS):
        y = _falsi(low, at_low, high, at_high)
        here = margin(cut, xi, line, y)
        if abs(here) < _ROUGHLY or abs(high - low) < _ROUGHLY * (abs(low) + abs(high)):
            break
        low, at_low, high, at_high, side = _narrowed(low, at_low, high, at_high, side, y, here)
    return y


@register_jitable
def end_of(cut: Cut, line: TileLine, y: float, which: int, low: float, high: float) -> float:
    """Return the ξ at which one of the margins at one y changes its sign (Illinois)."""
    set_line(cut, low, line)
    at_low = margins(cut, low, line, y)[which]
    set_line(cut, high, line)
    at_high, side = margins(cut, high, line, y)[which], 0
    xi = low
    for _ in range(_STEPS):
        xi = _falsi(low, at_low, high, at_high)
        set_line(cut, xi, line)
        here = margins(cut, xi, line, y)[which]
        if abs(here) < _CLOSE or abs(high - low) < _CLOSE * (abs(low) + abs(high)):
            break
        low, at_low, high, at_high, side = _narrowed(low, at_low, high, at_high, side, xi, here)
    return xi


@register_jitable(forceinline=True)
def turns_back(left: float, middle: float, right: float) -> bool:
    """Return whether three margins of one sign come nearest to zero in the middle."""
    if middle > 0:
        return left > 0 and right > 0 and min(left, right) >= middle and left + right > 2 * middle
    return left <= 0 and right <= 0 and max(left, right) <= middle and left + right < 2 * middle


@register_jitable
def _sample(cut: Cut, xi: float, line: TileLine) -> int:
    """List places along a line, and the margins there, that show each change of sign."""
    y_min, y_max = math.sqrt(cut.tile.v_min), math.sqrt(cut.tile.v_max)
    step = (y_max - y_min) / _SAMPLES
    places, margins = line.places, line.margins
    left, middle, num = 0.0, 0.0, 0
    for i in range(_SAMPLES + 1):
        y = y_min + i * step
        right = margin(cut, xi, line, y)
        if i >= 2 and turns_back(left, middle, right):
            # it turns before it reaches zero, as far as three places tell: look closer
            offset = 0.5 * (left - right) / (left - 2 * middle + right)
            turn = y - step + offset * step
            here = margin(cut, xi, line, turn)
            if offset < 0:
                places[num], margins[num] = places[num - 1], margins[num - 1]
                places[num - 1], margins[num - 1] = turn, here
            else:
                places[num], margins[num] = turn, here
            num += 1
        places[num], margins[num] = y, right
        left, middle, num = middle, right, num + 1
    return num


@register_jitable
def cross(cut: Cut, xi: float, line: TileLine) -> int:
    """List where the line at ξ enters and leaves the patch, in pairs; return how many."""
    set_line(cut, xi, line)
    num, found = _sample(cut, xi, line), 0
    if line.margins[0] > 0:
        line.cuts[0] = line.places[0]
        found = 1
    for i in range(1, num):
        if (line.margins[i] > 0) != (line.margins[i - 1] > 0):
            line.cuts[found] = edge(cut, xi, line, line.places[i - 1], line.places[i])
            found += 1
    if line.margins[num - 1] > 0:
        line.cuts[found] = line.places[num - 1]
        found += 1
    return found


@register_jitable
def crossing_kind(cut: Cut, xi: float, line: TileLine) -> tuple[int, bool, bool]:
    """Return how a line crosses the patch: how often, and whether at its ends."""
    set_line(cut, xi, line)
    num = _sample(cut, xi, line)
    changes = 0
    for i in range(1, num):
        changes += 1 if (line.margins[i] > 0) != (line.margins[i - 1] > 0) else 0
    return changes, line.margins[0] > 0, line.margins[num - 1] > 0
