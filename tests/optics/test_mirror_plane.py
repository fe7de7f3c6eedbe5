"""In which frame a scene is its own mirror image, and how it and its light are seen from there."""

import math

import numpy as np
import pytest

from octsim.optics.materials import Constant
from octsim.optics.mirror_plane import mirror_azimuth
from octsim.optics.scene import Cylinder, Plane, Region, Scene, neuron_on_glass
from octsim.optics.zernike import Aberration

GLASS, WATER = Region("glass", Constant(1.52)), Region("water", Constant(1.33))
NEURON = Region("neuron", Constant(1.39))
TEN = math.radians(10)


def cylinder(x: float, azimuth: float = 0.0, elevation: float = 0.0, z: float = 0.7) -> Cylinder:
    return Cylinder("C", x, z, 0.6, NEURON, WATER, azimuth, elevation)


def scene(*cylinders: Cylinder) -> Scene:
    return Scene(GLASS, (Plane("P", 0.0, GLASS, WATER), *cylinders))


def test_a_cylinder_across_the_optical_axis_is_the_thesiss_when_it_lies_along_y() -> None:
    indices = GLASS.material, WATER.material, NEURON.material
    turned = neuron_on_glass(*indices, 0.005, 1.4, azimuth=TEN)
    assert mirror_azimuth(turned) == TEN
    assert turned.turned(TEN) == neuron_on_glass(*indices, 0.005, 1.4)
    beside = neuron_on_glass(*indices, 0.005, 1.4, x=0.5, azimuth=TEN).turned(TEN)
    # its distance from the optical axis
    assert beside.surfaces[1].row[0] == pytest.approx(0.5 * math.cos(TEN), rel=1e-15)


@pytest.mark.parametrize("angle", [0.3, -1.2, 2.0])
def test_a_turned_cylinder_is_the_same_line(angle: float) -> None:
    one = cylinder(0.4, azimuth=0.2, elevation=-0.1)
    seen = one.turned(angle)
    turn = np.array(
        [[math.cos(angle), math.sin(angle), 0], [-math.sin(angle), math.cos(angle), 0], [0, 0, 1]]
    )
    axis = turn @ one.axis
    assert np.abs(np.cross(axis, seen.axis)).max() < 1e-15
    apart = np.array([seen.x, 0.0, seen.z]) - turn @ [one.x, 0.0, one.z]
    assert np.abs(np.cross(apart, axis)).max() < 1e-14
    assert seen.elevation == 0.1


def test_a_lifted_cylinder_is_mirrored_in_the_plane_of_its_axis() -> None:
    up, down = (scene(cylinder(0.0, TEN, elevation)) for elevation in (0.03, -0.03))
    frames = [one.turned(mirror_azimuth(one) or math.nan) for one in (up, down)]
    for one in frames:
        assert one.symmetry.y
        assert not one.symmetry.x
    assert frames[0].surfaces[1].row == pytest.approx(frames[1].surfaces[1].row, abs=1e-15)
    assert mirror_azimuth(scene(cylinder(0.1, 0.0, 0.03))) is None


def test_two_cylinders_that_are_mirror_images_have_a_plane_between_them() -> None:
    pair = scene(cylinder(-0.8, -TEN), cylinder(0.8, TEN))
    angle = mirror_azimuth(pair)
    assert angle is not None
    assert pair.turned(angle).symmetry.y
    crossing = cylinder(0.0), cylinder(0.0, math.pi / 2, z=2.0)
    assert mirror_azimuth(scene(*crossing)) is not None
    assert mirror_azimuth(scene(cylinder(0.0), cylinder(0.0, TEN, z=2.0))) is None
    assert mirror_azimuth(scene(cylinder(0.0), cylinder(1.5))) == 0
    assert mirror_azimuth(scene()) == 0


def test_an_aberration_is_the_same_one_seen_from_turned_axes() -> None:
    one = Aberration(((2, 0.1), (5, 0.02), (7, -0.03), (11, 0.04), (14, 0.01)))
    px, py = np.random.default_rng(1).uniform(-0.7, 0.7, (2, 50))
    cos, sin = math.cos(0.4), math.sin(0.4)
    there = one.wavefront(px * cos - py * sin, px * sin + py * cos)
    assert one.turned(0.4).wavefront(px, py) == pytest.approx(there, abs=1e-15)
    assert Aberration(((7, 0.1),)).turned(math.pi / 2).even == (False, True)
