"""The aperture in tiles: rectangles in which a disk is a square.

Places on the aperture are (ξ, y), with x = ξ √(1 − y²), all over its radius: a disk is then the
square |ξ|, |y| ≤ 1. A tile is a rectangle in (s, v), where v = y² and s = ξ², or s = ξ for a scene
that is not symmetric in x; where light goes is a smooth function of those.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray


class Tile(NamedTuple):
    """A rectangle of the aperture, in (s, v)."""

    s_min: float
    s_max: float
    v_min: float
    v_max: float


@register_jitable(forceinline=True)
def across(s: float, symmetric: bool) -> float:
    """Return the place ξ for the coordinate s."""
    return math.sqrt(max(s, 0.0)) if symmetric else s


@register_jitable(forceinline=True)
def area(tile: Tile, symmetric: bool) -> float:
    """Return the area of a tile on the aperture, of a disk of radius 1."""
    low, high = math.sqrt(tile.v_min), math.sqrt(tile.v_max)
    width = across(tile.s_max, symmetric) - across(tile.s_min, symmetric)
    middle = 0.5 * (low + high)
    # Simpson's rule is near enough for what an area is used for here
    chords = math.sqrt(1 - low * low) + 4 * math.sqrt(1 - middle * middle)
    return width * (high - low) * (chords + math.sqrt(max(1 - high * high, 0.0))) / 6


@register_jitable(forceinline=True)
def images(symmetric: bool) -> float:
    """Return how often mirror images repeat a part of the aperture, over the disk's area π."""
    return (4.0 if symmetric else 2.0) / math.pi


@register_jitable(forceinline=True)
def fraction(tile: Tile, symmetric: bool) -> float:
    """Return the fraction of the aperture that a tile and its mirror images make up."""
    return images(symmetric) * area(tile, symmetric)


@register_jitable
def halves(tile: Tile, symmetric: bool, along_y: bool) -> tuple[Tile, Tile]:
    """Return the halves of a tile cut across x, or across y."""
    if along_y:
        middle = 0.5 * (math.sqrt(tile.v_min) + math.sqrt(tile.v_max))
        v = middle * middle
        return (
            Tile(tile.s_min, tile.s_max, tile.v_min, v),
            Tile(tile.s_min, tile.s_max, v, tile.v_max),
        )
    middle = 0.5 * (across(tile.s_min, symmetric) + across(tile.s_max, symmetric))
    s = middle * middle if symmetric else middle
    return (
        Tile(tile.s_min, s, tile.v_min, tile.v_max),
        Tile(s, tile.s_max, tile.v_min, tile.v_max),
    )


@register_jitable
def between(
    tile: Tile, n: int, m: int, along_s: NDArray[np.float64], along_v: NDArray[np.float64],
    left: int, right: int, below: int, above: int,
) -> Tile:  # fmt: skip
    """Return the part of a tile between some of its nodes; the outermost stand for its edges."""
    s, v = tile.s_max - tile.s_min, tile.v_max - tile.v_min
    return Tile(
        tile.s_min + s * along_s[left] if left > 0 else tile.s_min,
        tile.s_min + s * along_s[right] if right < n - 1 else tile.s_max,
        tile.v_min + v * along_v[below] if below > 0 else tile.v_min,
        tile.v_min + v * along_v[above] if above < m - 1 else tile.v_max,
    )
