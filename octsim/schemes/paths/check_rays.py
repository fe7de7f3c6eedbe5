"""Check rays: traced with the survey, at places of their own, to hold decisions about tiles to.

They lie along the edges of the surveyed tile that are at x = 0 and y = 0. There one coordinate of
where light returns is zero by symmetry, so that most patches reach there, and a zero of the other
coordinate is one. No part of the aperture is left out where a check ray of the path is detected,
and no polynomial is kept that puts one elsewhere.
"""

import math

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.records import layout
from octsim.schemes.paths.aperture_tiles import Tile, across, fraction
from octsim.schemes.paths.falloffs import Parabola, Series, falloff_at
from octsim.schemes.paths.line_crossings import (
    Cut,
    TileLine,
    across_place,
    returning,
    set_line,
)

CHECKS = 40
"""How many there are in a survey."""
_ALONG_X = 24  # of them at y = 0, of a scene that is symmetric in x
_BESIDE = 4.0  # R_det from the focus
_AT_EDGE = 0.1  # of a falloff that jumps there, in the square of the distance
_NEAR = 1e-8  # to an edge, of the tile's width
_EVENED_OUT = 0.1  # error of an integral, over the largest of its integrand


class CheckRays:
    """Rays of one path, and those of the survey that do not take it."""

    s: NDArray[np.float64]
    """Their places on the aperture, (CHECKS,)."""
    v: NDArray[np.float64]
    weight: NDArray[np.float64]
    """Falloff of each, 0 for one that is not detected, −1 for one far beside, (CHECKS,)."""
    amplitude: NDArray[np.float64]
    """Amplitude of each that takes the path, (CHECKS,)."""
    detected: NDArray[np.int64]
    """How many are, (1,)."""


_each = (CHECKS,)
CHECK_RAYS = layout(CheckRays, s=_each, v=_each, weight=_each, amplitude=_each, detected=(1,))


@register_jitable
def place_of(tile: Tile, symmetric: bool, number: int) -> tuple[float, float]:
    """Return the place (s, v) of a check ray among those of a tile."""
    along_x = _ALONG_X if symmetric else CHECKS
    if number < along_x:
        low, high = across(tile.s_min, symmetric), across(tile.s_max, symmetric)
        xi = low + (high - low) * (number + 0.5) / along_x
        return xi * xi if symmetric else xi, tile.v_min + _NEAR * (tile.v_max - tile.v_min)
    low, high = math.sqrt(tile.v_min), math.sqrt(tile.v_max)
    y = low + (high - low) * (number - along_x + 0.5) / (CHECKS - along_x)
    return tile.s_min + _NEAR * (tile.s_max - tile.s_min), y * y


@register_jitable(forceinline=True)
def weight_of(
    x: float, y: float, cos: float, inside: float, radius: float, model: Parabola | Series
) -> float:
    """Return a returning ray's `CheckRays.weight`; x and y are times cos θ."""
    squared = (x * x + y * y) / (radius * radius)
    if squared > (_BESIDE * cos) ** 2:
        return -1.0
    if inside <= 0 or squared >= cos * cos:
        return 0.0
    return falloff_at(model, squared / (cos * cos), 0.0)


@register_jitable(forceinline=True)
def _is_in(checks: CheckRays, i: int, tile: Tile) -> bool:
    s: float = checks.s[i]
    v: float = checks.v[i]
    return tile.s_min <= s <= tile.s_max and tile.v_min <= v <= tile.v_max


@register_jitable
def field_seen(checks: CheckRays, tile: Tile, symmetric: bool) -> float:
    """Return what field a tile may have, from the check rays that are detected there; 0 if none."""
    amplitude = 0.0
    if checks.detected[0] > 0:
        for i in range(CHECKS):
            if checks.weight[i] > 0 and _is_in(checks, i, tile):
                amplitude = max(amplitude, abs(checks.amplitude[i]))
    return amplitude * fraction(tile, symmetric) if amplitude > 0 else 0.0


@register_jitable
def sees_beside(checks: CheckRays, tile: Tile, part: Tile) -> bool:
    """Return whether a check ray is detected in a tile, but not in some part of it."""
    if checks.detected[0] > 0:
        for i in range(CHECKS):
            if checks.weight[i] > 0 and _is_in(checks, i, tile) and not _is_in(checks, i, part):
                return True
    return False


@register_jitable
def weight_error(checks: CheckRays, cut: Cut, line: TileLine) -> float:
    """Return how far off a tile's polynomials put the falloff of check rays, evened out."""
    worst = 0.0
    for i in range(CHECKS):
        if checks.weight[i] < 0 or not _is_in(checks, i, cut.tile):
            continue
        xi, y = across(checks.s[i], cut.symmetric), math.sqrt(checks.v[i])
        set_line(cut, xi, line)
        to_x, to_y, cos = returning(cut, line, y)
        inside = 0.0
        for b in range(cut.m):
            inside += line.inside[b] * line.u[b]
        to_x, to_y = to_x * across_place(cut, xi, y), to_y * y
        weight = max(weight_of(to_x, to_y, cos, inside, cut.detector_radius, cut.falloff), 0.0)
        # at the rim the falloff may jump, and at its own edge: that is those edges' error
        squared = (to_x * to_x + to_y * to_y) / (cut.detector_radius * cos) ** 2
        at_edge = cut.falloff.edge > 0 and abs(squared - 1) < _AT_EDGE
        if not at_edge and (abs(inside) > 1e-3 * cos * cos or weight == 0):
            worst = max(worst, abs(weight - checks.weight[i]))
    return _EVENED_OUT * worst
