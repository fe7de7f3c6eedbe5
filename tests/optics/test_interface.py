"""Reflection, refraction and Fresnel coefficients against laws and published values."""

import math

import pytest
from hypothesis import assume, given, reject
from hypothesis import strategies as st

from octsim.optics.interface import Vector, cos_transmitted_squared, fresnel, reflect, refract

indices = st.floats(1.0, 3.5)
cosines = st.floats(1e-6, 1.0)
angles = st.floats(0.0, 2 * math.pi)


def cos_transmitted(n_i: float, n_t: float, cos_i: float) -> float:
    squared = cos_transmitted_squared(n_i, n_t, cos_i)
    if squared <= 0:
        reject()
    return math.sqrt(squared)


def incident(cos_i: float, azimuth: float, tilt: float) -> tuple[Vector, Vector]:
    """Make a direction and a normal at an angle of incidence, turned by two angles."""
    sin_i = math.sqrt(1 - cos_i**2)
    flat = (sin_i * math.cos(azimuth), sin_i * math.sin(azimuth), -cos_i)

    def turn(v: tuple[float, float, float]) -> Vector:
        c, s = math.cos(tilt), math.sin(tilt)
        return Vector(v[0], c * v[1] - s * v[2], s * v[1] + c * v[2])

    return turn(flat), turn((0.0, 0.0, 1.0))


def dot(a: Vector, b: Vector) -> float:
    return a.x * b.x + a.y * b.y + a.z * b.z


def cross(a: Vector, b: Vector) -> Vector:
    return Vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@given(indices, indices, cosines)
def test_reflected_and_transmitted_power_add_up_to_one(
    n_i: float, n_t: float, cos_i: float
) -> None:
    cos_t = cos_transmitted(n_i, n_t, cos_i)
    r, t = fresnel(n_i, n_t, cos_i, cos_t)
    assert r**2 + n_t * cos_t / (n_i * cos_i) * t**2 == pytest.approx(1, abs=1e-12)


@given(indices, indices, cosines)
def test_external_reflection_alone_turns_the_sign(n_i: float, n_t: float, cos_i: float) -> None:
    r, t = fresnel(n_i, n_t, cos_i, cos_transmitted(n_i, n_t, cos_i))
    assert (r < 0) == (n_t > n_i and r != 0)
    assert t > 0


@pytest.mark.parametrize(
    ("n_i", "n_t", "degrees", "power_parallel", "power_perpendicular"),
    [
        (1.0, 1.5, 0, 0.04, 0.04),  # the 4 % of a glass surface
        (1.0, 1.5, 45, 0.0085, 0.0920),  # Hecht, Optics, §4.6
        (1.0, 1.5, math.degrees(math.atan(1.5)), 0.0, 0.1479),  # Brewster: (1.25/3.25)²
        (1.5, 1.0, math.degrees(math.atan(1 / 1.5)), 0.0, 0.1479),  # and from inside
    ],
)
def test_published_reflectances_are_met(
    n_i: float, n_t: float, degrees: float, power_parallel: float, power_perpendicular: float
) -> None:
    cos_i = math.cos(math.radians(degrees))
    r, _ = fresnel(n_i, n_t, cos_i, cos_transmitted(n_i, n_t, cos_i))
    assert r**2 == pytest.approx((power_parallel + power_perpendicular) / 2, abs=1e-4)


def test_normal_incidence_follows_the_closed_form() -> None:
    r, t = fresnel(1.52, 1.33, 1.0, 1.0)
    assert r == pytest.approx((1.52 - 1.33) / (1.52 + 1.33), rel=1e-15)
    assert t == pytest.approx(2 * 1.52 / (1.52 + 1.33), rel=1e-15)


def test_equal_indices_neither_reflect_nor_bend() -> None:
    direction, normal = incident(0.3, 1.0, 0.4)
    assert cos_transmitted_squared(1.4, 1.4, 0.3) == 0.3 * 0.3
    r, t = fresnel(1.4, 1.4, 0.3, 0.3)
    assert r == 0
    assert t == pytest.approx(1, rel=1e-15)
    assert refract(direction, normal, 1.4, 1.4, 0.3, 0.3) == pytest.approx(direction, rel=1e-15)


def test_total_reflection_begins_at_the_critical_angle() -> None:
    critical = math.asin(1.33 / 1.52)
    assert cos_transmitted_squared(1.52, 1.33, math.cos(critical - 1e-9)) > 0
    assert cos_transmitted_squared(1.52, 1.33, math.cos(critical + 1e-9)) < 0


@given(indices, indices, cosines, angles, angles)
def test_refraction_conserves_what_snell_says(
    n_i: float, n_t: float, cos_i: float, azimuth: float, tilt: float
) -> None:
    direction, normal = incident(cos_i, azimuth, tilt)
    cos_t = cos_transmitted(n_i, n_t, cos_i)
    bent = refract(direction, normal, n_i, n_t, cos_i, cos_t)
    assert dot(bent, bent) == pytest.approx(1, abs=1e-12)
    assert dot(bent, normal) == pytest.approx(-cos_t, abs=1e-12)
    # n v × n̂ is the same on both sides: Snell's law, and that all three lie in a plane
    before, after = cross(direction, normal), cross(bent, normal)
    for b, a in zip(before, after, strict=True):
        assert n_t * a == pytest.approx(n_i * b, abs=1e-11)


@given(cosines, angles, angles)
def test_reflection_turns_the_normal_component_alone(
    cos_i: float, azimuth: float, tilt: float
) -> None:
    direction, normal = incident(cos_i, azimuth, tilt)
    turned = reflect(direction, normal, cos_i)
    assert dot(turned, turned) == pytest.approx(1, abs=1e-12)
    assert dot(turned, normal) == pytest.approx(cos_i, abs=1e-12)
    assert cross(turned, normal) == pytest.approx(cross(direction, normal), abs=1e-12)


@given(indices, indices, cosines, angles)
def test_light_returns_the_way_it_came(
    n_i: float, n_t: float, cos_i: float, azimuth: float
) -> None:
    direction, normal = incident(cos_i, azimuth, 0.0)
    cos_t = cos_transmitted(n_i, n_t, cos_i)
    assume(cos_t > 1e-3)
    onwards = refract(direction, normal, n_i, n_t, cos_i, cos_t)
    returning = Vector(-onwards.x, -onwards.y, -onwards.z)
    below = Vector(-normal.x, -normal.y, -normal.z)
    back = refract(returning, below, n_t, n_i, cos_t, cos_i)
    assert back == pytest.approx([-c for c in direction], abs=1e-9)
