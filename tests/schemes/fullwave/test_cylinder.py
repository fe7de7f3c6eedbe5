"""The cylinder's matrices beside the boundary condition by scipy, energy, and the Debye series."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from oblique_cylinder import wait
from scipy.special import h1vp, hankel1

from octsim.schemes.fullwave.cylinder import scattering
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane

K = np.array([7.0, 9.6])
ALONG = np.array([0.0, 0.3, 0.9, 1.25])
WATER = 1.33
WAVES = 18


def whole(n_neuron: float, diameter: float = 1.2) -> NDArray[np.complex128]:
    """Return T of a cylinder, (2, 2, K, Y, M + 1)."""
    scene = CylinderOnPlane(1.52, WATER, n_neuron, 0.005, diameter)
    return scattering(scene, ALONG, K, WAVES).whole


@pytest.mark.parametrize("n_neuron", [1.2, 1.3, 1.39, 1.6, 2.2])
def test_it_is_what_the_boundary_condition_gives(n_neuron: float) -> None:
    found = whole(n_neuron)
    for i, k in enumerate(K.tolist()):
        for j, along in enumerate(ALONG.tolist()):
            for m in range(8):
                expected = wait(k, along * k, m, 0.6, WATER, n_neuron)
                np.testing.assert_allclose(found[:, :, i, j, m], expected, rtol=0, atol=1e-12)


def test_light_along_the_cylinder_is_turned_with_a_sign() -> None:
    # the other sense of φ would turn it the other way, and energy and reciprocity could not tell
    turned = whole(1.39)[0, 1, 1, 2, 1]
    assert turned == pytest.approx(complex(wait(9.6, 0.9 * 9.6, 1, 0.6, WATER, 1.39)[0, 1]))
    assert abs(turned) > 1e-4


@pytest.mark.parametrize("n_neuron", [1.2, 1.39, 2.2])
@pytest.mark.parametrize("diameter", [0.01, 1.2, 3.0])
def test_energy_is_kept(n_neuron: float, diameter: float) -> None:
    t = np.moveaxis(whole(n_neuron, diameter), (0, 1), (-2, -1))
    weight = np.diag([WATER**2, 1.0])
    adjoint = t.conj().swapaxes(-1, -2)
    lost = adjoint @ weight + weight @ t + 2 * adjoint @ weight @ t
    assert np.abs(lost).max() <= 1e-12


def test_a_cylinder_of_water_scatters_exactly_nothing() -> None:
    assert (whole(WATER) == 0).all()


def test_thin_cylinders_scatter_by_their_area() -> None:
    # Rayleigh: T₀₀ of light along the cylinder goes as the square of its diameter
    thin, thinner = (whole(1.39, d)[0, 0, 0, 0, 0] for d in (2e-3, 1e-3))
    assert thin / thinner == pytest.approx(4, rel=1e-4)
    # and is iπ/4 (ε₃ − ε₂)(ka)²
    assert thinner == pytest.approx(
        1j * np.pi / 4 * (1.39**2 - WATER**2) * (7 * 5e-4) ** 2, rel=1e-4
    )


def interfaces(k: float, along: float, m: int, n_neuron: float) -> tuple[NDArray[Any], ...]:
    """Return what the surface reflects and transmits of waves that go in and out, by scipy."""
    a = 0.6

    def admittance(index: float, kind: int) -> tuple[complex, NDArray[np.complex128]]:
        kappa = np.sqrt(index**2 - along**2)
        x = k * a * kappa
        value, slope = hankel1(m, x), h1vp(m, x)
        if kind == 2:
            value, slope = np.conj(value), np.conj(slope)
        skew, turn = 1j * along * m / (k * a * kappa**2), slope / value / kappa
        return value, np.array([[skew, turn], [-(index**2) * turn, skew]])

    h2, out_2 = admittance(WATER, 1)
    _, in_2 = admittance(WATER, 2)
    h3, out_3 = admittance(n_neuron, 1)
    _, in_3 = admittance(n_neuron, 2)
    outside = np.linalg.solve(in_3 - out_2, in_2 - in_3) * np.conj(h2) / h2
    inside = np.linalg.solve(out_2 - in_3, out_3 - out_2) * h3 / np.conj(h3)
    into = np.linalg.solve(in_3 - out_2, in_2 - out_2) * np.conj(h2) / np.conj(h3)
    out = np.linalg.solve(out_2 - in_3, out_3 - in_3) * h3 / h2
    return outside, inside, into, out


@pytest.mark.parametrize("along", ALONG.tolist())
@pytest.mark.parametrize("m", [0, 1, 4])
def test_debye_terms_are_those_of_the_series_that_sums_to_the_whole(along: float, m: int) -> None:
    scene = CylinderOnPlane(1.52, WATER, 1.39, 0.005, 1.2)
    found = scattering(scene, np.array([along]), K[:1], WAVES)
    outside, inside, into, out = interfaces(float(K[0]), along, m, 1.39)
    ratio = out @ inside @ np.linalg.inv(out)
    first = out @ into / 2
    near = (outside - np.eye(2)) / 2
    np.testing.assert_allclose(found.near_side[..., 0, 0, m], near, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.far_side[..., 0, 0, m], ratio @ first, rtol=0, atol=1e-12)
    # 2²⁰ terms, twice as many each time: light that is nearly kept inside has that many
    total = first
    for _ in range(20):
        total = total + ratio @ total
        ratio = ratio @ ratio
    np.testing.assert_allclose(found.whole[..., 0, 0, m], near + total, rtol=0, atol=1e-12)


def test_light_that_decays_in_the_cylinder_has_debye_terms_that_are_finite() -> None:
    scene = CylinderOnPlane(1.52, WATER, 1.2, 0.005, 1.2)
    found = scattering(scene, ALONG, K, WAVES)
    assert all(np.isfinite(one).all() for one in found)
