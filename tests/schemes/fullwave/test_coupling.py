"""What the plane returns of outgoing waves, beside the addition theorem and another contour."""

import numpy as np
import pytest
from dense_waves import Slide, coupling_matrices
from scipy.special import hankel1

from octsim.schemes.fullwave.coupling import contour, coupling, reflected
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.illumination import mirror_waves

K = 8.0


@pytest.mark.parametrize(
    ("waves", "height"),
    [(2, 0.1), (4, 1.5), (4, 60.0), (22, 8.0), (22, 60.0), (40, 60.0), (9, 1e4)],
)
def test_waves_from_a_perfect_mirror_are_those_of_an_image(waves: int, height: float) -> None:
    # (1/π) ∫ e^{2iκh cos β + isβ} dβ = i^s H_s(2κh)
    path = contour(60 + 2 * waves, waves, height)
    order = np.arange(2 * waves + 1)
    both = np.cos(order[:, np.newaxis] * path.angle)
    found = (both * np.exp(2j * height * np.cos(path.angle)) * path.weight).sum(axis=1) * 2 / np.pi
    expected = 1j**order * hankel1(order, 2 * height)
    np.testing.assert_allclose(found, expected, rtol=1e-10)


def test_the_contour_is_gauss_legendre_s_in_re_beta_plus_tau_on_its_right_half() -> None:
    path = contour(30, 9, 4.0)
    place, weight = np.polynomial.legendre.leggauss(30)
    length = path.angle.real - path.angle.imag
    end = length[0] / (place[0] + 1)
    assert end > 1
    np.testing.assert_allclose(length, end * (place + 1), rtol=1e-11)
    assert (path.angle.real > 0).all()
    assert (path.angle.imag < 0).all()
    # dβ along it, as the length along both axes rises
    np.testing.assert_allclose(path.weight.real - path.weight.imag, end * weight, rtol=1e-11)


@pytest.mark.parametrize("mirror", [0, 1])
@pytest.mark.parametrize("n_glass", [1.52, 1.2])
@pytest.mark.parametrize("along", [0.0, 0.4, 1.1])
def test_it_is_that_of_another_contour_and_s_and_p_light(
    mirror: int, n_glass: float, along: float
) -> None:
    waves, slide = 9, Slide(n_glass, 1.33, 1.39, 0.1, 1.0)
    dense = coupling_matrices(slide, K, along, waves, 200)
    generator = np.random.default_rng(1)
    # decreasing, as those of a cylinder
    size = 4.0 ** -np.arange(waves + 1)
    e, h = (size * (generator.normal(size=waves + 1) + 1j) for _ in range(2))
    parity = (-1, 1) if mirror == 0 else (1, -1)
    for part, sign in ((e, parity[0]), (h, parity[1])):
        part[0] *= sign == 1
    every = np.stack(
        [
            np.concatenate([sign * part[:0:-1], part])
            for part, sign in zip((e, h), parity, strict=True)
        ]
    )
    expected = np.einsum("ambn,bn->am", dense, every)[:, waves:]

    scene = CylinderOnPlane(*slide)
    kappa = np.sqrt(1.33**2 - along**2)
    path = contour(60, waves, float(kappa * K * scene.height))
    by = coupling(scene, path, np.array([along]), np.array([K]))
    found = reflected(by, e[None, None], h[None, None], *mirror_waves(path.angle, waves)[mirror])
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one[0, 0], other, rtol=1e-9, atol=1e-15)


def test_equal_media_return_exactly_nothing() -> None:
    scene = CylinderOnPlane(1.33, 1.33, 1.39, 0.1, 1.0)
    by = coupling(scene, contour(20, 9, 4.0), np.array([0.0, 0.9]), np.array([K]))
    # the square root of κ² cos² β is κ cos β to the last digits alone
    assert max(float(np.abs(part).max()) for part in by) <= 1e-13
