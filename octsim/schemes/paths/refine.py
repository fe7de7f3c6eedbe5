"""One light path integrated over its patch: tiles shrunk, given more nodes, or cut in two.

A tile that all rays take the path of is fitted with polynomials; of one that they do not all take,
cells between its nodes are judged by their corners. Each ends in weighted nodes whose error is
allowed, or is left out as too faint to matter.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable

from octsim.schemes.paths.aperture_tiles import Tile, area, between, fraction
from octsim.schemes.paths.chebyshev import FIT, HIGHEST, LOOK
from octsim.schemes.paths.line_crossings import LESS_S, LESS_V
from octsim.schemes.paths.patch_by_corners import Cells, corner, reached
from octsim.schemes.paths.patch_by_fit import holding
from octsim.schemes.paths.tile_nodes import (
    CRUDE,
    field_errors,
    followed_of,
    keep_tile,
    map_errors,
    map_tile,
    rim_errors,
    sum_tile,
    weigh,
    weigh_crudely,
)
from octsim.schemes.paths.waiting_tiles import push, push_halves
from octsim.schemes.paths.workspace import MOST_TILES, Agenda, Found, Room, Task
from octsim.tracing.lanes import LANES

MIXED = 4
"""Nodes along each axis of a tile of which not all rays take the path."""
SPARE = 2.5
"""What may be left out of all paths, over the error that one path may have."""
# by how much an error falls with each order, typically (its logarithm)
_RATE_S, _RATE_V = 1.2, 2.5


class Work(NamedTuple):
    """A tile under work."""

    tile: Tile
    n: int
    m: int
    kind: int
    share: float
    """Of the error that is allowed."""
    given: float
    """Error with fewer nodes; infinite if there were none."""


class Allowed(NamedTuple):
    """What one path's error may be."""

    relative: float
    """Over the field."""
    scale: float
    """Field of all paths, as far as it is known."""
    left_out: float
    """Field left out already, of other paths."""
    beyond: float
    """How far quantities may go on beyond known corners; see `patch_by_corners`."""
    orders: tuple[int, int]
    """Numbers of nodes along s and v to begin with."""
    budget: int
    """Segments that may be traced."""


class Tally(NamedTuple):
    """What has become of a path so far."""

    nodes: int
    """Nodes kept, of all paths."""
    size: float
    """Sum of the tiles' fields, as magnitudes."""
    filled: float
    """Integral of the falloff over the patch."""
    error: float
    missing: float
    """Field that was left out."""


@register_jitable(forceinline=True)
def _spare(allowed: Allowed, tally: Tally) -> float:
    """Give what may still be left out."""
    may = SPARE * allowed.relative * max(allowed.scale, tally.size)
    return max(may - allowed.left_out - tally.missing, 0.0)


@register_jitable(forceinline=True)
def _left_out(tally: Tally, field: float) -> Tally:
    return Tally(tally.nodes, tally.size, tally.filled, tally.error, tally.missing + field)


@register_jitable
def _kept(
    found: Found, code: int, work: Work, room: Room, tally: Tally, size: float, filled: float,
    error: float,
) -> tuple[Found, Tally]:  # fmt: skip
    found, count = keep_tile(found, tally.nodes, code, work.n, work.m, room)
    return found, Tally(
        count, tally.size + size, tally.filled + filled, tally.error + error, tally.missing
    )


@register_jitable
def typical_orders(ratio: float) -> tuple[int, int]:
    """Give the orders along s and v that a patch's tile typically needs, for a field over error."""
    digits = max(math.log10(ratio) - 0.7, 0.0)
    return max(4, round(1.7 * digits + 1.5)), max(3, round(0.7 * digits + 2))


