"""The fibre's mode: its equation, its continuity, its far field and Marcuse's Gaussian."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.special import j0, j1, k0, k0e, k1e

from octsim.optics.fibre_mode import LP01, lp01

WEAK_TO_STRONG = [0.1, 0.5, 0.8, 1.2, 1.8, 2.4, 2.405, 4.0, 10.0, 100.0]


def fibre(v: float, radius: float = 2.5) -> LP01:
    return lp01(radius, 0.13, v / (radius * 0.13))


def radial(mode: LP01) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return distances u, and weights of an integral over u du."""
    node, weight = np.polynomial.legendre.leggauss(300)
    unit, weight = (node + 1) / 2, weight / 2
    outer = mode.reach(1e-11) - 1
    u = np.concatenate((unit, 1 + outer * unit**2))  # denser near the core
    return u, u * np.concatenate((weight, weight * 2 * outer * unit))


@pytest.mark.parametrize("v", WEAK_TO_STRONG)
def test_the_eigenvalue_equation_holds(v: float) -> None:
    mode = fibre(v)
    assert mode.v == pytest.approx(v, rel=1e-15)
    assert math.hypot(mode.u, mode.w) == pytest.approx(v, rel=1e-14)
    assert 0 < mode.u < 2.404825557695773  # that of LP01, not of a higher mode
    core = mode.u * j1(mode.u) / j0(mode.u)
    assert core == pytest.approx(mode.w * k1e(mode.w) / k0e(mode.w), rel=1e-12)


@pytest.mark.parametrize(
    ("v", "u"),
    # solved with 30 digits by mpmath, in the form without poles
    [
        (0.5, 0.49999976480353276400240669096),
        (1.2, 1.13412593680276900010280428056),
        (2.4, 1.64531088633076282399608819808),
        (2.405, 1.64657201626743698231851922215),
        (10.0, 2.18451881277349654015982543292),
    ],
)
def test_u_is_that_of_many_digits(v: float, u: float) -> None:
    assert fibre(v).u == pytest.approx(u, rel=1e-14)


@pytest.mark.parametrize("v", WEAK_TO_STRONG)
def test_value_and_slope_are_continuous_at_the_core(v: float) -> None:
    mode = fibre(v)
    at = np.array([0, 1 - 2e-6, 1 - 1e-6, 1, 1 + 1e-6, 1 + 2e-6])
    centre, *_ = field = mode.amplitude(at)
    assert centre == 1
    before, here, after = field[2:5]
    assert (before + after) / 2 == pytest.approx(here, rel=1e-8)
    inside, outside = np.diff(field)[1], np.diff(field)[4]
    # between the two differences the slope turns by the curvature over 3e-6 of a radius alone
    assert abs(inside - outside) < 2e-5 * abs(inside) * max(1, v) + 1e-15


def test_the_cladding_has_the_unscaled_bessel_function() -> None:
    mode = fibre(2.1)
    u = np.array([[1.5, 3.0], [7.0, 0.5]])
    expected = np.where(u > 1, j0(mode.u) * k0(mode.w * u) / k0(mode.w), j0(mode.u * u))
    assert np.allclose(mode.amplitude(u), expected, rtol=1e-13, atol=0)


@pytest.mark.parametrize("v", [0.5, 1.0, 2.4, 10.0])
def test_the_far_field_is_that_in_closed_form(v: float) -> None:
    mode = fibre(v)
    u, weight = radial(mode)
    scale = mode.w / v  # of the far field's width, where guiding is weak
    q = np.array([0, 0.3, 1.1]) * scale
    numeric = (mode.amplitude(u) * weight * j0(np.outer(q, u))).sum(axis=1)
    # Lommel's integrals of both parts, joined by the eigenvalue equation
    core = mode.u * j1(mode.u) * j0(q) - q * j0(mode.u) * j1(q)
    closed = v**2 * core / ((mode.u**2 - q**2) * (mode.w**2 + q**2))
    assert np.allclose(numeric, closed, rtol=1e-7, atol=0)


def best_radius(mode: LP01) -> float:
    """Return the radius of the Gaussian that overlaps most with the mode, over the core's."""
    u, weight = radial(mode)
    field = mode.amplitude(u) * weight

    def overlap(radius: float) -> float:
        return float(-np.sum(field * np.exp(-((u / radius) ** 2))) / radius)

    return float(minimize_scalar(overlap, bounds=(0.6, 10), method="bounded").x)


@pytest.mark.parametrize("v", [1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4])
def test_marcuse_gives_the_gaussian_that_overlaps_most(v: float) -> None:
    mode = fibre(v)
    assert mode.mode_field_diameter == pytest.approx(2 * 2.5 * best_radius(mode), rel=0.01)


def test_marcuse_at_the_edge_of_single_modes() -> None:
    assert fibre(2.405, 1).mode_field_diameter / 2 == pytest.approx(1.099, abs=1e-3)


@pytest.mark.parametrize("v", [0.7, 2.6])
def test_marcuse_is_refused_where_it_does_not_hold(v: float) -> None:
    with pytest.raises(ValueError, match="Marcuse"):
        _ = fibre(v).mode_field_diameter


@pytest.mark.parametrize("v", WEAK_TO_STRONG)
def test_the_field_goes_down_to_nothing_without_overflow(v: float) -> None:
    mode = fibre(v)
    with np.errstate(all="raise", under="ignore"):
        field = mode.amplitude(np.array([0, 0.5, 1, 2, 10, 100, 1000, 1e5]))
    assert np.all(np.isfinite(field))
    assert np.all(np.diff(field) <= 0)
    assert np.all(field >= 0)


@pytest.mark.parametrize("v", WEAK_TO_STRONG)
@pytest.mark.parametrize("level", [1e-6, 1e-13])
def test_reach_is_where_the_field_is_down_to_the_level(v: float, level: float) -> None:
    mode = fibre(v)
    assert mode.amplitude(np.array(mode.reach(level))) == pytest.approx(level, rel=1e-8)


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(ValueError, match="hardly guides"):
        fibre(0.05)
    with pytest.raises(ValueError, match="inside its core"):
        fibre(10.0).reach(0.5)
