"""Codes and names of light paths."""

import numpy as np
import pytest

from octsim.optics.materials import Constant
from octsim.optics.scene import Cylinder, Plane, Region, Scene
from octsim.tracing.faces import AnyFaces, Faces, faces_at
from octsim.tracing.light_paths import LONGEST, path_name, steps_of
from octsim.tracing.path_codes import code_behind, path_code, steps_of_code

GLASS, WATER = Region("glass", Constant(1.52)), Region("water", Constant(1.33))
FILM, NEURON = Region("film", Constant(1.45)), Region("neuron", Constant(1.39))


def read(faces: Faces, code: int) -> list[tuple[int, bool]]:
    """Return the faces that a path meets, and whether it goes through each."""
    face, through = np.empty(LONGEST, np.int64), np.empty(LONGEST, np.bool_)
    num = steps_of(faces, code, face, through)
    return [(int(f), bool(t)) for f, t in zip(face[:num], through[:num], strict=True)]


def test_a_path_is_named_after_the_surfaces_of_its_scene() -> None:
    assert path_name(0b1_01_10_01, ("P", "C")) == "PT CR PT"
    assert path_name(1, ("P", "C")) == ""
    # in base 6: through the film, off the cylinder, back through the film
    assert path_name(((6 + 3) * 6 + 4) * 6 + 3, ("P", "film ", "C")) == "film T CR film T"


@pytest.mark.parametrize("elevation", [0.0, 0.02])
def test_a_code_is_read_digit_by_digit_of_a_plane_and_a_cylinder(elevation: float) -> None:
    cylinder = Cylinder("C", 0.0, 0.8, 0.7, NEURON, WATER, elevation=elevation)
    faces = faces_at(Scene(GLASS, (Plane("P", 0.0, GLASS, WATER), cylinder)), 8.0)
    # the plane from below and from above, the cylinder from inside and from outside
    below, above, inside, outside = range(4)
    assert isinstance(faces, AnyFaces) == (elevation > 0)
    assert read(faces, 1) == []
    assert read(faces, 0b1_00) == [(below, False)]
    assert read(faces, 0b1_01_10_01) == [(below, True), (outside, False), (above, True)]
    assert read(faces, 0b1_01_11_10_11_01) == [
        (below, True), (outside, True), (inside, False), (inside, True), (above, True)
    ]  # fmt: skip
    # and light is labelled so on its way
    code = 1
    for face, through in read(faces, 0b1_01_11_10_11_01):
        code = code_behind(faces, code, face) + through
    assert code == 0b1_01_11_10_11_01


def test_a_counted_code_is_that_of_the_steps_that_are_read_from_it() -> None:
    planes = Plane("P", 0.0, GLASS, FILM), Plane("Q", 0.1, FILM, WATER)
    scene = Scene(GLASS, (*planes, Cylinder("C", 0.0, 0.8, 0.6, NEURON, WATER)))
    faces = faces_at(scene, 8.0)
    assert isinstance(faces, AnyFaces)
    seen = set()
    for code in [*range(60), 5_000, 123_456]:
        steps = read(faces, code)
        said = [2 * face + through for face, through in steps]
        assert said == steps_of_code(faces, code)
        assert path_code(faces, np.array(said, np.int64), len(said), -1) == code
        seen.add(tuple(said))
    assert len(seen) == 62
    # the shortest: reflected at the first plane
    assert read(faces, 0) == [(0, False)]
