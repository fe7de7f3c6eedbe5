"""A config as optics: scene, pupil and polarisation."""

from math import pi, sqrt
from typing import Any

import pytest

from octsim.config.load import load_config
from octsim.instrument.build import (
    detector_of,
    polarisation_of,
    pupil_of,
    scene_of,
    surface_names,
)
from octsim.optics.polarisation import LEFT, UNPOLARISED, Polarisation
from octsim.optics.pupil import FibrePupil, GaussianPupil, Pupil, UniformPupil
from octsim.optics.scene import Cylinder, Plane


@pytest.mark.parametrize(
    ("scheme", "pupil", "expected"),
    [
        ("vogel", None, UniformPupil()),
        ("paths", "uniform", UniformPupil()),
        ("fullwave", None, FibrePupil(5.0, 25.0)),
        ("fullwave", "none", FibrePupil(5.0, 25.0)),
        ("fullwave", "uniform", UniformPupil()),
        ("fullwave", {"gaussian": 0.5}, GaussianPupil(0.5)),
        ("fullwave", {"fibre": "4 um"}, FibrePupil(4.0, 25.0)),
    ],
)
def test_a_pupil_is_the_one_given_or_the_schemes_own(
    scheme: str, pupil: object, expected: Pupil
) -> None:
    objective = {"pupil": pupil, "magnification": 25}
    config = load_config({"tracing": {"scheme": scheme}, "objective": objective})
    assert pupil_of(config) == expected


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({}, UNPOLARISED),
        ({"input": "unpolarised"}, UNPOLARISED),
        ({"input": "left"}, Polarisation(LEFT)),
        ({"input": "none", "analyser": "90 deg"}, Polarisation(None, pi / 2)),
    ],
)
def test_polarisation_is_as_given(given: dict[str, Any], expected: Polarisation) -> None:
    config = load_config({"tracing": {"scheme": "fullwave"}, "polarisation": given})
    assert polarisation_of(config) == expected


def test_an_angle_is_from_x_to_y() -> None:
    given = {"input": "30 deg", "analyser": "-0.5 rad"}
    found = polarisation_of(load_config({"tracing": {"scheme": "fullwave"}, "polarisation": given}))
    assert found.input == pytest.approx((sqrt(3) / 2, 0.5))
    assert found.analyser == -0.5


def test_a_scene_is_what_its_keys_say() -> None:
    cylinder = {"medium": "axon", "x": "1 um", "azimuth": "90 deg", "gap": "20 nm"}
    given = {
        "refractive_index": {"oil": 1.5, "axon": 1.4},
        "layers": ["oil", "water"],
        "cylinders": [cylinder],
    }
    config = load_config({"tracing": {"scheme": "fullwave"}, "scene": given})
    plane, found = scene_of(config, 2.0).surfaces
    assert isinstance(plane, Plane)
    assert isinstance(found, Cylinder)
    assert (found.x, found.z, found.radius, found.azimuth) == (1.0, 1.02, 1.0, pi / 2)
    regions = plane.below, plane.above, found.inside
    assert [region.material.index(8.0).real for region in regions] == [1.5, 1.33, 1.4]
    sine = config.objective.numerical_aperture / 1.5
    radius = config.objective.focus_distance * sine / sqrt(1 - sine**2)
    assert detector_of(config).objective_radius == pytest.approx(radius)


def test_plates_are_the_layers_with_the_swept_one_between() -> None:
    film = {"medium": "neuron", "thickness": "swept"}
    thick = {"medium": "glass", "thickness": "0.5 um"}
    between = ["glass", thick, film, {"medium": "water", "thickness": "1 um"}, "glass"]
    given = {"layers": between, "cylinders": [], "attenuation": {"neuron": "100 /cm"}}
    config = load_config({"scene": given})
    scene = scene_of(config, 2.0)
    planes = [surface for surface in scene.surfaces if isinstance(surface, Plane)]
    # the glass above z = 0 belongs to the slide
    assert [plane.height for plane in planes] == [0.5, 2.5, 3.5]
    assert scene.surface_names == surface_names(config) == ("P", "Q", "S")
    assert [region.name for region in scene.regions] == ["glass", "neuron", "water", "glass 2"]
    assert [region.attenuation for region in scene.regions] == [0.0, 0.01, 0.0, 0.0]
    assert planes[-1].above != scene.objective
