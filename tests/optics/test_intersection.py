"""Distances to planes and cylinders: points that lie on the surface, and rays that miss."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from octsim.optics.interface import Vector
from octsim.optics.intersection import (
    cross_cylinder,
    cylinder_normal,
    enter_cylinder,
    meet_plane,
    plane_normal,
)

coordinates = st.floats(-5, 5)


def unit(x: float, y: float, z: float) -> Vector:
    length = math.sqrt(x * x + y * y + z * z)
    assume(length > 0.1)
    return Vector(x / length, y / length, z / length)


def along(position: Vector, direction: Vector, distance: float) -> Vector:
    return Vector(*(p + distance * d for p, d in zip(position, direction, strict=True)))


@given(coordinates, coordinates, coordinates, coordinates, coordinates)
def test_a_ray_ends_on_the_plane_it_heads_for(
    height: float, z: float, vx: float, vy: float, vz: float
) -> None:
    position, direction = Vector(0.0, 0.0, z), unit(vx, vy, vz)
    assume(abs(direction.z) > 1e-3)
    above = z > height
    distance = meet_plane(height, above, position, direction)
    if (direction.z < 0) == above:
        assert along(position, direction, distance).z == pytest.approx(height, abs=1e-9)
    else:
        assert distance == math.inf


def test_a_ray_along_a_plane_never_meets_it() -> None:
    for above in (True, False):
        assert meet_plane(0.0, above, Vector(0.0, 0.0, 1.0), Vector(1.0, 0.0, 0.0)) == math.inf


@given(
    turn=st.floats(0, 2 * math.pi),
    away=st.floats(1.5, 10),
    offset=st.floats(-1.49, 1.49),
    tilt=st.floats(-3, 3),
)
def test_a_ray_enters_the_cylinder_on_its_near_side_and_leaves_on_its_far_side(
    turn: float, away: float, offset: float, tilt: float
) -> None:
    # a ray that starts `away` from the axis, in any direction, and passes it at `offset`
    radius, x0, z0 = 1.5, 0.3, -0.2
    c, s = math.cos(turn), math.sin(turn)
    position = Vector(x0 - away * c - offset * s, 0.7, z0 - away * s + offset * c)
    direction = unit(c, tilt, s)
    across = math.hypot(direction.x, direction.z)
    half_chord = math.sqrt(radius**2 - offset**2)
    distance, cos_i = enter_cylinder(x0, z0, radius, position, direction)
    assert distance == pytest.approx((away - half_chord) / across, abs=1e-11)
    near = along(position, direction, distance)
    normal = ((near.x - x0) / radius, (near.z - z0) / radius)
    assert math.hypot(*normal) == pytest.approx(1, abs=1e-12)
    assert cos_i == pytest.approx(-(normal[0] * direction.x + normal[1] * direction.z), abs=1e-11)
    chord, cos_far = cross_cylinder(x0, z0, radius, near, direction)
    assert chord == pytest.approx(2 * half_chord / across, abs=1e-11)
    assert cos_far == pytest.approx(cos_i, abs=1e-11)


@given(coordinates, coordinates)
def test_a_ray_misses_exactly_when_it_passes_beside(x: float, vx: float) -> None:
    position, direction = Vector(x, 0.0, -3.0), unit(vx, 0.4, 1.0)
    # the ray's distance from the axis (0, 0), in the cross section
    offset = abs(x * direction.z + 3.0 * direction.x) / math.hypot(direction.x, direction.z)
    assume(abs(offset - 1) > 1e-12)
    distance, _ = enter_cylinder(0.0, 0.0, 1.0, position, direction)
    assert (distance == math.inf) == (offset > 1)


def test_a_tangent_ray_and_a_cylinder_behind_are_missed() -> None:
    up = Vector(0.0, 0.0, 1.0)
    assert enter_cylinder(0.0, 0.0, 1.0, Vector(1.0, 0.0, -3.0), up)[0] == math.inf
    assert enter_cylinder(0.0, 0.0, 1.0, Vector(0.0, 0.0, 3.0), up)[0] == math.inf
    assert cross_cylinder(0.0, 0.0, 1.0, Vector(0.0, 0.0, 1.0), up)[0] == math.inf


def test_a_ray_on_the_axis_crosses_the_whole_diameter() -> None:
    up = Vector(0.0, 0.0, 1.0)
    assert enter_cylinder(0.0, 0.7, 0.7, Vector(0.0, 0.0, 0.0), up) == (0.0, 1.0)
    assert cross_cylinder(0.0, 0.7, 0.7, Vector(0.0, 0.0, 0.0), up) == (1.4, 1.0)


def test_normals_point_to_the_side_that_the_ray_is_on() -> None:
    assert plane_normal(above=True) == (0.0, 0.0, 1.0)
    assert plane_normal(above=False) == (0.0, 0.0, -1.0)
    right = Vector(2.5, 7.0, -0.2)
    assert cylinder_normal(1.0, -0.2, 1 / 1.5, right) == pytest.approx((1.0, 0.0, 0.0))
    assert cylinder_normal(1.0, -0.2, -1 / 1.5, right) == pytest.approx((-1.0, 0.0, 0.0))
