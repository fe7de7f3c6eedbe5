"""Regions, what they are made of, and the symmetry of a scene."""

import math
from typing import ClassVar

from octsim.optics.materials import Constant
from octsim.optics.scene import Cylinder, Plane, Region, Scene, Symmetry, neuron_on_glass
from octsim.tracing.faces import faces_at

GLASS, WATER = Region("glass", Constant(1.52)), Region("water", Constant(1.33))
PLANE = Plane("P", 0.0, GLASS, WATER)


def neuron(name: str, x: float) -> Cylinder:
    return Cylinder(name, x, 0.7, 0.6, Region(name, Constant(1.39)), WATER)


def test_two_neurons_are_two_regions_of_one_material() -> None:
    scene = Scene(GLASS, (PLANE, neuron("A", -0.7), neuron("B", 0.7)))
    assert [region.name for region in scene.regions] == ["glass", "water", "A", "B"]
    faces = faces_at(scene, 8.0)
    # from within one, light meets that one's own wall alone
    for f in (2, 4):
        after = faces.after_transmission[f + 1]
        assert faces.next_face[faces.first[after] : faces.first[after + 1]].tolist() == [f]
    assert faces.n_i[[2, 4]].tolist() == [1.39, 1.39]


def test_a_scene_is_as_symmetric_as_all_of_its_surfaces() -> None:
    both = Symmetry(x=True, y=True)
    thesis = neuron_on_glass(GLASS.material, WATER.material, Constant(1.39), 0.0, 1.0)
    assert thesis.symmetry == both
    assert Scene(GLASS, (PLANE, neuron("A", 1e-9))).symmetry == Symmetry(x=False, y=True)


def test_materials_are_taken_at_the_wavenumber() -> None:
    class Dispersive:
        dispersive: ClassVar[bool] = True
        absorbs: ClassVar[bool] = True

        def index(self, wavenumber: float) -> complex:
            return 1.3 + 0.01 * wavenumber + 1e-4j

        def slope(self, wavenumber: float) -> float:  # noqa: ARG002
            return 0.01

    scene = neuron_on_glass(GLASS.material, WATER.material, Dispersive(), 0.005, 1.4)
    for k in (7.0, 9.0):
        assert faces_at(scene, k).n_i.tolist() == [1.52, 1.33, 1.3 + 0.01 * k, 1.33]
        assert faces_at(scene, k).n_t.tolist() == [1.33, 1.52, 1.33, 1.3 + 0.01 * k]


def test_a_cylinder_at_an_azimuth_has_no_mirror_plane_and_faces_of_its_axis() -> None:
    indices = GLASS.material, WATER.material, Constant(1.39)
    turned = neuron_on_glass(*indices, 0.0, 1.0, x=0.5, azimuth=0.1)
    assert turned.symmetry == Symmetry(x=False, y=False)
    axis = (-math.sin(0.1), math.cos(0.1), 0.0)
    assert tuple(faces_at(turned, 8.0).shape[2]) == (0.5, 0.5, 0.5, *axis)
    beside = neuron_on_glass(*indices, 0.005, 1.0, x=0.5)
    assert beside.surfaces[1].row == (0.5, 0.505, 0.5)
