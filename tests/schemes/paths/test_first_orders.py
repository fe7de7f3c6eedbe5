"""How closely an aperture is looked at to begin with."""

import math

import pytest

from octsim.optics.detector import fibre_detector
from octsim.optics.materials import Constant
from octsim.optics.scene import Cylinder, Plane, Region, Scene
from octsim.schemes.paths.check_rays import CHECKS
from octsim.schemes.paths.first_orders import (
    STEEP,
    in_shells,
    orders_of,
    sees_edges,
    steepest_sine,
)
from octsim.schemes.paths.workspace import MOST_RAYS
from octsim.tracing.faces import faces_at

GLASS, WATER = Region("glass", Constant(1.52)), Region("water", Constant(1.33))
NEURON, MEMBRANE = Region("neuron", Constant(1.39)), Region("membrane", Constant(1.46))
PLANE = Plane("P", 0.0, GLASS, WATER)
PLAIN = Scene(GLASS, (PLANE, Cylinder("C", 0.0, 0.8, 0.7, NEURON, WATER)))
SHELL = Scene(
    GLASS,
    (PLANE, Cylinder("M", 0.0, 0.8, 0.7, MEMBRANE, WATER),
     Cylinder("C", 0.0, 0.8, 0.6, NEURON, MEMBRANE)),
)  # fmt: skip
BESIDE = Scene(
    GLASS,
    (PLANE, Cylinder("C", 0.0, 0.8, 0.7, NEURON, WATER),
     Cylinder("D", 1.6, 0.8, 0.7, NEURON, WATER)),
)  # fmt: skip
LIFTED = Scene(GLASS, (PLANE, Cylinder("C", 0.0, 0.8, 0.7, NEURON, WATER, elevation=0.02)))


@pytest.mark.parametrize(
    ("accuracy", "survey", "tile"),
    [(0.3, (3, 3), (4, 3)), (1e-2, (4, 3), (4, 3)), (1e-4, (6, 4), (5, 3)),
     (1e-8, (9, 7), (9, 5)), (1e-10, (9, 7), (10, 6))],
)  # fmt: skip
def test_more_is_asked_of_more_digits_within_bounds(
    accuracy: float, survey: tuple[int, int], tile: tuple[int, int]
) -> None:
    assert orders_of(accuracy, True, 0.5, PLAIN) == (survey, tile)


def test_steep_light_shells_and_edges_are_looked_at_more_closely() -> None:
    (steep_s, steep_v), _ = orders_of(1e-2, True, STEEP + 0.01, PLAIN)
    assert (steep_s, steep_v) == (12, (MOST_RAYS - CHECKS) // 12)
    assert orders_of(1e-2, True, STEEP - 0.01, PLAIN)[0] == (4, 3)
    assert orders_of(1e-2, True, 0.5, LIFTED)[0] == (steep_s, steep_v)
    assert orders_of(1e-2, True, 0.5, SHELL)[0] == (8, 5)
    # without symmetry in x, the whole width is
    assert orders_of(1e-2, False, 0.5, PLAIN)[0] == (24, 3)


def test_shells_are_walls_about_one_axis_and_edges_those_of_neighbours() -> None:
    assert [in_shells(one) for one in (PLAIN, SHELL, BESIDE, LIFTED)] == [False, True, False, False]
    assert [sees_edges(one) for one in (PLAIN, SHELL, BESIDE, LIFTED)] == [False, False, True, True]


def test_light_is_steepest_where_the_index_is_least() -> None:
    faces, detector = faces_at(PLAIN, 8.0), fibre_detector(1.2, 1.52, 300.0, 20.0, 4.4)
    assert steepest_sine(faces, detector) == pytest.approx(1.2 / 1.33, rel=1e-12)
    assert math.isclose(steepest_sine(faces_at(Scene(GLASS, ()), 8.0), detector), 1.2 / 1.52)
