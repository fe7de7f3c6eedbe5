"""One light path integrated over its patch: tiles shrunk, given more nodes, or cut in two.

A tile that all rays take the path of is fitted with polynomials; of a *partially covered* one, the
cells between its nodes are judged by their corners. Each ends in weighted nodes whose error is
allowed, or is left out as too faint to matter.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable

from octsim.schemes.paths.aperture_tiles import Tile, area, fraction
from octsim.schemes.paths.chebyshev import FIT, HIGHEST, LOOK
from octsim.schemes.paths.check_rays import field_seen, sees_beside
from octsim.schemes.paths.kept_rays import WeightedRays, keep_tile
from octsim.schemes.paths.line_crossings import LESS_S, LESS_V
from octsim.schemes.paths.partial_tiles import MOST_TO_LOOK, look, look_closely
from octsim.schemes.paths.patch_by_fit import holding
from octsim.schemes.paths.progress import PathGoal, Progress, left_out, spare
from octsim.schemes.paths.tile_nodes import (
    CRUDE,
    field_errors,
    followed_of,
    map_errors,
    map_tile,
    rim_errors,
    sum_tile,
    weigh,
    weigh_crudely,
)
from octsim.schemes.paths.waiting_tiles import MOST_TILES, OpenTile, push, push_halves
from octsim.schemes.paths.workspace import Point, Workspace
from octsim.tracing.lanes import LANES

# by how much an error falls with each order, typically (its logarithm)
_RATE_S, _RATE_V = 1.2, 2.5


class TileErrors(NamedTuple):
    """Error estimate of a fitted tile: along s, along v, and in all."""

    along_s: float
    along_v: float
    total: float


@register_jitable
def _kept(
    rays: WeightedRays, goal: PathGoal, work: OpenTile, space: Workspace, progress: Progress,
    size: float, filled: float, error: float,
) -> tuple[WeightedRays, Progress]:  # fmt: skip
    rays, count = keep_tile(rays, progress.nodes, goal.code, work.n, work.m, space)
    return rays, Progress(
        count, progress.size + size, progress.filled + filled, progress.error + error,
        progress.missing, progress.segments,
    )  # fmt: skip


@register_jitable
def typical_orders(ratio: float) -> tuple[int, int]:
    """Return the orders along s and v that a patch's tile typically needs, by field over error."""
    digits = max(math.log10(ratio) - 0.7, 0.0)
    return max(4, round(1.7 * digits + 1.5)), max(3, round(0.7 * digits + 2))


@register_jitable
def raise_orders(
    work: OpenTile, smaller: Tile, errors: TileErrors, tolerance: float
) -> tuple[int, int]:
    """Return how many nodes a tile's shrunk part needs along each axis for an error in tolerance.

    From the errors of the tile itself along s and v, and how errors fall, typically.
    """
    tile, n, m = work.tile, work.n, work.m
    narrower_s = (smaller.s_max - smaller.s_min) / (tile.s_max - tile.s_min)
    narrower_v = (smaller.v_max - smaller.v_min) / (tile.v_max - tile.v_min)
    error_s = errors.along_s * narrower_s ** (n - LESS_S)
    error_v = errors.along_v * narrower_v ** (m - LESS_V)
    more_s = math.ceil(math.log(max(2 * error_s / tolerance, 1.0)) / _RATE_S)
    more_v = math.ceil(math.log(max(2 * error_v / tolerance, 1.0)) / _RATE_V)
    if more_s + more_v == 0 and narrower_s * narrower_v > 0.6:
        more_s, more_v = (1, 0) if error_s > error_v else (0, 1)
    return n + min(more_s, 6), m + min(more_v, 2)


@register_jitable
def _refine(
    point: Point, work: OpenTile, rest: OpenTile, empty: bool, errors: TileErrors, tolerance: float,
    space: Workspace,
) -> None:  # fmt: skip
    """Have what is left of a fitted tile wait: as it is, with more nodes, or in halves.

    `rest` is that part, with the orders to begin with; `empty` is a tile where no patch is seen,
    though there may be one.
    """
    n, m, expected = work.n, work.m, np.inf
    shrinks = area(rest.tile, point.symmetric) / area(work.tile, point.symmetric)
    if shrinks < 0.5:
        n, m = typical_orders(rest.bound / tolerance)
    elif errors.total > 0.5 * work.coarser_error:
        n, m = LANES, LANES  # more nodes do not help
    elif empty:
        n, m, expected = n + 2, m + 1, errors.total
    else:
        n, m = raise_orders(work, rest.tile, errors, tolerance)
        expected = errors.total
    if n <= HIGHEST and m <= HIGHEST and n * m <= LANES:
        push(space.waiting, OpenTile(rest.tile, n, m, FIT, rest.allotment, rest.bound, expected))
    elif shrinks < 0.5:
        push(space.waiting, rest)
    else:
        push_halves(space.waiting, rest, point.symmetric)