@register_jitable
def raise_orders(
    tile: Tile, smaller: Tile, n: int, m: int, off_s: float, off_v: float, tolerance: float
) -> tuple[int, int]:
    """Tell how many nodes a tile's shrunk part needs along each axis for an error in tolerance.

    From the errors of the tile itself along s and v, and how errors fall, typically.
    """
    narrower_s = (smaller.s_max - smaller.s_min) / (tile.s_max - tile.s_min)
    narrower_v = (smaller.v_max - smaller.v_min) / (tile.v_max - tile.v_min)
    off_s *= narrower_s ** (n - LESS_S)
    off_v *= narrower_v ** (m - LESS_V)
    more_s = math.ceil(math.log(max(2 * off_s / tolerance, 1.0)) / _RATE_S)
    more_v = math.ceil(math.log(max(2 * off_v / tolerance, 1.0)) / _RATE_V)
    if more_s + more_v == 0 and narrower_s * narrower_v > 0.6:
        more_s, more_v = (1, 0) if off_s > off_v else (0, 1)
    return n + min(more_s, 6), m + min(more_v, 2)


@register_jitable
def _look(
    task: Task,
    agenda: Agenda,
    top: int,
    work: Work,
    spare: float,
    beyond: float,
    room: Room,
) -> tuple[int, float, Work]:
    """Have the parts of a tile wait of which not all rays take the path, or leave them out.

    Returns the new top, what is left out, and the corner next to the axes, if all rays of p x q
    nodes there do take it; its n is 0 if there is none.
    """
    tile, n, m, kind, share, _ = work
    along_s, along_v, radius = task.nodes_s[kind, n], task.nodes_v[kind, m], task.detector.radius
    p, q = corner(room.bundle.followed, n, m) if kind == LOOK else (0, 0)
    missing = 0.0
    # all of the tile, or what lies to the right of the corner and above it
    parts = (
        Cells(max(p - 1, 0), n - 1, 0, m - 1),
        Cells(0, max(p - 1, 0), max(q - 1, 0), m - 1),
    )
    for cells in parts:
        bound, part = reached(
            room.bundle, n, m, along_s, along_v, tile, cells, task.symmetric, radius, beyond
        )
        if bound <= 0.25 * max(spare - missing, 0.0):
            missing += bound
        elif area(part, task.symmetric) < 0.6 * area(tile, task.symmetric):
            top = push(agenda, top, part, MIXED, MIXED, LOOK, share, bound, np.inf)
        else:
            top = push_halves(task, agenda, top, part, MIXED, MIXED, LOOK, share, bound)
    if p == 0:
        return top, missing, Work(tile, 0, 0, kind, share, np.inf)
    near = between(tile, n, m, along_s, along_v, 0, p - 1, 0, q - 1)
    return top, missing, Work(near, p, q, kind, share, np.inf)


@register_jitable
def _refine(
    task: Task, agenda: Agenda, top: int, work: Work, smaller: Tile, orders: tuple[int, int],
    empty: bool, off: float, off_s: float, off_v: float, tolerance: float, bound: float,
) -> int:  # fmt: skip
    """Have what is left of a fitted tile wait: as it is, with more nodes, or in halves.

    `off` is its error, `off_s` and `off_v` the parts along s and v; `empty` is one where no patch
    is seen, though there may be one; `bound` is what its field may be.
    """
    n, m, expected = work.n, work.m, np.inf
    shrinks = area(smaller, task.symmetric) / area(work.tile, task.symmetric)
    if shrinks < 0.5:
        n, m = typical_orders(bound / tolerance)
    elif off > 0.5 * work.given:
        n, m = LANES, LANES  # more nodes do not help
    elif empty:
        n, m, expected = n + 2, m + 1, off
    else:
        n, m = raise_orders(work.tile, smaller, n, m, off_s, off_v, tolerance)
        expected = off
    if n <= HIGHEST and m <= HIGHEST and n * m <= LANES:
        return push(agenda, top, smaller, n, m, FIT, work.share, bound, expected)
    n, m = orders
    if shrinks < 0.5:
        return push(agenda, top, smaller, n, m, FIT, work.share, bound, np.inf)
    return push_halves(task, agenda, top, smaller, n, m, FIT, work.share, bound)


