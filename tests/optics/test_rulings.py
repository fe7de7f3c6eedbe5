"""Rulings: on the beam's hyperboloid, and both families together symmetric."""

from math import pi, tan

import numpy as np
import pytest

from octsim.optics.beam import aim, vogel_spiral
from octsim.optics.rulings import diffraction_waist, rayleigh_range, rulings

K = 2 * pi / 0.755
INDEX = 1.52
WAIST = diffraction_waist(K, 1.2)
RANGE = rayleigh_range(INDEX, WAIST, K)
PLACE = vogel_spiral(2000, 386.0)
VX, VY, VZ = aim(*PLACE, 300.0)
X, Y = rulings(VX, VY, VZ, RANGE)
TANGENT = np.hypot(VX, VY) / VZ


def test_sizes_are_a_gaussian_beams() -> None:
    assert pytest.approx(0.2003, abs=5e-5) == WAIST  # µm, of 755 nm and NA 1.2
    assert pytest.approx(pi * INDEX * WAIST**2 / 0.755, rel=1e-14) == RANGE
    # far from its waist a beam widens by λ / (π n w₀): a paraxial NA of λ / (π w₀)
    assert pytest.approx(1.2, rel=1e-14) == INDEX * WAIST / RANGE


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("height", [-2.0, -0.3, 0.0, 0.1, 5.0])
def test_rays_of_an_angle_are_on_a_hyperboloid_that_follows_the_envelope(
    sign: int, height: float
) -> None:
    x, y = sign * X + height * VX / VZ, sign * Y + height * VY / VZ
    squared = x * x + y * y
    assert np.allclose(squared, (RANGE * TANGENT) ** 2 + (height * TANGENT) ** 2, rtol=1e-12)
    envelope = WAIST**2 * (1 + (height / RANGE) ** 2)
    assert np.allclose(squared, (RANGE * TANGENT / WAIST) ** 2 * envelope, rtol=1e-12)


def test_the_envelope_itself_is_ruled_by_rays_of_its_divergence() -> None:
    theta = np.arctan(WAIST / RANGE)
    x, y = rulings(np.array([np.sin(theta)]), np.zeros(1), np.array([np.cos(theta)]), RANGE)
    assert np.hypot(x, y)[0] == pytest.approx(WAIST, rel=1e-14)
    assert RANGE * tan(theta) == pytest.approx(WAIST, rel=1e-14)


def test_offsets_are_along_the_azimuth_of_the_rays_place() -> None:
    azimuth = np.arctan2(PLACE[1], PLACE[0])[1:]
    size = (RANGE * TANGENT)[1:]
    assert np.allclose(X[1:], -size * np.sin(azimuth), rtol=0, atol=1e-13)
    assert np.allclose(Y[1:], size * np.cos(azimuth), rtol=0, atol=1e-13)


def test_the_axial_ray_is_on_the_axis() -> None:
    assert (VX[0], VY[0]) == (0, 0)
    assert (X[0], Y[0]) == (0, 0)


def test_both_families_are_each_others_mirror_images() -> None:
    # the ray mirrored in x = 0 crosses at the other family's mirrored place, and not at its own
    mirrored_x, mirrored_y = rulings(-VX, VY, VZ, RANGE)
    assert np.array_equal(mirrored_x, X)
    assert np.array_equal(mirrored_y, -Y)
    assert np.abs(X[1:]).max() > 0.1  # so that one family is not symmetric by itself

    # angular momentum about the axis: of one family all of a sign, of both none
    turning = X * VY - Y * VX
    assert np.all(turning[1:] > 0)
    assert np.all(turning + ((-X) * VY - (-Y) * VX) == 0)
