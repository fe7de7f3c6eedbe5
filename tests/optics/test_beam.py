"""The beam: an even disk of rays, all aimed at the focus."""

import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

from octsim.optics.beam import aim, aperture_radius, vogel_beam, vogel_spiral


def test_the_rim_of_the_aperture_is_at_the_numerical_aperture() -> None:
    radius = aperture_radius(1.2, 1.52, 300.0)
    assert 1.52 * math.sin(math.atan(radius / 300)) == pytest.approx(1.2, rel=1e-14)


def test_vogel_points_fill_the_disk_evenly() -> None:
    x, y = vogel_spiral(3000, 2.0)
    distance = np.hypot(x, y)
    assert distance[0] == 0
    assert distance[-1] == pytest.approx(2.0, rel=1e-14)
    # moments of an even disk: <x²> = <y²> = R²/4, <xy> = <x> = <y> = 0
    assert np.mean(x * x) == pytest.approx(1.0, rel=2e-3)
    assert np.mean(y * y) == pytest.approx(1.0, rel=2e-3)
    assert abs(np.mean(x * y)) < 2e-3
    assert abs(np.mean(x)) < 2e-3
    assert abs(np.mean(y)) < 2e-3
    nearest = cKDTree(np.column_stack((x, y))).query(np.column_stack((x, y)), k=2)[0][:, 1]
    # points at random would leave neighbours hundreds of times closer than others
    assert nearest.max() < 2 * nearest.min()


def test_successive_vogel_points_are_a_golden_turn_apart() -> None:
    x, y = vogel_spiral(10, 1.0)
    turns = np.diff(np.unwrap(np.arctan2(y[1:], x[1:]))) / (2 * np.pi)
    assert np.allclose((turns + 1) % 1, 0.6180339887498949)


def test_a_single_ray_is_the_axial_one() -> None:
    beam = vogel_beam(1, 390.0, 300.0)
    assert (beam.vx[0], beam.vy[0], beam.vz[0], beam.amplitude[0]) == (0, 0, 1, 1)


def test_rays_head_from_the_disk_to_the_focus() -> None:
    x, y = vogel_spiral(50, 400.0)
    vx, vy, vz = aim(x, y, 300.0)
    assert np.allclose(vx**2 + vy**2 + vz**2, 1, rtol=1e-15)
    steps = 300.0 / vz
    assert np.allclose(x + steps * vx, 0, atol=1e-12)
    assert np.allclose(y + steps * vy, 0, atol=1e-12)


def test_amplitudes_are_a_mean_over_the_aperture() -> None:
    beam = vogel_beam(3000, 390.0, 300.0)
    assert beam.amplitude.sum() == pytest.approx(1, rel=1e-12)