@register_jitable
def _fit(
    task: Task, code: int, agenda: Agenda, top: int, work: Work, smaller: Tile, field: float,
    strongest: float, allowed: Allowed, end: bool, room: Room, found: Found, tally: Tally,
) -> tuple[Found, int, Tally]:  # fmt: skip
    """Keep a fitted tile's nodes if their error is allowed, else refine it.

    `field` is what the part that the patch can be in may contribute, `strongest` the largest
    amplitude.
    """
    tile, n, m, _, share, _ = work
    relative = allowed.relative * share
    tolerance = relative * max(allowed.scale, tally.size)
    map_s, map_v = map_errors(task, tile, n, m, room)
    field_s, field_v = field_errors(task, n, m, room)
    rim_s, rim_v = rim_errors(n, m, room)
    # of a field of that size at each place, with half the falloff
    typical = 0.5 * field
    off_s = typical * (field_s / strongest + map_s + rim_s)
    off_v = typical * (field_v / strongest + map_v + rim_v)
    off, total, size = off_s + off_v, -1.0, 0.0
    # the integral costs more than a look at the coefficients, which overestimates the error
    if end or off <= 30 * max(tolerance, relative * typical):
        close = 0.1 * max(tolerance, 0.1 * relative * field) / strongest
        total = weigh(task, tile, n, m, close, room)
        size, off = sum_tile(task, n, m, room)
        off += (rim_s + rim_v) * total * strongest
        tolerance = relative * max(allowed.scale, tally.size + size)
    if total > 0 and (off <= tolerance or end):
        found, tally = _kept(found, code, work, room, tally, size, total, off)
        return found, top, tally
    # where no patch is seen there is at most a rim, as faint as the map's error leaves room for
    rim = field * min(1.0, 4 * (map_s + map_v))
    if end or (total == 0 and rim <= 0.25 * _spare(allowed, tally)):
        return found, top, _left_out(tally, rim)
    top = _refine(
        task, agenda, top, work, smaller, allowed.orders, total == 0, off, off_s, off_v,
        max(tolerance, relative * typical), field,
    )  # fmt: skip
    return found, top, tally


@register_jitable
def settle(
    task: Task, code: int, agenda: Agenda, top: int, work: Work, allowed: Allowed, spent: bool,
    looked: bool, room: Room, found: Found, tally: Tally,
) -> tuple[Found, int, Tally]:  # fmt: skip
    """Deal with the tile whose rays a bundle holds: keep its nodes, refine it or leave it out.

    Parameters
    ----------
    task : Task
        The point.
    code : int
        Code of the path.
    agenda : Agenda
        Tiles that wait.
    top : int
        Number of the last one.
    work : Work
        The tile.
    allowed : Allowed
        What the error may be.
    spent : bool
        Whether no more segments may be traced.
    looked : bool
        Whether this is not the survey's look at the whole aperture.
    room : Room
        The bundle, and room to work in.
    found : Found
        Nodes kept.
    tally : Tally
        What has become of the path.

    Returns
    -------
    found, top, tally
        All three as they are then.
    """
    stride, end = work.m, spent or top + 6 > MOST_TILES
    followed, strongest = followed_of(room, work.n * work.m)
    if followed == 0:
        return found, top, tally
    if followed < work.n * work.m:
        allowed_here = allowed.relative * work.share * max(allowed.scale, tally.size)
        guess = CRUDE * fraction(work.tile, task.symmetric) * strongest
        if end or (looked and work.kind == LOOK and guess <= allowed_here):
            size, off = weigh_crudely(task, work.tile, work.n, work.m, work.kind, room)
            found, tally = _kept(found, code, work, room, tally, size, 0.0, off)
            return found, top, tally
        top, missing, work = _look(
            task, agenda, top, work, _spare(allowed, tally), allowed.beyond, room
        )
        tally = _left_out(tally, missing)
        if work.n == 0:
            return found, top, tally
    map_tile(task, work.tile, work.n, work.m, stride, work.kind, room)
    part, smaller = holding(
        room.returns, work.n, work.m, work.tile, task.symmetric, task.detector.radius, room.search
    )
    field = part * strongest * fraction(work.tile, task.symmetric)
    if field <= 0.25 * _spare(allowed, tally):
        return found, top, _left_out(tally, field)
    if work.kind == LOOK:
        n, m = allowed.orders
        return found, push(agenda, top, smaller, n, m, FIT, work.share, field, np.inf), tally
    return _fit(
        task, code, agenda, top, work, smaller, field, strongest, allowed, end, room, found, tally
    )
