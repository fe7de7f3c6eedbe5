"""What becomes of a tile of which not all rays take a path."""

import math

import numpy as np
import pytest

from octsim.optics.detector import fibre_detector
from octsim.optics.turned_rays import STRAIGHT
from octsim.schemes.paths.aperture_tiles import Tile, fraction
from octsim.schemes.paths.chebyshev import FIT, LOOK
from octsim.schemes.paths.falloffs import Parabola
from octsim.schemes.paths.kept_rays import WeightedRays, room_for_nodes
from octsim.schemes.paths.partial_tiles import MIXED, look, look_closely
from octsim.schemes.paths.progress import PathGoal, Progress
from octsim.schemes.paths.refine import settle
from octsim.schemes.paths.tile_nodes import CRUDE
from octsim.schemes.paths.waiting_tiles import MOST_TILES, OpenTile, pop_strongest
from octsim.schemes.paths.workspace import Point, Workspace, room_for_point, tables_of

DETECTOR = fibre_detector(0.5, 1.52, 300.0, 20.0, 4.4)
POINT = Point(True, DETECTOR, 0.5, 8.3, 9.7, Parabola(), STRAIGHT, tables_of(True))
WHOLE, AMPLITUDE, CODE = Tile(0.0, 1.0, 0.0, 1.0), 0.1, 89


def space_of(without: tuple[int, ...] = ()) -> Workspace:
    """Return a workspace whose rays return near the axis, but for some that are lost."""
    space = room_for_point()
    bundle = space.bundle
    bundle.followed[:], bundle.cos[:], bundle.inside[:] = True, 1.0, 0.5
    bundle.x[:], bundle.y[:] = 0.1 * DETECTOR.radius, 0.2 * DETECTOR.radius
    bundle.amplitude[:], bundle.optical_path_length[:] = AMPLITUDE, 1.0
    for ray in without:
        bundle.followed[ray] = False
    space.checks.detected[0], space.waiting.num[0] = 0, 0
    return space


def goal_of(relative: float, scale: float) -> PathGoal:
    return PathGoal(CODE, relative, scale, 0.0, 0.5, (7, 5), 1000)


def nodes_kept(goal: PathGoal, tile: Tile, waiting: int = 0) -> tuple[int, int]:
    """Return how many nodes are kept of a partially covered tile, and how many tiles then wait."""
    space = space_of(without=(5,))
    space.waiting.num[0] = waiting
    work = OpenTile(tile, MIXED, MIXED, LOOK, 1.0, 0.1, math.inf)
    progress = Progress(0, 0.0, 0.0, 0.0, 0.0, 1)
    rays = room_for_nodes(False)
    assert isinstance(rays, WeightedRays)
    _, progress = settle(POINT, goal, work, space, rays, progress)
    return progress.nodes, int(space.waiting.num[0]) - waiting


@pytest.mark.parametrize("scale", [0.02, 1.0, 50.0])
def test_a_tile_is_weighed_crudely_where_that_is_within_the_error_of_the_whole(
    scale: float,
) -> None:
    tile = Tile(0.2, 0.3, 0.2, 0.3)
    crude = CRUDE * fraction(tile, True) * AMPLITUDE / scale
    assert nodes_kept(goal_of(1.01 * crude, scale), tile) == (MIXED * MIXED, 0)
    nodes, waiting = nodes_kept(goal_of(0.99 * crude, scale), tile)
    assert nodes == 0
    assert waiting > 0


def test_tiles_are_cut_as_long_as_there_is_room_for_what_one_leaves() -> None:
    goal = goal_of(1e-9, 1.0)
    assert nodes_kept(goal, WHOLE, MOST_TILES - 4) == (MIXED * MIXED, 0)
    nodes, waiting = nodes_kept(goal, WHOLE, MOST_TILES - 5)
    assert nodes == 0
    assert 0 < waiting <= 5


def test_of_a_partly_covered_tile_the_corner_at_the_axes_is_fitted_and_the_rest_waits() -> None:
    n = m = 5
    space = space_of(without=(3 * m + 3,))
    work = OpenTile(WHOLE, n, m, LOOK, 0.7, 0.1, math.inf)
    missing, corner = look(POINT, work, 0.0, 0.5, space)
    nodes = np.asarray(POINT.tables.nodes_s[LOOK, n, :n])
    assert missing == 0
    assert corner == OpenTile(WHOLE._replace(s_max=nodes[2]), 3, 5, LOOK, 0.7, 0.0, math.inf)
    assert space.waiting.num[0] == 1
    rest = pop_strongest(space.waiting)
    # light is detected at nodes of each cell: as much as the aperture has there, nearly
    expected = WHOLE._replace(s_min=nodes[2])
    assert rest[:5] == (expected, MIXED, MIXED, LOOK, 0.7)
    assert rest.bound == pytest.approx(AMPLITUDE * fraction(expected, True), rel=0.1)


def test_what_may_be_left_out_does_not_wait() -> None:
    space = space_of(without=(18,))
    missing, _ = look(POINT, OpenTile(WHOLE, 5, 5, LOOK, 0.7, 0.1, math.inf), 1.0, 0.5, space)
    assert 0 < missing <= 0.25
    assert space.waiting.num[0] == 0


def test_a_survey_that_all_take_goes_on_as_one_tile_with_the_orders_of_its_path() -> None:
    n, m, goal = 12, 6, goal_of(1e-6, 1.0)
    space = space_of()
    work = OpenTile(WHOLE, n, m, LOOK, 1.0, 0.1, math.inf)
    assert look_closely(POINT, work, 0.0, goal, True, space) == 0
    assert space.waiting.num[0] == 1
    found = pop_strongest(space.waiting)
    assert found[:5] == (WHOLE, *goal.orders, FIT, 1.0)
    assert found.bound == pytest.approx(AMPLITUDE, rel=0.1)


@pytest.mark.parametrize("n", [10, 12])
def test_a_survey_that_some_take_goes_on_in_blocks_that_make_it_up(n: int) -> None:
    m = 6
    space = space_of(without=(3, 40))
    work = OpenTile(WHOLE, n, m, LOOK, 1.0, 0.1, math.inf)
    assert look_closely(POINT, work, 0.0, goal_of(1e-6, 1.0), False, space) == 0
    found = [pop_strongest(space.waiting) for _ in range(int(space.waiting.num[0]))]
    # of four cells along each side, where there are as many
    assert len(found) == 3 * 2
    assert {one[1:4] for one in found} == {(MIXED, MIXED, LOOK)}
    whole = sum(fraction(one.tile, True) for one in found)
    assert whole == pytest.approx(fraction(WHOLE, True), rel=0.05)
