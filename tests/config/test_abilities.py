"""What schemes can't do of a config is refused by name, with the scheme that can."""

from typing import Any

import pytest

from octsim.base.errors import ConfigError, OctsimWarning
from octsim.config.abilities import as_far_as, asked_of_scheme
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.scheme import light_keys
from octsim.schemes.table import COUNTED_RAYS, LIGHT_PATHS, SCHEMES, Ability

NEURON: dict[str, Any] = {"medium": "neuron"}
WAVES: list[tuple[dict[str, Any], str]] = [
    ({"objective": {"pupil": {"gaussian": 1}}}, "objective.pupil: {gaussian: 1.0} given, but {} does not weigh the pupil"),
    ({"objective": {"pupil": {"fibre": "5 um"}}}, "objective.pupil: {fibre: 5.0 um} given, but {} does not weigh the pupil"),
    ({"objective": {"apodisation": "aplanatic"}}, "objective.apodisation: aplanatic given, but {} has no apodisation"),
    ({"polarisation": {"input": "unpolarised"}}, "polarisation.input: unpolarised given, but {} has light of one kind"),
    ({"polarisation": {"input": "30 deg"}}, "polarisation.input: 30 deg given, but {} has light of one kind"),
    ({"polarisation": {"analyser": "0.5 rad"}}, "polarisation.analyser: 28.64788976 deg given, but {} has"),
    ({"scene": {"cylinders": [{**NEURON, "x": "100 nm"}]}}, "scene.cylinders.0.x: 0.1 um given, but {} has the cylinder on the optical axis"),
    ({"scene": {"cylinders": [{**NEURON, "azimuth": "10 deg"}]}}, "scene.cylinders.0.azimuth: 10 deg given, but {} has the cylinder along y"),
]  # fmt: skip
NOBODY: list[tuple[dict[str, Any], str]] = [
    ({"attenuation": {"neuron": "100 /cm"}}, "scene.attenuation.neuron: 0.01 /um given, but {} has no attenuation"),
    ({"layers": ["glass", {"medium": "water", "thickness": "9 um"}, "glass"]}, "scene.layers: [glass, water, glass] given, but {} has two layers"),
    ({"layers": ["glass", "glass"]}, "scene.layers: [glass, glass] given, but {} has two layers"),
    ({"layers": ["glass", {"medium": "neuron", "thickness": "swept"}, "water"], "cylinders": []}, "scene.cylinders: [] given, but {} needs a cylinder"),
    ({"cylinders": [{"medium": "water"}]}, "scene.cylinders.0.medium: water given, but {} needs a cylinder"),
    ({"cylinders": [NEURON, {**NEURON, "diameter": "1 um", "x": "2 um"}]}, "scene.cylinders: [neuron, neuron] given, but {} has one cylinder"),
    ({"cylinders": [{**NEURON, "elevation": "1 deg"}]}, "scene.cylinders.0.elevation: 1 deg given, but {} has the cylinder level"),
    ({"cylinders": [{**NEURON, "shells": [{"medium": "glass", "thickness": "5 nm"}]}]}, "scene.cylinders.0.shells: [glass] given, but {} has a cylinder without shells"),
]  # fmt: skip


def refused(scheme: str, overlay: dict[str, Any]) -> list[str]:
    with pytest.raises(ConfigError) as raised:
        load_config({"tracing": {"scheme": scheme}}, overlay)
    return str(raised.value).splitlines()


@pytest.mark.parametrize(("overlay", "line"), WAVES, ids=[line[:40] for _, line in WAVES])
@pytest.mark.parametrize("scheme", ["vogel", "paths"])
def test_what_waves_alone_can_do_is_refused_by_rays(
    scheme: str, overlay: dict[str, Any], line: str
) -> None:
    (said,) = refused(scheme, overlay)
    assert said.startswith(line.replace("{} ", f"tracing.scheme: {scheme} "))
    assert said.endswith("; give tracing.scheme: fullwave, or leave it out")
    load_config({"tracing": {"scheme": "fullwave"}}, overlay)


@pytest.mark.parametrize(("scene", "line"), NOBODY, ids=[line[:40] for _, line in NOBODY])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_what_no_scheme_can_do_is_refused_by_all(
    scheme: str, scene: dict[str, Any], line: str
) -> None:
    said = [one for one in refused(scheme, {"scene": scene}) if "no scheme does yet" in one]
    assert any(one.startswith(line.replace("{} ", f"tracing.scheme: {scheme} ")) for one in said)


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
    config = load_config(
        {"tracing": {"scheme": "fullwave"}}, *(overlay for overlay, _ in WAVES[1:7])
    )
    assert config != load_config({"tracing": {"scheme": "fullwave"}})
    for scheme in (COUNTED_RAYS, LIGHT_PATHS):
        plain = as_far_as(scheme, config)
        assert plain == load_config({"tracing": {"scheme": "fullwave"}})
    assert as_far_as(SCHEMES["fullwave"], config) == config


def test_a_spectrum_depends_on_polarisation_where_a_scheme_has_it_and_no_light_does() -> None:
    for name, scheme in SCHEMES.items():
        assert "polarisation" not in light_keys(load_config({"tracing": {"scheme": name}}))
        assert ("polarisation" in scheme.summing_keys) == (Ability.POLARISATION in scheme.honours)
    assert {"scene", "objective"} < set(light_keys(Config()))
