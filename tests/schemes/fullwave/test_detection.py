"""What the detector collects: closed forms."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.special import j0, j1

from octsim.optics.pupil import GaussianPupil, UniformPupil
from octsim.schemes.fullwave import detection
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.detection import norm, plane_return

SCENE = CylinderOnPlane(1.52, 1.33, 1.39, 0.005, 1.2)
K = np.array([7.0, 8.0])


def test_the_norm_is_the_pupils_integral() -> None:
    np.testing.assert_allclose(norm(UniformPupil(), 1.2, K, 30), 1.2**2 / 2, rtol=1e-14)
    expected = 1.2**2 * (1 - np.exp(-2)) / 4
    np.testing.assert_allclose(norm(GaussianPupil(1.0), 1.2, K, 30), expected, rtol=1e-14)


def test_a_perfect_mirror_in_the_focus_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        detection, "fresnel", lambda here, *_: (np.ones_like(here), -np.ones_like(here))
    )
    found = plane_return(SCENE, GaussianPupil(1.0), 1.2, 0.0, K, 30)
    np.testing.assert_allclose(found, 1, rtol=0, atol=1e-15)


def test_a_plane_between_equal_media_returns_exactly_nothing() -> None:
    scene = SCENE._replace(n_glass=1.33)
    assert (plane_return(scene, UniformPupil(), 1.2, 0.7, K, 30) == 0).all()


def test_light_of_a_small_aperture_returns_as_at_right_angles() -> None:
    found = plane_return(SCENE, UniformPupil(), 1e-3, 0.7, K, 30)
    expected = (1.52 - 1.33) / (1.52 + 1.33) * np.exp(-2j * K * 1.52 * 0.7)
    np.testing.assert_allclose(found, expected, rtol=1e-5)


def test_of_astigmatism_the_plane_returns_what_bessel_s_functions_say() -> None:
    # light by one point of the pupil and back by the opposite one is turned by k c ρ² cos 2φ,
    # of which cos² φ and sin² φ have the means (J0 ± i J1) / 2
    aperture, bend = 1.2, 0.4

    def wavefront(px: NDArray[np.float64], py: NDArray[np.float64]) -> NDArray[np.float64]:
        return bend / 2 * (px**2 - py**2)

    found = plane_return(SCENE, UniformPupil(), aperture, 0.7, K, 40, wavefront)

    def density(squared: float, k: float, polarisation: int) -> complex:
        cosine, beyond = (np.sqrt(1 - squared * aperture**2 / n**2) for n in (1.52, 1.33))
        r_s = (1.52 * cosine - 1.33 * beyond) / (1.52 * cosine + 1.33 * beyond)
        r_p = (1.33 * cosine - 1.52 * beyond) / (1.33 * cosine + 1.52 * beyond)
        turn = k * bend * squared
        of_cosine, of_sine = (j0(turn) + 1j * j1(turn)) / 2, (j0(turn) - 1j * j1(turn)) / 2
        s_part, p_part = (of_sine, of_cosine)[:: 1 - 2 * polarisation]
        travel = np.exp(-2j * k * 0.7 * 1.52 * cosine)
        return complex(travel * (r_s * s_part - r_p * p_part))

    for polarisation in (0, 1):
        for place, k in enumerate(K.tolist()):
            expected, _ = quad(density, 0, 1, (k, polarisation), complex_func=True)
            assert found[polarisation, place] == pytest.approx(expected, abs=1e-12)