@register_jitable
def _fit(
    point: Point, goal: PathGoal, work: OpenTile, rest: OpenTile, strongest: float, end: bool,
    space: Workspace, rays: WeightedRays, progress: Progress,
) -> tuple[WeightedRays, Progress]:  # fmt: skip
    """Keep a fitted tile's nodes if their error is allowed, else refine it.

    `rest` is the part that the patch can be in, `strongest` the largest amplitude.
    """
    tile, n, m, field = work.tile, work.n, work.m, rest.bound
    seen = field_seen(space.checks, tile, point.symmetric) > 0
    relative = goal.relative * work.allotment
    tolerance = relative * max(goal.scale, progress.size)
    map_s, map_v = map_errors(point, tile, n, m, space)
    field_s, field_v = field_errors(point, n, m, space)
    rim_s, rim_v = rim_errors(n, m, space)
    # of a field of that size at each place, with half the falloff
    typical = 0.5 * field
    error_s = typical * (field_s / strongest + map_s + rim_s)
    error_v = typical * (field_v / strongest + map_v + rim_v)
    error, total, size = error_s + error_v, -1.0, 0.0
    # the integral costs more than a look at the coefficients, which overestimates the error
    if end or error <= 30 * max(tolerance, relative * typical):
        close = 0.1 * max(tolerance, 0.1 * relative * field) / strongest
        total, off = weigh(point, tile, n, m, close, space)
        size, error = sum_tile(point, n, m, space)
        # what ends at an edge with some amplitude jumps there
        edge = point.falloff.edge * (map_s + map_v)
        error += (rim_s + rim_v + edge) * total * strongest
        error += off * max(total * strongest, field if seen else 0.0)
        tolerance = relative * max(goal.scale, progress.size + size)
    if total > 0 and (error <= tolerance or end):
        return _kept(rays, goal, work, space, progress, size, total, error)
    # where no patch is seen there is at most a rim, as faint as the map's error leaves room for
    rim = field * min(1.0, 4 * (map_s + map_v))
    if end or (total == 0 and not seen and rim <= 0.25 * spare(goal, progress)):
        return rays, left_out(progress, rim)
    _refine(
        point, work, rest, total == 0, TileErrors(error_s, error_v, error),
        max(tolerance, relative * typical), space,
    )  # fmt: skip
    return rays, progress


@register_jitable
def settle(
    point: Point, goal: PathGoal, work: OpenTile, space: Workspace, rays: WeightedRays,
    progress: Progress,
) -> tuple[WeightedRays, Progress]:  # fmt: skip
    """Deal with the tile whose rays a bundle holds: keep its nodes, refine it or leave it out.

    Parameters
    ----------
    point : Point
        What is integrated.
    goal : PathGoal
        The path, and what its error may be.
    work : OpenTile
        The tile.
    space : Workspace
        The bundle, the tiles that wait, and room to work in.
    rays : WeightedRays
        Nodes kept.
    progress : Progress
        What has become of the path.

    Returns
    -------
    rays, progress
        Both as they are then.
    """
    stride, symmetric = work.m, point.symmetric
    end = progress.segments > goal.budget or space.waiting.num[0] + 5 > MOST_TILES
    followed, strongest = followed_of(space, work.n * work.m)
    if followed == 0:
        seen = field_seen(space.checks, work.tile, symmetric)
        if end or seen <= 0.25 * spare(goal, progress):
            return rays, left_out(progress, seen)
        push_halves(space.waiting, work, symmetric)
        return rays, progress
    if work.kind == LOOK and max(work.n, work.m) > MOST_TO_LOOK:
        missing = look_closely(
            point, work, spare(goal, progress), goal, followed == work.n * work.m, space
        )
        return rays, left_out(progress, missing)
    if followed < work.n * work.m:
        allowed = goal.relative * work.allotment * max(goal.scale, progress.size)
        guess = CRUDE * fraction(work.tile, symmetric) * strongest
        # the survey's look at the whole aperture comes before any segment
        crude = progress.segments > 0 and work.kind == LOOK and guess <= allowed
        if end or crude:
            size, error = weigh_crudely(point, work.tile, work.n, work.m, work.kind, space)
            return _kept(rays, goal, work, space, progress, size, 0.0, error)
        missing, work = look(point, work, spare(goal, progress), goal.extrapolation, space)
        progress = left_out(progress, missing)
        if work.n == 0:
            return rays, progress
    map_tile(point, work.tile, work.n, work.m, stride, work.kind, space)
    cells, smaller = holding(
        space.returns, work.n, work.m, work.tile, symmetric, point.detector.radius, space.search
    )
    if sees_beside(space.checks, work.tile, smaller) or (
        cells == 0 and field_seen(space.checks, work.tile, symmetric) > 0
    ):
        cells, smaller = 1.0, work.tile  # the polynomials are wrong
    field = cells * strongest * fraction(work.tile, symmetric)
    if field <= 0.25 * spare(goal, progress):
        return rays, left_out(progress, field)
    n, m = goal.orders
    rest = OpenTile(smaller, n, m, FIT, work.allotment, field, np.inf)
    if work.kind == LOOK:
        push(space.waiting, rest)
        return rays, progress
    return _fit(point, goal, work, rest, strongest, end, space, rays, progress)
