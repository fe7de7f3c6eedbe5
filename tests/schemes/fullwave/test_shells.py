"""Shells of a cylinder beside treams, one system of all boundary conditions, and no shell."""

from typing import Any

import numpy as np
import pytest
from coated_by_treams import COATED
from dense_scenes import Layered, coated_matrices
from numpy.typing import NDArray

from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane, Layer
from octsim.schemes.fullwave.shells import scattering_of

K = np.array([7.0, 9.6])
ALONG = np.array([0.0, 0.3, 0.9, 1.25])
WAVES = 20
PLAIN = CylinderOnPlane(1.52, 1.33, 1.39, 0.005, 1.2)


def with_shells(*shells: tuple[complex, float], **other: Any) -> CylinderOnPlane:
    return PLAIN._replace(shells=tuple(Layer(*one) for one in shells), **other)


def whole(scene: CylinderOnPlane, waves: int = WAVES) -> NDArray[np.complex128]:
    """Return T, (2, 2, K, Y, M + 1)."""
    return scattering_of(scene, ALONG, K, waves).whole


@pytest.mark.parametrize("name", COATED)
def test_it_is_what_treams_finds(name: str) -> None:
    k, along, radii, indices, orders = COATED[name]
    core = complex(indices[0])
    layers = zip(indices[-2:0:-1], np.diff(radii)[::-1].tolist(), strict=True)
    scene = with_shells(*layers, diameter=2 * radii[-1], n_neuron=core.real, kappa=core.imag)
    found = scattering_of(scene, np.array([along]), np.array([k]), WAVES).whole[..., 0, 0, :]
    for m, expected in orders.items():
        np.testing.assert_allclose(found[..., m], expected, rtol=1e-10, atol=1e-14)


@pytest.mark.parametrize(
    "shells",
    [
        ((1.44, 0.1),),
        ((1.46, 0.005),),
        ((1.5, 0.2), (1.34, 0.1), (1.42, 0.05)),
        ((1.2, 0.1), (1.44 + 0.2j, 0.1)),
        ((1.44, 0.595),),
    ],
)
def test_it_is_what_all_boundary_conditions_give(shells: Any) -> None:
    scene = with_shells(*shells, kappa=0.01)
    found = whole(scene)
    for i, k in enumerate(K.tolist()):
        for j, along in enumerate(ALONG.tolist()):
            layered = Layered(1.52, 1.33, 1.39 + 0.01j, 0.005, 1.2, shells=shells)
            expected = np.moveaxis(coated_matrices(layered, k, along, 8)[8:], 0, -1)
            np.testing.assert_allclose(found[:, :, i, j, :9], expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("thickness", [(0.005,), (0.1, 0.2), (0.59,), (0.599999,)])
def test_shells_of_the_cylinders_own_index_are_none(thickness: tuple[float, ...]) -> None:
    scene = with_shells(*((1.39, one) for one in thickness))
    np.testing.assert_allclose(whole(scene), whole(PLAIN), rtol=0, atol=1e-14)


def test_shells_of_the_cylinders_own_index_leave_its_debye_terms() -> None:
    terms = scattering_of(with_shells((1.39, 0.1), (1.39, 0.05)), ALONG, K, WAVES)
    for one, other in zip(terms, scattering_of(PLAIN, ALONG, K, WAVES), strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-14)


def test_a_shell_of_water_is_a_smaller_cylinder() -> None:
    smaller = whole(PLAIN._replace(diameter=1.0))
    np.testing.assert_allclose(whole(with_shells((1.33, 0.1))), smaller, rtol=0, atol=1e-14)


@pytest.mark.parametrize("diameter", [0.02, 1.2, 20.0])
@pytest.mark.parametrize("share", [(0.1,), (0.3, 0.69), (0.999999,)])
@pytest.mark.filterwarnings("error")
def test_energy_is_kept_and_nothing_overflows(diameter: float, share: tuple[float, ...]) -> None:
    layers = ((1.45 + 0.05 * i, one * diameter / 2) for i, one in enumerate(share))
    scene = with_shells(*layers, diameter=diameter)
    found = scattering_of(scene, ALONG, K, 6 if diameter < 1 else 20 if diameter < 10 else 180)
    assert all(np.isfinite(one).all() for one in found)
    t = np.moveaxis(found.whole, (0, 1), (-2, -1))
    weight = np.diag([1.33**2, 1.0])
    adjoint = t.conj().swapaxes(-1, -2)
    assert np.abs(adjoint @ weight + weight @ t + 2 * adjoint @ weight @ t).max() <= 1e-12
    # and reciprocity: what E makes of H is what H makes of E
    np.testing.assert_allclose(t[..., 0, 1] * 1.33**2, -t[..., 1, 0], rtol=0, atol=1e-13)


def test_a_shell_that_absorbs_takes_light() -> None:
    t = np.moveaxis(whole(with_shells((1.44 + 0.01j, 0.1))), (0, 1), (-2, -1))
    weight = np.diag([1.33**2, 1.0])
    adjoint = t.conj().swapaxes(-1, -2)
    left = np.linalg.eigvalsh(adjoint @ weight + weight @ t + 2 * adjoint @ weight @ t)
    assert left.max() <= 1e-15
    assert left.min() < -1e-3
