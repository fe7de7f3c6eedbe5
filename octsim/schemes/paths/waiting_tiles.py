"""Tiles that wait to be integrated: the one of the largest field comes next."""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.records import layout, room
from octsim.schemes.paths.aperture_tiles import Tile, across, halves

MOST_TILES = 4096
"""Tiles of one path that can wait."""


class OpenTile(NamedTuple):
    """A tile that is still to be integrated, and how that is to be tried."""

    tile: Tile
    n: int
    """Number of nodes along s."""
    m: int
    """Number of nodes along v."""
    kind: int
    """Of its nodes, `chebyshev.FIT` or `chebyshev.LOOK`."""
    allotment: float
    """Part of the path's error that it may have."""
    bound: float
    """Estimate of its field."""
    coarser_error: float
    """Error estimate with fewer nodes; infinite if there were none."""


class WaitingTiles:
    """Room for open tiles, in no order."""

    rows: NDArray[np.float64]
    """The numbers of each, (MOST_TILES, 10)."""
    num: NDArray[np.int64]
    """How many wait, (1,)."""


WAITING_TILES = layout(WaitingTiles, rows=(MOST_TILES, 10), num=(1,))


def room_for_waiting() -> WaitingTiles:
    """Make the room that tiles wait in; none do."""
    made: WaitingTiles = room(WAITING_TILES)
    made.num[0] = 0
    return made


@register_jitable
def push(waiting: WaitingTiles, one: OpenTile) -> None:
    """Have a tile wait."""
    row = waiting.rows[waiting.num[0]]
    row[0], row[1], row[2], row[3] = one.tile
    row[4], row[5], row[6] = one.n, one.m, one.kind
    row[7], row[8], row[9] = one.allotment, one.bound, one.coarser_error
    waiting.num[0] += 1


@register_jitable
def push_halves(waiting: WaitingTiles, one: OpenTile, symmetric: bool) -> None:
    """Cut a tile in two across its longer side, and have both wait."""
    tile = one.tile
    tall = math.sqrt(tile.v_max) - math.sqrt(tile.v_min) > (
        across(tile.s_max, symmetric) - across(tile.s_min, symmetric)
    )
    first, second = halves(tile, symmetric, tall)
    allotment, bound = 0.7 * one.allotment, 0.5 * one.bound
    push(waiting, OpenTile(first, one.n, one.m, one.kind, allotment, bound, np.inf))
    push(waiting, OpenTile(second, one.n, one.m, one.kind, allotment, bound, np.inf))


@register_jitable
def pop_strongest(waiting: WaitingTiles) -> OpenTile:
    """Take out the tile of the largest estimated field."""
    last = waiting.num[0] - 1
    best = last
    for i in range(last):
        if waiting.rows[i, 8] > waiting.rows[best, 8]:
            best = i
    row = waiting.rows[best]
    strongest = OpenTile(
        Tile(row[0], row[1], row[2], row[3]), int(row[4]), int(row[5]), int(row[6]), row[7],
        row[8], row[9],
    )  # fmt: skip
    for i in range(row.size):  # a slice assigned takes more than a second to compile
        row[i] = waiting.rows[last, i]
    waiting.num[0] = last
    return strongest
