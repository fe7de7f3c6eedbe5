"""The field between its nodes, beside polynomials with a phase."""

import numpy as np
import pytest
from numpy.polynomial import chebyshev

from octsim.schemes.fullwave.series import coefficients, nodes, over_band
from octsim.schemes.light import AccuracyStatus, Waves

BAND, PATH = (7.0, 9.6), 1.3


def waves(number: int) -> Waves:
    k = nodes(BAND, number) if number else np.empty(0)
    nothing = np.zeros((2, number), complex)
    return Waves(
        k, nothing, np.stack([nothing] * 3), PATH, 0.0, 0.0, 5, AccuracyStatus.REACHED
    )  # fmt: skip


def polynomials(k: np.ndarray) -> np.ndarray:
    """Return six of the fifth degree, (3, 2, K)."""
    powers = (k - 8.0) ** np.arange(6)[:, np.newaxis]
    drawn = np.random.default_rng(3)
    return (drawn.normal(size=(3, 2, 6)) + 1j * drawn.normal(size=(3, 2, 6))) @ powers


@pytest.mark.parametrize("number", [6, 9, 20])
def test_a_polynomial_is_exact_between_the_nodes_and_has_its_phase_back(number: int) -> None:
    of, k = waves(number), np.linspace(*BAND, 31)
    found = over_band(of, polynomials(of.wavenumber), k)
    np.testing.assert_allclose(found, polynomials(k) * np.exp(1j * k * PATH), rtol=0, atol=1e-12)


def test_coefficients_are_those_of_numpy_s_fit() -> None:
    at = nodes((-1.0, 1.0), 12)
    values = np.exp(at) + 1j * np.sin(3 * at)
    expected = chebyshev.chebfit(at, values, 11)
    np.testing.assert_allclose(coefficients(values), expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("shape", [(0,), (2, 0), (3, 2, 0)])
def test_without_nodes_no_field_is_known(shape: tuple[int, ...]) -> None:
    found = over_band(waves(0), np.empty(shape, complex), np.linspace(*BAND, 7))
    assert found.shape == (*shape[:-1], 7)
    assert np.isnan(found.real).all()
    assert np.isnan(found.imag).all()
