"""Bessel functions by recurrence beside scipy's."""

import numpy as np
import pytest
from scipy.special import h1vp, hankel1, jv, jvp

from octsim.schemes.fullwave.bessel import bessel_j, hankel, second_hankel

ARGUMENTS = np.array([1e-3, 0.04, 0.7, 3.1, 12.5, 61.0, 130.0])


@pytest.mark.parametrize("order", [1, 7, 40])
def test_bessel_functions_and_slopes_are_scipys(order: int) -> None:
    m, x = np.arange(order + 1), ARGUMENTS[:, np.newaxis]
    found = bessel_j(ARGUMENTS, order)
    size = np.abs(hankel1(m, x))
    # beside the Hankel function's size, as near a zero no digit of J itself is certain
    tolerance = 1e-12 * np.maximum(np.minimum(size, 1), np.abs(jv(m, x)) / 1e-2)
    assert (np.abs(found.value - jv(m, x)) <= tolerance).all()
    assert (np.abs(found.slope - jvp(m, x)) <= 1e-12 * (1 + m / x) * np.abs(jv(m, x)) + 1e-12).all()


@pytest.mark.parametrize("order", [1, 7, 40])
def test_hankel_functions_and_slopes_are_scipys(order: int) -> None:
    m, x = np.arange(order + 1), ARGUMENTS[:, np.newaxis]
    found = hankel(ARGUMENTS, order)
    np.testing.assert_allclose(found.value, hankel1(m, x), rtol=1e-12)
    np.testing.assert_allclose(found.slope, h1vp(m, x), rtol=1e-12)


def test_a_small_argument_keeps_the_digits_of_high_orders() -> None:
    found = bessel_j(np.array([1e-3]), 12).value[0]
    np.testing.assert_allclose(found, jv(np.arange(13), 1e-3), rtol=1e-12)


def test_the_second_kind_is_the_other_ones_conjugate() -> None:
    first = hankel(ARGUMENTS, 5)
    np.testing.assert_array_equal(second_hankel(first).value, first.value.conj())
    np.testing.assert_array_equal(second_hankel(first).slope, first.slope.conj())
