"""Fields at an interface and through an objective against laws, closed forms and s and p."""

import math
from decimal import Decimal, getcontext

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from octsim.optics.interface import Vector, fresnel, reflect, refract
from octsim.optics.vectorial import (
    Coefficients,
    Field,
    coefficients,
    cos_transmitted,
    enter_objective,
    leave_objective,
    reflect_field,
    transmit_field,
)

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
ULP = np.finfo(float).eps
UP = np.array([0.0, 0.0, 1.0])

indices = st.floats(1.0, 3.5)
cosines = st.floats(1e-6, 1.0)
seeds = st.integers(0, 10**6)


def at(n_i: float, n_t: float, degrees: float) -> Coefficients:
    cos_i = math.cos(math.radians(degrees))
    return coefficients(n_i, n_t, cos_i, cos_transmitted(n_i, n_t, cos_i))


def turn(seed: int) -> Array:
    """Return a rotation."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    rotation: Array = q * np.linalg.det(q)
    return rotation


def across(v: Array) -> Array:
    """Return two unit vectors at right angles to a direction and each other, (2, 3)."""
    one = np.cross(v, np.eye(3)[np.argmin(np.abs(v))])
    one /= np.linalg.norm(one)
    return np.array([one, np.cross(v, one)])


def vector(a: Array) -> Vector:
    return Vector(*a.tolist())


class Split:
    """Both rays at an interface, and the matrices that take the incident field to theirs."""

    def __init__(self, n_i: float, n_t: float, v: Array, n: Array) -> None:
        cos_i = -float(v @ n)
        self.cos_i, self.cos_t = cos_i, cos_transmitted(n_i, n_t, cos_i)
        self.by = by = coefficients(n_i, n_t, cos_i, self.cos_t)
        along, normal = vector(v), vector(n)
        self.v_r = np.array(reflect(along, normal, cos_i))
        self.v_t = np.array(refract(along, normal, n_i, n_t, cos_i, self.cos_t.real))
        # the matrices of fields at right angles to the ray; the imaginary one is turned by i
        none = vector(np.zeros(3))
        fields = [Field(vector(e), none) for e in np.eye(3) - np.outer(v, v)]
        turned = [Field(none, field.real) for field in fields]
        self.r, self.t = (
            np.array([np.array(f.real) + 1j * np.array(f.imag) for f in made]).T
            for made in (
                [reflect_field(field, along, normal, cos_i, by) for field in fields],
                [transmit_field(field, along, normal, by) for field in fields],
            )
        )
        again = [reflect_field(field, along, normal, cos_i, by) for field in turned]
        both = np.array([np.array(f.real) + 1j * np.array(f.imag) for f in again]).T
        assert both == pytest.approx(1j * self.r, abs=1e-15)


def by_s_and_p(n_i: float, n_t: float, v: Array, n: Array, s: Array) -> tuple[Complex, Complex]:
    """Return the matrices of a split by the coefficients of s and p as they are defined."""
    cos_i = -v @ n
    cos_t = np.sqrt(complex(1 - (n_i / n_t) ** 2 * (1 - cos_i**2)))
    v_r, v_t = v + 2 * cos_i * n, n_i / n_t * v + (n_i / n_t * cos_i - cos_t.real) * n
    r_s = (n_i * cos_i - n_t * cos_t) / (n_i * cos_i + n_t * cos_t)
    r_p = (n_t * cos_i - n_i * cos_t) / (n_t * cos_i + n_i * cos_t)
    t_s = 2 * n_i * cos_i / (n_i * cos_i + n_t * cos_t)
    t_p = 2 * n_i * cos_i / (n_t * cos_i + n_i * cos_t)
    p = np.cross(v, s)
    return (
        r_s * np.outer(s, s) + r_p * np.outer(np.cross(v_r, s), p),
        t_s * np.outer(s, s) + t_p * np.outer(np.cross(v_t, s), p),
    )


def incident(sin_i: float, seed: int) -> tuple[Array, Array, Array]:
    """Return a direction, a normal and what is at right angles to both, any way round."""
    rotation = turn(seed)
    v = rotation @ np.array([sin_i, 0.0, -math.sqrt((1 - sin_i) * (1 + sin_i))])
    n, s = rotation @ UP, rotation @ np.array([0.0, -1.0, 0.0])
    return v / np.linalg.norm(v), n / np.linalg.norm(n), s / np.linalg.norm(s)


@given(indices, indices, cosines)
def test_coefficients_are_fresnels(n_i: float, n_t: float, cos_i: float) -> None:
    by, cos_t = at_cosine(n_i, n_t, cos_i)
    s, p = n_i * cos_i + n_t * cos_t, n_t * cos_i + n_i * cos_t
    assert by.r_s == pytest.approx((n_i * cos_i - n_t * cos_t) / s, abs=1e-14)
    assert by.r_p == pytest.approx((n_t * cos_i - n_i * cos_t) / p, abs=1e-14)
    assert by.t_s == pytest.approx(2 * n_i * cos_i / s, rel=1e-14)
    assert by.t_p == pytest.approx(2 * n_i * cos_i / p, rel=1e-14)


def at_cosine(n_i: float, n_t: float, cos_i: float) -> tuple[Coefficients, complex]:
    cos_t = cos_transmitted(n_i, n_t, cos_i)
    return coefficients(n_i, n_t, cos_i, cos_t), cos_t


@given(indices, indices, cosines)
def test_each_polarisation_keeps_its_energy(n_i: float, n_t: float, cos_i: float) -> None:
    by, cos_t = at_cosine(n_i, n_t, cos_i)
    flux = n_t * cos_t.real / (n_i * cos_i)
    for r, t in ((by.r_s, by.t_s), (by.r_p, by.t_p)):
        reflected = r.real * r.real + r.imag * r.imag
        transmitted = flux * (t.real * t.real + t.imag * t.imag)
        assert abs(reflected + transmitted - 1) <= 5 * ULP


@given(indices, indices, cosines)
def test_the_mean_of_both_polarisations_is_the_split_of_the_thesis(
    n_i: float, n_t: float, cos_i: float
) -> None:
    by, cos_t = at_cosine(n_i, n_t, cos_i)
    assume(cos_t.imag == 0)
    r, t = fresnel(n_i, n_t, cos_i, cos_t.real)
    assert r * r == pytest.approx((abs(by.r_s) ** 2 + abs(by.r_p) ** 2) / 2, rel=1e-14, abs=1e-300)
    assert t * t == pytest.approx((abs(by.t_s) ** 2 + abs(by.t_p) ** 2) / 2, rel=1e-14)


@pytest.mark.parametrize(("n_i", "n_t"), [(1.0, 1.5), (1.5, 1.0), (1.33, 1.39)])
def test_nothing_of_p_returns_at_brewsters_angle(n_i: float, n_t: float) -> None:
    by = at(n_i, n_t, math.degrees(math.atan(n_t / n_i)))
    assert abs(by.r_p) < 2e-16
    squared = (n_i * n_i - n_t * n_t) / (n_i * n_i + n_t * n_t)
    assert by.r_s == pytest.approx(squared, rel=1e-14)


def test_p_turns_its_sign_at_brewsters_angle_and_is_minus_s_at_normal_incidence() -> None:
    normal = at(1.52, 1.33, 0)
    assert normal.r_s == pytest.approx((1.52 - 1.33) / (1.52 + 1.33), rel=1e-15)
    assert normal.r_p == -normal.r_s
    brewster = math.degrees(math.atan(1.33 / 1.52))
    assert at(1.52, 1.33, brewster - 1).r_p.real < 0 < at(1.52, 1.33, brewster + 1).r_p.real


def test_a_fresnel_rhomb_makes_a_quarter_wave_of_two_reflections() -> None:
    by = at(1.51, 1.0, 54.6)
    retardance = math.degrees(np.angle(by.r_p / by.r_s))
    assert abs(retardance) == pytest.approx(45, abs=0.03)


@given(st.floats(1.01, 3.5), st.floats(1e-6, 1 - 1e-6))
def test_total_reflection_has_the_phases_of_the_closed_form(n: float, fraction: float) -> None:
    critical = math.asin(1 / n)
    angle = critical + fraction * (math.pi / 2 - critical)
    by, cos_t = at_cosine(n, 1.0, math.cos(angle))
    assume(cos_t.imag > 1e-3)
    root = math.sqrt((n * math.sin(angle) - 1) * (n * math.sin(angle) + 1)) / n
    # e^{-iωt}: the closed forms of e^{+iωt}, conjugate
    assert np.angle(by.r_s) == pytest.approx(-2 * math.atan(root / math.cos(angle)), abs=1e-9)
    assert np.angle(by.r_p) == pytest.approx(
        -2 * math.atan(root * n**2 / math.cos(angle)), abs=1e-9
    )


@given(indices, st.floats(-1e-6, 1e-6), st.floats(0.1, 1.0))
def test_nearly_equal_indices_cost_no_digits(n_i: float, step: float, cos_i: float) -> None:
    n_t = n_i * (1 + step)
    assume(n_t != n_i)
    by, _ = at_cosine(n_i, n_t, cos_i)
    getcontext().prec = 60
    i, t, c = Decimal(n_i), Decimal(n_t), Decimal(cos_i)
    cos_t = (1 - (i / t) ** 2 * (1 - c * c)).sqrt()
    r_s, r_p = (i * c - t * cos_t) / (i * c + t * cos_t), (t * c - i * cos_t) / (t * c + i * cos_t)
    assert by.r_s.real == pytest.approx(float(r_s), rel=1e-14)
    # near 45 degrees p goes through zero: there by what it is of s
    assert by.r_p.real == pytest.approx(float(r_p), rel=1e-14, abs=1e-15 * abs(float(r_s)))


@given(indices, st.floats(1e-3, 1.0))
def test_equal_indices_leave_a_field_alone(n: float, cos_i: float) -> None:
    by, cos_t = at_cosine(n, n, cos_i)
    assert cos_t == pytest.approx(cos_i, rel=ULP)
    assert (by.r_s, by.r_p, by.tilt) == (0, 0, 0)
    assert [by.t_s, by.t_p] == pytest.approx([1, 1], abs=2 * ULP)


@given(indices, indices, st.floats(0.01, 0.99), seeds)
def test_fields_are_split_as_s_and_p_are(n_i: float, n_t: float, sin_i: float, seed: int) -> None:
    v, n, s = incident(sin_i, seed)
    split = Split(n_i, n_t, v, n)
    assume(abs(split.cos_t) > 1e-3)
    r, t = by_s_and_p(n_i, n_t, v, n, s)
    assert split.r == pytest.approx(r, abs=2e-13)
    if split.cos_t.imag == 0:
        assert split.t == pytest.approx(t, abs=2e-12)


@given(indices, indices, seeds, st.floats(0, 2 * math.pi))
def test_at_normal_incidence_s_may_be_any_direction(
    n_i: float, n_t: float, seed: int, angle: float
) -> None:
    v, n, _ = incident(0.0, seed)
    split = Split(n_i, n_t, v, n)
    s = np.array([math.cos(angle), math.sin(angle)]) @ across(v)
    r, t = by_s_and_p(n_i, n_t, v, n, s)
    assert split.r == pytest.approx(r, abs=4e-15)
    assert split.t == pytest.approx(t, abs=1e-14)


@pytest.mark.parametrize("sin_i", [0.0, 1e-18, 1e-16, 1e-15, 1e-12, 1e-9, 1e-8])
def test_fields_are_continuous_to_rounding_near_normal_incidence(sin_i: float) -> None:
    for seed in range(20):
        v, n, s = incident(sin_i, seed)
        split = Split(1.52, 1.33, v, n)
        r, t = by_s_and_p(1.52, 1.33, v, n, s)
        assert np.abs(split.r - r).max() <= 1e-15
        assert np.abs(split.t - t).max() <= 1e-15
        assert np.abs(split.v_r @ split.r).max() <= 1e-15
        assert np.abs(split.v_t @ split.t).max() <= 1e-15


@given(indices, indices, st.floats(0.0, 0.999), seeds)
def test_fields_stay_at_right_angles_to_their_rays_and_keep_their_energy(
    n_i: float, n_t: float, sin_i: float, seed: int
) -> None:
    v, n, _ = incident(sin_i, seed)
    split = Split(n_i, n_t, v, n)
    field = np.array([0.6, 0.8j]) @ across(v)
    reflected, transmitted = split.r @ field, split.t @ field
    assert abs(split.v_r @ reflected) <= 1e-14
    total = np.vdot(reflected, reflected).real
    if split.cos_t.imag == 0:
        assert abs(split.v_t @ transmitted) <= 1e-13
        flux = n_t * split.cos_t.real / (n_i * split.cos_i)
        total += flux * np.vdot(transmitted, transmitted).real
    assert total == pytest.approx(1, abs=1e-13)


@given(indices, indices, st.floats(0.0, 0.99), seeds)
def test_light_that_returns_the_way_it_came_is_the_same_with_in_and_out_exchanged(
    n_i: float, n_t: float, sin_i: float, seed: int
) -> None:
    v, n, _ = incident(sin_i, seed)
    split = Split(n_i, n_t, v, n)
    back = Split(n_i, n_t, -split.v_r, n)
    ins, outs = across(v), across(split.v_r)
    assert outs @ split.r @ ins.T == pytest.approx((ins @ back.r @ outs.T).T, abs=1e-13)
    assume(split.cos_t.real > 1e-2)
    through, ins_t = Split(n_t, n_i, -split.v_t, -n), across(split.v_t)
    forth = ins_t @ split.t @ ins.T * (n_t * split.cos_t.real)
    assert forth == pytest.approx((ins @ through.t @ ins_t.T).T * (n_i * split.cos_i), abs=1e-11)


DIRECTIONS = [
    np.array([math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a)])
    for a in (0.0, 1e-9, 0.3, 1.2)
    for b in (0.0, 0.7, 2.0, -1.9)
]


@pytest.mark.parametrize("v", DIRECTIONS)
def test_an_objective_turns_the_radial_part_of_a_field_and_keeps_the_azimuthal(v: Array) -> None:
    x, y = (np.array(e) for e in enter_objective(vector(v)))
    made = np.array([x, y])
    assert made @ made.T == pytest.approx(np.eye(2), abs=4 * ULP)
    assert made @ v == pytest.approx(np.zeros(2), abs=4 * ULP)
    sine = math.hypot(v[0], v[1])
    radial = np.array([v[0], v[1]]) / sine if sine else np.array([1.0, 0.0])
    azimuthal = np.array([-radial[1], radial[0]])
    assert azimuthal @ made == pytest.approx([*azimuthal, 0], abs=4 * ULP)
    assert radial @ made == pytest.approx([*(v[2] * radial), -sine], abs=4 * ULP)


@pytest.mark.parametrize("v", DIRECTIONS)
def test_light_sent_back_on_itself_leaves_the_objective_as_it_came(v: Array) -> None:
    for field, expected in zip(enter_objective(vector(v)), np.eye(2), strict=True):
        assert leave_objective(vector(-v), field) == pytest.approx(expected, abs=4 * ULP)


@pytest.mark.parametrize("v", DIRECTIONS)
def test_an_objective_leaves_nothing_along_the_axis(v: Array) -> None:
    down = v * np.array([1, 1, -1])
    left = np.array([leave_objective(vector(down), vector(e)) for e in across(down)])
    assert left @ left.T == pytest.approx(np.eye(2), abs=4 * ULP)
