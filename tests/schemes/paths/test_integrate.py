"""Whole integrals of narrow light, beside closed forms: few rays, and some tiles."""

from itertools import pairwise

import numpy as np
import pytest
from plane_light import GLASS, fields, objective, plane, returned

from octsim.optics.materials import Constant
from octsim.optics.scene import Cylinder, Plane, Region, Scene, Symmetry
from octsim.schemes.light import AccuracyStatus
from octsim.schemes.paths.integrate import integrate, integrate_nodes

K = np.linspace(2e3 * np.pi / 900, 2e3 * np.pi / 650, 25)
BAND = float(K[0]), float(K[-1])
WATER, NEURON = Region("water", Constant(1.33)), Region("neuron", Constant(1.39))


@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize(("height", "accuracy"), [(0.0, 1e-6), (1.5, 1e-5)])
def test_a_plane_returns_the_falloff_of_a_mirror_image(
    height: float, accuracy: float, even: bool
) -> None:
    # where other things than the scene have no mirror image in x, all of the aperture is taken
    light = integrate_nodes(
        plane(WATER.material), objective(), height, BAND, accuracy, even=Symmetry(x=even, y=True)
    ).light
    expected = np.array([returned(k, height, 1.33) for k in K[::8].tolist()])
    found = fields(light.amplitude, light.optical_path_length, K[::8])
    assert light.status == AccuracyStatus.REACHED
    off = np.abs(np.abs(found) - np.abs(expected)).max()
    assert 2 * off <= accuracy * np.abs(expected).max()


def test_where_all_light_is_faint_fainter_light_is_followed() -> None:
    # of a thousandth each, so that what is reflected thrice is too faint to begin with
    index, height = (GLASS, 1.521, 1.5225), 0.01
    media = [Region(name, Constant(n)) for name, n in zip("abc", index, strict=True)]
    scene = Scene(media[0], (Plane("P", 0.0, *media[:2]), Plane("Q", height, *media[1:])))
    light = integrate(scene, objective(0.1), 0.0, BAND, 1e-2)
    # of light along the axis, nearly
    first, second = ((one - other) / (one + other) for one, other in pairwise(index))
    expected = np.abs(first + second * np.exp(2j * K * index[1] * height))
    assert light.status == AccuracyStatus.REACHED
    assert 2 * light.missing <= 1e-2 * expected.max()
    found = np.abs(fields(light.amplitude, light.optical_path_length, K))
    assert found == pytest.approx(expected, rel=1e-2)


def test_one_path_does_not_take_all_that_a_budget_leaves() -> None:
    # the survey takes 900, and the strongest path would take 300 in tiles of 50 to 100
    budget, glass = 1000, Region("glass", Constant(GLASS))
    surfaces = Plane("P", 0.0, glass, WATER), Cylinder("C", 0.0, 0.7, 0.6, NEURON, WATER)
    light = integrate(
        Scene(glass, surfaces), objective(0.9), 0.8, BAND, 1e-6, max_intersections=3, budget=budget
    )
    assert light.segments <= budget
    assert light.status == AccuracyStatus.BUDGET_SPENT
