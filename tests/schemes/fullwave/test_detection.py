"""What the detector collects: closed forms."""

import numpy as np
import pytest

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
