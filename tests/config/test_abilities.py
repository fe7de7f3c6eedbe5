"""What schemes can't do of a config is refused by name, with the scheme that can."""

from typing import Any

import pytest

from octsim.base.errors import ConfigError, OctsimWarning
from octsim.config.abilities import as_far_as, asked_of_scheme
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.scheme import light_keys
from octsim.schemes.table import LIGHT_PATHS, SCHEMES, Ability

NEURON: dict[str, Any] = {"medium": "neuron"}
SOME: list[tuple[str, dict[str, Any], str, str]] = [
    ("paths", {"beam": {"waist": "diffraction"}}, "beam.waist: diffraction given, but {} has rays that meet in the focus", "vogel"),
    ("paths", {"detector": {"falloff": "fibre"}}, "detector.falloff: fibre given, but {} does not weigh by a falloff without an edge", "vogel"),
    ("paths", {"objective": {"zernike": {7: "1 nm"}}}, "objective.zernike: {7: 0.001 um} (coma y) given, but {} needs an aberration that is even along", "vogel"),
    ("fullwave", {"objective": {"zernike": {5: "1 nm"}}}, "objective.zernike: {5: 0.001 um} (astigmatism oblique) given, but {} needs an aberration that is even along", "vogel"),
    ("fullwave", {"detector": {"falloff": "top_hat"}}, "detector.falloff: top_hat given, but {} does not weigh by a falloff", "vogel or paths"),
    ("fullwave", {"detector": {"falloff": "fibre"}}, "detector.falloff: fibre given, but {} does not weigh by a falloff", "vogel"),
    ("fullwave", {"beam": {"waist": "0.1 um"}}, "beam.waist: 0.1 um given, but {} has rays that meet in the focus", "vogel"),
    ("fullwave", {"scene": {"attenuation": {"water": "1 /cm"}}}, "scene.attenuation.water: 1 /cm given, but {} has no attenuation around the cylinder", "vogel or paths"),
]  # fmt: skip
EVERY: list[dict[str, Any]] = [
    {"objective": {"pupil": {"gaussian": 1}}},
    {"objective": {"pupil": {"fibre": "5 um"}}},
    {"objective": {"apodisation": "aplanatic"}},
    {"objective": {"zernike": {"coma x": "1 nm", "spherical": "1 nm"}}},
    {"objective": {"zernike": {4: "1 nm"}, "zernike_rays": "phase"}},
    {"objective": {"focal_shift": {"reference": "755 nm", "linear": "0.4 um/um"}}},
    {
        "objective": {"immersion": "oil"},
        "scene": {
            "refractive_index": {"oil": 1.515},
            "layers": [{"medium": "glass", "thickness": "170 um"}, "water"],
        },
    },
    {"polarisation": {"input": "unpolarised"}},
    {"polarisation": {"input": "30 deg", "analyser": "0.5 rad"}},
    {"scene": {"refractive_index": {"water": "water", "neuron": {"cauchy": [1.38, 0.004]}}}},
    {"scene": {"attenuation": {"neuron": "100 /cm"}}},
    {"interferometer": {"reference": {"amplitude": 0.004, "length": "9 um"}}},
]
SCENES: list[tuple[Ability, dict[str, Any], str]] = [
    (Ability.OFF_AXIS, {"cylinders": [{**NEURON, "x": "100 nm"}]}, "scene.cylinders.0.x: 0.1 um given, but {} has the cylinder on the optical axis"),
    (Ability.AZIMUTH, {"cylinders": [{**NEURON, "azimuth": "10 deg"}]}, "scene.cylinders.0.azimuth: 10 deg given, but {} has the cylinder along y"),
    (Ability.LAYERS, {"layers": ["glass", {"medium": "water", "thickness": "9 um"}, "glass"]}, "scene.layers: [glass, water, glass] given, but {} has two layers"),
    (Ability.UNMIRRORED, {"cylinders": [{**NEURON, "x": "100 nm", "elevation": "2 deg"}]}, "scene.cylinders: [neuron at azimuth 0 deg, elevation 2 deg, x 0.1 um] given, but {} needs a plane"),
    (Ability.LAYERS, {"layers": ["glass", "glass"]}, "scene.layers: [glass, glass] given, but {} has two layers"),
    (Ability.CYLINDERS, {"cylinders": [NEURON, {**NEURON, "diameter": "1 um", "x": "2 um"}]}, "scene.cylinders: [neuron, neuron] given, but {} has one cylinder"),
    (Ability.ELEVATION, {"cylinders": [{**NEURON, "elevation": "1 deg"}]}, "scene.cylinders.0.elevation: 1 deg given, but {} has the cylinder level"),
    (Ability.SHELLS, {"cylinders": [{**NEURON, "shells": [{"medium": "glass", "thickness": "5 nm"}]}]}, "scene.cylinders.0.shells: [glass] given, but {} has a cylinder without shells"),
]  # fmt: skip


