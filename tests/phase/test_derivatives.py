"""Derivatives that bring their error, against closed forms."""

import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.phase.derivatives import derivative, phase_derivative, stencil

Array = NDArray[np.float64]


@pytest.mark.parametrize(("at", "least"), [(1.0, -np.inf), (0.0, 0.0), (0.02, 0.0)])
def test_a_derivative_is_exact_for_polynomials_also_at_a_bound(at: float, least: float) -> None:
    offsets = stencil(at, 0.1, least)
    assert (at + offsets >= least - 1e-15).all()
    quartic = np.polynomial.Polynomial([1.0, -2.0, 3.0, -4.0, 5.0])
    found = derivative(offsets, quartic(at + offsets))
    assert found.value == pytest.approx(quartic.deriv()(at), rel=1e-11)
    parabola = np.polynomial.Polynomial([1.0, -2.0, 3.0])
    assert derivative(offsets, parabola(at + offsets)).error < 1e-11


def test_a_derivative_is_richardsons_and_its_error_is_on_the_safe_side() -> None:
    offsets = stencil(0.0, 0.2)
    columns = np.stack((np.sin(1 + offsets), np.exp(offsets)), axis=1)
    found = derivative(offsets, columns)

    def central(step: int) -> Array:
        ends: Array = (columns[2 + step] - columns[2 - step]) / (offsets[2 + step] * 2)
        return ends

    assert found.value == pytest.approx((4 * central(1) - central(2)) / 3, rel=1e-12)
    off = np.abs(found.value - [np.cos(1.0), 1.0])
    assert (off < found.error).all()
    assert (off > 1e-8).all()


def test_a_derivative_at_a_point_has_its_closed_form_and_its_error() -> None:
    place = np.linspace(1, 2, 11)

    def phasor(offset: float) -> NDArray[np.complex128]:
        return np.asarray(3 * np.exp(1j * (23 * (place + offset) + np.sin(5 * (place + offset)))))

    exact = 23 + 5 * np.cos(5 * place)
    found = phase_derivative(phasor, 0.02)
    off = np.abs(found.value - exact)
    central = np.angle(phasor(0.02) * phasor(-0.02).conj()) / 0.04
    assert off.max() < 1e-3 * np.abs(central - exact).max()
    assert (off <= found.error).all()
    assert phase_derivative(phasor, 1e-3).value == pytest.approx(exact, abs=1e-9)
