"""A survey's rays in order of their paths, and the part of an aperture that is looked at closer."""

import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.optics.detector import fibre_detector
from octsim.optics.materials import Constant
from octsim.optics.scene import Cylinder, Plane, Region, Scene
from octsim.optics.turned_rays import STRAIGHT
from octsim.schemes.paths.aperture_tiles import Tile
from octsim.schemes.paths.chebyshev import LOOK
from octsim.schemes.paths.check_rays import CHECKS
from octsim.schemes.paths.falloffs import Parabola
from octsim.schemes.paths.survey import by_path, closer, curved, part_of_faint
from octsim.schemes.paths.workspace import Point, Survey, room_for_point, tables_of
from octsim.tracing.faces import faces_at

GLASS, WATER = Region("glass", Constant(1.52)), Region("water", Constant(1.33))
NEURON = Region("neuron", Constant(1.39))
SCENE = Scene(GLASS, (Plane("P", 0.0, GLASS, WATER), Cylinder("C", 0.0, 0.8, 0.7, NEURON, WATER)))
FACES = faces_at(SCENE, 8.0)
DETECTOR = fibre_detector(0.5, 1.52, 300.0, 20.0, 4.4)
POINT = Point(False, DETECTOR, 0.8, 8.3, 9.7, Parabola(), STRAIGHT, tables_of(False))
OFF_PLANE, OFF_CYLINDER = 0b1_00, 0b1_01_10_01
N, M = 6, 4
WHOLE = Tile(-1.0, 1.0, 0.0, 1.0)


def survey_of(*paths: tuple[int, list[int]]) -> Survey:
    """Return a survey of N x M nodes whose paths have these codes and rays."""
    sizes = np.array([len(rays) for _, rays in paths], np.int64)
    end = np.cumsum(sizes)
    none: NDArray[np.float64] = np.zeros(int(end[-1]))
    return Survey(
        WHOLE, (N, M), np.array([code for code, _ in paths]), end - sizes, end, 0.5,
        np.array([0.3, 0.02][: len(paths)]), np.array([0.1, 0.01][: len(paths)]),
        np.array([ray for _, rays in paths for ray in rays]), none, none, none, none, none,
        np.zeros(CHECKS), np.zeros(CHECKS),
    )  # fmt: skip


def column(i: int) -> list[int]:
    return [i * M + j for j in range(M)]


def test_rays_of_a_path_stand_together_in_the_order_of_each_path_s_first() -> None:
    codes = np.array([7, 3, 7, 9, 3, 3, 7, 1])
    order, firsts = by_path(codes)
    assert order.tolist() == [0, 2, 6, 1, 4, 5, 3, 7]
    assert firsts.tolist() == [0, 3, 6, 7, 8]
    none = by_path(codes[:0])
    assert (none[0].size, none[1].tolist()) == (0, [0])


def test_a_path_off_a_cylinder_is_curved_and_one_off_planes_is_not() -> None:
    space = room_for_point()
    assert curved(FACES, OFF_CYLINDER, space)
    assert not curved(FACES, OFF_PLANE, space)


@pytest.mark.parametrize("some", [[2, 3], [0], [0, 1], [4, 5]])
def test_what_is_looked_at_closer_is_where_light_meets_more_than_planes_and_a_column_more(
    some: list[int],
) -> None:
    every = [ray for i in range(N) for ray in column(i)]
    rays = [ray for i in some for ray in column(i)]
    survey = survey_of((OFF_PLANE, every), (OFF_CYLINDER, rays))
    edge, tile = closer(FACES, POINT, survey, room_for_point())
    nodes = -1 + 2 * np.asarray(POINT.tables.nodes_s[LOOK, N, :N])
    left, right = some[0] - 1, some[-1] + 1
    assert edge
    assert tile.s_min == (-1.0 if left <= 0 else pytest.approx(nodes[left]))
    assert tile.s_max == (1.0 if right >= N - 1 else pytest.approx(nodes[right]))
    assert tile[2:] == (0.0, 1.0)


def test_where_no_light_or_all_of_it_meets_more_than_planes_nothing_is_looked_at_closer() -> None:
    every = [ray for i in range(N) for ray in column(i)]
    space = room_for_point()
    assert closer(FACES, POINT, survey_of((OFF_PLANE, every)), space) == (False, WHOLE)
    assert closer(FACES, POINT, survey_of((OFF_CYLINDER, every)), space) == (False, WHOLE)
    # at the top of the aperture all columns are one place; check rays stand behind all columns
    top_and_checks = [*column(2), M - 1, N * M - 1, N * M + 3]
    edge, tile = closer(FACES, POINT, survey_of((OFF_CYLINDER, top_and_checks)), space)
    assert edge
    assert -1 < tile.s_min < tile.s_max < 1


def test_a_faint_path_contributes_no_larger_part_than_others_as_faint() -> None:
    survey = survey_of((OFF_PLANE, [0]), (OFF_CYLINDER, [1]))
    assert part_of_faint(survey, 0.005) == 1
    assert part_of_faint(survey, 0.05) == pytest.approx(2)
    assert part_of_faint(survey, 0.5) == pytest.approx(3)
