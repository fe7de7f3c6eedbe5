"""Tiles that wait to be integrated: the one of the largest field comes next."""

import math

import numpy as np
from numba.extending import register_jitable

from octsim.schemes.paths.aperture_tiles import Tile, across, halves
from octsim.schemes.paths.workspace import Agenda, Task


@register_jitable
def push(
    agenda: Agenda, top: int, tile: Tile, n: int, m: int, kind: int, share: float, bound: float,
    off: float,
) -> int:  # fmt: skip
    """Have a tile wait; give the number of the last one."""
    agenda.tiles[top + 1] = tile
    agenda.orders[top + 1, 0], agenda.orders[top + 1, 1] = n, m
    agenda.kinds[top + 1], agenda.shares[top + 1] = kind, share
    agenda.bounds[top + 1], agenda.offs[top + 1] = bound, off
    return top + 1


@register_jitable
def push_halves(
    task: Task, agenda: Agenda, top: int, tile: Tile, n: int, m: int, kind: int, share: float,
    bound: float,
) -> int:  # fmt: skip
    """Cut a tile in two across its longer side, and have both wait."""
    tall = math.sqrt(tile.v_max) - math.sqrt(tile.v_min) > (
        across(tile.s_max, task.symmetric) - across(tile.s_min, task.symmetric)
    )
    one, other = halves(tile, task.symmetric, tall)
    top = push(agenda, top, one, n, m, kind, 0.7 * share, 0.5 * bound, np.inf)
    return push(agenda, top, other, n, m, kind, 0.7 * share, 0.5 * bound, np.inf)


@register_jitable
def promising(agenda: Agenda, top: int) -> None:
    """Put the tile of the largest field last among those that wait."""
    best = top
    for i in range(top):
        if agenda.bounds[i] > agenda.bounds[best]:
            best = i
    if best != top:
        for k in range(4):
            a, b = agenda.tiles[best, k], agenda.tiles[top, k]
            agenda.tiles[best, k], agenda.tiles[top, k] = b, a
        for k in range(2):
            p, q = agenda.orders[best, k], agenda.orders[top, k]
            agenda.orders[best, k], agenda.orders[top, k] = q, p
        p, q = agenda.kinds[best], agenda.kinds[top]
        agenda.kinds[best], agenda.kinds[top] = q, p
        for values in (agenda.shares, agenda.bounds, agenda.offs):
            a, b = values[best], values[top]
            values[best], values[top] = b, a