def refused(scheme: str, overlay: dict[str, Any]) -> list[str]:
    with pytest.raises(ConfigError) as raised:
        load_config({"tracing": {"scheme": scheme}}, overlay)
    return str(raised.value).splitlines()


@pytest.mark.parametrize(("ability", "scene", "line"), SCENES, ids=[one[2][:40] for one in SCENES])
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.filterwarnings("ignore::octsim.base.errors.OctsimWarning")
def test_a_scene_is_refused_by_the_schemes_that_lack_it(
    scheme: str, ability: Ability, scene: dict[str, Any], line: str
) -> None:
    able = [name for name, other in SCHEMES.items() if ability in other.honours]
    if scheme in able:
        config = load_config({"tracing": {"scheme": scheme}}, {"scene": scene})
        assert ability in {one.ability for one in asked_of_scheme(config)}
        return
    start = line.replace("{} ", f"tracing.scheme: {scheme} ")
    (said,) = (one for one in refused(scheme, {"scene": scene}) if one.startswith(start))
    assert said.endswith(f"; give tracing.scheme: {' or '.join(able)}, or leave it out")


@pytest.mark.parametrize(
    ("scene", "key"),
    [
        ({"layers": ["glass", {"medium": "glass", "thickness": "swept"}, "glass"],
          "cylinders": []}, "scene.layers"),
        ({"cylinders": [{"medium": "water"}]}, "scene.cylinders.0.medium"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.filterwarnings("ignore::octsim.base.errors.OctsimWarning")
def test_a_swept_thing_that_is_no_surface_is_refused_where_nothing_is_left_to_solve(
    scheme: str, scene: dict[str, Any], key: str
) -> None:
    if Ability.NO_CYLINDER in SCHEMES[scheme].honours:
        config = load_config({"tracing": {"scheme": scheme}}, {"scene": scene})
        assert Ability.NO_CYLINDER in {one.ability for one in asked_of_scheme(config)}
        return
    (said,) = refused(scheme, {"scene": scene})
    assert said.startswith(f"{key}: ")
    assert "the same material on both sides is no surface" in said


@pytest.mark.parametrize(("scheme", "overlay", "line", "able"), SOME)
def test_what_some_schemes_can_do_is_refused_by_the_others(
    scheme: str, overlay: dict[str, Any], line: str, able: str
) -> None:
    (said,) = refused(scheme, overlay)
    assert said.startswith(line.replace("{} ", f"tracing.scheme: {scheme} "))
    assert said.endswith(f"; give tracing.scheme: {able}, or leave it out")


@pytest.mark.parametrize("overlay", EVERY, ids=str)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_what_every_scheme_can_do_is_refused_by_none(scheme: str, overlay: dict[str, Any]) -> None:
    config = load_config({"tracing": {"scheme": scheme}}, overlay)
    asked = {one.ability for one in asked_of_scheme(config)}
    assert asked
    assert asked <= SCHEMES[scheme].honours


def test_what_is_a_schemes_own_way_is_no_matter() -> None:
    own = {"pupil": "uniform", "apodisation": "none"}
    plain = {"cylinders": [{**NEURON, "x": "0 um", "azimuth": "0 deg", "shells": []}]}
    given = {"objective": own, "polarisation": {"input": "none", "analyser": None}, "scene": plain}
    for scheme in ("vogel", "paths"):
        config = load_config({"tracing": {"scheme": scheme}}, given)
        assert list(asked_of_scheme(config)) == []


def test_no_apodisation_is_said_to_be_read_as_not_given_by_an_aplanatic_scheme() -> None:
    with pytest.warns(OctsimWarning, match="objective.apodisation: none is read as not given"):
        load_config({"tracing": {"scheme": "fullwave"}, "objective": {"apodisation": "none"}})


def test_a_config_of_waves_is_one_of_rays_as_far_as_those_can() -> None:
    beside = {**NEURON, "x": "100 nm"}
    plain, lifted = (
        load_config({"scene": {"cylinders": [one]}}, EVERY[0])
        for one in (beside, {**beside, "elevation": "2 deg"})
    )
    # one lacks what is lifted, the other a plane in which it is mirrored
    for scheme in (SCHEMES["fullwave"], LIGHT_PATHS):
        assert as_far_as(scheme, lifted) == plain
        assert as_far_as(scheme, plain) == plain
    assert as_far_as(SCHEMES["vogel"], lifted) == lifted


def test_waves_are_found_for_all_polarisations_and_rays_for_the_one_that_is_asked_for() -> None:
    for name, scheme in SCHEMES.items():
        plain = load_config({"tracing": {"scheme": name}})
        polarised = load_config(plain.to_dict(), {"polarisation": {"input": "left"}})
        waves = scheme.light == "waves"
        assert "polarisation" not in light_keys(plain)
        assert ("polarisation" in light_keys(polarised)) != waves
        assert ("polarisation" in scheme.summing_keys) == waves
    assert {"scene", "objective"} < set(light_keys(Config()))
