"""The pupil's light in partial waves, beside vectors of s and p light and another rule."""

import numpy as np
import pytest
from dense_waves import Beam, Slide, waves_of_light

from octsim.optics.pupil import FibrePupil, GaussianPupil, Pupil, UniformPupil
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.illumination import illumination

K, WAVES, ALONG = 8.0, 12, (0.05, 0.6, 1.15)


@pytest.mark.parametrize("pupil", [UniformPupil(), GaussianPupil(0.7), FibrePupil(5.0, 20.0)])
@pytest.mark.parametrize("offset", [0.0, 0.4])
def test_waves_are_those_of_the_light_in_vectors(pupil: Pupil, offset: float) -> None:
    slide = Slide(1.52, 1.33, 1.39, 0.1, 1.2, offset)
    found = np.zeros((2, len(ALONG), 2, WAVES + 1), complex)
    lights = illumination(
        CylinderOnPlane(*slide), pupil, 1.2, 0.7, np.array(ALONG), np.array([K]), WAVES, 40
    )
    for lit in lights:
        found[lit.polarisation, :, 0] += lit.e[0]
        found[lit.polarisation, :, 1] += lit.h[0]
    for place, along in enumerate(ALONG):
        expected = waves_of_light(slide, Beam(pupil, 1.2, 0.7), K, along, WAVES, 80)
        np.testing.assert_allclose(
            found[:, place], expected[..., WAVES:], rtol=0, atol=1e-12 * np.abs(expected).max()
        )


def test_light_on_the_axis_has_one_mirror_class_and_off_it_both() -> None:
    at = np.array(ALONG), np.array([K]), WAVES, 20
    for offset, number in ((0.0, 2), (0.3, 4)):
        scene = CylinderOnPlane(1.52, 1.33, 1.39, 0.1, 1.2, offset)
        lights = illumination(scene, UniformPupil(), 1.2, 0.7, *at)
        assert len({(lit.polarisation, lit.mirror) for lit in lights}) == number


def test_a_tilted_wavefront_is_light_on_a_cylinder_beside_the_axis() -> None:
    at = UniformPupil(), 1.2, 0.7, np.array(ALONG), np.array([K, 9.0]), WAVES, 20
    scene = CylinderOnPlane(1.52, 1.33, 1.39, 0.1, 1.2, 0.1)
    tilted = illumination(scene, *at, wavefront=lambda px, _: -0.3 * 1.2 * px)
    beside = illumination(scene._replace(offset=0.4), *at)
    for one, other in zip(tilted, beside, strict=True):
        assert one[:2] == other[:2]
        for found, expected in zip(one[2:], other[2:], strict=True):
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
