"""Roots in Bernstein's form, beside those that polynomials are made of."""

import numpy as np
import pytest
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from octsim.base.compiled import compiled
from octsim.base.records import room
from octsim.schemes.paths.chebyshev import HIGHEST
from octsim.schemes.paths.polynomial_roots import (
    BERNSTEIN_TABLES,
    HALVES,
    MOST_COEFFICIENTS,
    append_roots,
    fill_bernstein,
    to_bernstein,
    unscale,
)

Array = NDArray[np.float64]


@compiled()
def _roots(coefficients: Array, table: Array, binomials: Array, halves: Array) -> Array:
    n = coefficients.size
    scaled, roots = np.empty(MOST_COEFFICIENTS), np.empty(4 * MOST_COEFFICIENTS)
    to_bernstein(coefficients, n, table, scaled)
    unscale(scaled, n, binomials)
    return roots[: append_roots(scaled, n, binomials, halves, roots, 0)]


def roots_of(given: ArrayLike) -> Array:
    """Return where a polynomial of Chebyshev coefficients changes its sign on 0 … 1."""
    coefficients = np.ascontiguousarray(given, float)
    tables = room(BERNSTEIN_TABLES)
    fill_bernstein(tables)
    table = np.ascontiguousarray(tables.from_chebyshev[coefficients.size])
    return _roots(coefficients, table, np.array(tables.binomials), np.empty(HALVES))


@pytest.mark.parametrize("degree", [1, 2, 5, 9, 14])
def test_roots_are_those_a_polynomial_is_made_of(degree: int) -> None:
    generator = np.random.default_rng(degree)
    for _ in range(50):
        roots = np.sort(generator.random(degree))
        roots += np.linspace(0, 0.05 * degree, degree)  # apart from each other
        roots /= 1 + 0.05 * degree
        found = roots_of(chebyshev.chebfromroots(2 * roots - 1))
        np.testing.assert_allclose(found, roots, atol=2e-4 if degree > 9 else 1e-6)


def test_two_roots_close_to_each_other_are_both_found() -> None:
    for apart in (1e-2, 1e-4, 1e-6):
        roots = np.array([0.43, 0.43 + apart])
        found = roots_of(chebyshev.chebfromroots(2 * roots - 1))
        np.testing.assert_allclose(found, roots, atol=0.01 * apart)


def test_a_polynomial_that_only_touches_zero_changes_no_sign() -> None:
    # rounding may part the two roots, by its root
    found = roots_of(chebyshev.chebfromroots(2 * np.array([0.3, 0.3]) - 1))
    assert found.size in {0, 2}
    assert np.allclose(found, 0.3, atol=1e-6)


def test_no_sample_sees_a_change_of_sign_that_is_not_found() -> None:
    generator = np.random.default_rng(3)
    places = np.linspace(0, 1, 2001)
    for _ in range(300):
        n = int(generator.integers(2, HIGHEST + 1))
        coefficients = generator.normal(size=n) * generator.choice([1.0, 0.5]) ** np.arange(n)
        seen = np.sign(chebyshev.chebval(2 * places - 1, coefficients))
        found = roots_of(coefficients)
        assert np.count_nonzero(np.diff(seen)) <= found.size <= n - 1


@pytest.mark.parametrize("multiplicity", [3, 8, 13])
def test_rounding_at_a_root_of_many_makes_no_more_roots_than_there_can_be(
    multiplicity: int,
) -> None:
    generator = np.random.default_rng(multiplicity)
    for _ in range(50):
        roots = np.full(multiplicity, generator.random())
        found = roots_of(chebyshev.chebfromroots(2 * roots - 1))
        assert found.size <= multiplicity
