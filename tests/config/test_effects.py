"""Keys of what the thesis left out: what is read, refused, asked of a scheme and remarked on."""

import json
from dataclasses import replace
from typing import Any

import pytest
from gridded import gridded

from octsim.base.errors import ConfigError, OctsimWarning
from octsim.config.abilities import as_far_as, asked_of_scheme
from octsim.config.checks import impossible, plain_remarks
from octsim.config.derive import merge, validated
from octsim.config.effects import FocalShiftConfig
from octsim.config.load import load_config
from octsim.config.messages import unit_of
from octsim.config.models import Config
from octsim.config.nearest import nearest_key
from octsim.config.unread import unread, unread_scene
from octsim.optics.zernike import NAMES
from octsim.schemes.table import COUNTED_RAYS, Ability


def checked(*overlays: dict[str, Any]) -> Config:
    """Return a config whose keys are checked, whatever its scheme can do of them."""
    data = Config().to_dict()
    for overlay in overlays:
        data = merge(data, overlay)
    return validated(data)


SHIFT = {"reference": "755 nm", "linear": "0.4 um/um", "quadratic": "-0.2 um/um^2"}
ARM = {"amplitude": 0.004, "length": "9 um"}
EVERY: dict[str, Any] = {
    "objective": {
        "zernike": {"spherical": "10 nm", 8: "-2 nm", "4": "0 nm"},
        "zernike_rays": "phase",
        "focal_shift": SHIFT,
    },
    "beam": {"waist": "200 nm", "wavelength": "755 nm"},
    "detector": {"falloff": "fibre", "mode_field_diameter": "5 um", "fibre_na": 0.12},
    "interferometer": {"reference": ARM},
}


def test_every_effect_is_off_and_none_is_absent() -> None:
    plain = Config()
    assert plain.objective.zernike.of == {}
    assert (plain.objective.zernike_rays, plain.objective.focal_shift) == ("normal", None)
    assert (plain.beam.waist, plain.beam.wavelength) == (None, "each")
    assert (plain.detector.falloff, plain.detector.mode_field_diameter) == ("parabolic", None)
    assert (plain.detector.fibre_na, plain.interferometer.reference) == (0.13, None)
    absent = {
        "objective": {"zernike": "none", "focal_shift": "none"},
        "beam": {"waist": "none"},
        "interferometer": {"reference": "none"},
    }
    assert load_config(absent) == plain


def test_effects_read_back_to_the_same_bits() -> None:
    config = checked(EVERY)
    assert Config.model_validate(json.loads(json.dumps(config.to_dict()))) == config
    assert config.to_dict()["objective"]["zernike"] == {
        "4": "0.0 um", "8": "-0.002 um", "11": "0.01 um",
    }  # fmt: skip
    assert config.objective.zernike.of == {8: -0.002, 11: 0.01}
    assert (config.beam.waist, config.beam.wavelength) == (0.2, 0.755)
    assert checked({"beam": {"waist": "diffraction"}}).beam.waist == "diffraction"
    reference = config.interferometer.reference
    assert reference is not None
    assert (reference.amplitude, reference.length) == (0.004, 9.0)


@pytest.mark.parametrize("name", ["Coma X", "coma_x", "coma-x", "horizontal coma", 8, "8"])
def test_a_zernike_term_has_a_number_and_names(name: object) -> None:
    config = checked({"objective": {"zernike": {name: "1 nm"}}})
    assert config.objective.zernike.of == {NAMES["coma x"]: 0.001}


def test_a_focal_shift_is_a_parabola_in_the_wavelength() -> None:
    shift = checked(EVERY).objective.focal_shift
    assert isinstance(shift, FocalShiftConfig)
    assert (shift.linear, shift.quadratic, shift.moves) == (0.4, -0.2, True)
    assert shift.formula.at_wavelength(0.755) == 0.0
    assert shift.formula.at_wavelength(0.855) == pytest.approx(0.04 - 0.002)
    assert shift.formula.highest(0.65, 0.9) == shift.formula.at_wavelength(0.9)
    steep = shift.model_copy(update={"quadratic": -4.0})
    assert steep.formula.highest(0.65, 0.9) == pytest.approx(
        steep.formula.at_wavelength(0.755 + 0.05)
    )
    alone = checked({"objective": {"focal_shift": {"reference": "755 nm"}}}).objective.focal_shift
    assert alone is not None
    assert not alone.moves
    for text in ("400 nm/um", "0.4 nm/nm", "40 %"):
        given = {"objective": {"focal_shift": {**SHIFT, "linear": text}}}
        assert checked(given) == checked({"objective": {"focal_shift": SHIFT}})
    for text in ("-0.2 1/um", "-200 nm/um^2", "-200 nm/um²", "-200 /mm"):
        given = {"objective": {"focal_shift": {**SHIFT, "quadratic": text}}}
        assert checked(given) == checked({"objective": {"focal_shift": SHIFT}})


def zernike(**terms: Any) -> dict[str, Any]:
    return {"objective": {"zernike": terms}}


def shifted(**given: Any) -> dict[str, Any]:
    return {"objective": {"focal_shift": {**SHIFT, **given}}}


BAD: list[tuple[dict[str, Any], str]] = [
    (zernike(sferical="1 nm"), "objective.zernike: {sferical: 1 nm} given; 'sferical' is no Zernike term that is known; the nearest is 'spherical'"),
    ({"objective": {"zernike": {0: "1 nm"}}}, "objective.zernike: {0: 1 nm} given; 0 is none of Noll's numbers that are known, 1 to 66"),
    ({"objective": {"zernike": {-11: "1 nm"}}}, "objective.zernike: {-11: 1 nm} given; -11 is none of Noll's numbers"),
    ({"objective": {"zernike": {"-11": "1 nm"}}}, "-11 is none of Noll's numbers that are known, 1 to 66"),
    (zernike(coma="1 nm"), "coma has a direction: write coma y (7) or coma x (8)"),
    (zernike(Trefoil="1 nm"), "trefoil has a direction: write trefoil y (9) or trefoil x (10)"),
    ({"objective": {"zernike": {67: "1 nm"}}}, "67 is none of Noll's numbers that are known, 1 to 66"),
    ({"objective": {"zernike": {True: "1 nm"}}}, "True is no Zernike term"),
    ({"objective": {"zernike": {11: "1 nm", "spherical": "1 nm"}}}, "the term 11 is given twice, once as 'spherical'; write it one way, as 11, and once"),
    ({"objective": {"zernike": {11: "1 nm", "11": "1 nm"}}}, "the term 11 is given twice"),
    ({"objective": {"zernike": {11: 10}}}, "objective.zernike.11: 10 given (spherical); a length needs its unit"),
    (zernike(spherical="101 um"), "objective.zernike.11: '101 um' given (spherical); it should be less than or equal to 100"),
    (zernike(spherical="1 rad"), "objective.zernike.11: '1 rad' given (spherical); 'rad' is not a unit of length"),
    ({"objective": {"zernike": "10 nm"}}, "objective.zernike: '10 nm' given; it should be Zernike terms by Noll's number or name"),
    ({"objective": {"zernike_rays": "phases"}}, "objective.zernike_rays: 'phases' given; the nearest that is known is 'phase'"),
    ({"objective": {"focal_shift": "0.1 um"}}, "objective.focal_shift: '0.1 um' given; it should be none, or {reference: 755 nm"),
    ({"objective": {"focal_shift": {"linear": "1 um/um"}}}, "objective.focal_shift.reference: missing"),
    (shifted(linear=0.4), "objective.focal_shift.linear: 0.4 given; a length per length needs its unit; write it with its unit, such as 0.4 um/um"),
    (shifted(linear="0.4 um"), "0.4 um is a length; give a length per length, as 0.4 um/um"),
    (shifted(quadratic="0.4 um/um"), "0.4 um/um is a length per length; give an inverse length, as 0.2 um/um^2"),
    (shifted(quadratic="0.4 um/s^2"), "'um/s^2' is not a unit that is known"),
    (shifted(reference="0 nm"), "objective.focal_shift.reference: '0 nm' given; it should be greater than or equal to 0.001 um"),
    (shifted(linaer="0 um/um"), "objective.focal_shift.linaer: unknown key; the nearest known one is objective.focal_shift.linear"),
    ({"beam": {"waist": "diffracted"}}, "beam.waist: 'diffracted' given; not a length; write it with its unit"),
    ({"beam": {"waist": 0.2}}, "beam.waist: 0.2 given; a length needs its unit"),
    ({"beam": {"waist": "0 um"}}, "beam.waist: '0 um' given; it should be from 1e-06 um to 1e+06 um, or diffraction"),
    ({"beam": {"wavelength": "all"}}, "beam.wavelength: 'all' given; not a length"),
    ({"beam": {"wavelength": None}}, "beam.wavelength: null given"),
    ({"beam": {"width": "1 um"}}, "beam.width: unknown key; the nearest known one is beam.waist"),
    ({"detector": {"falloff": "tophat"}}, "detector.falloff: 'tophat' given; the nearest that is known is 'top_hat'"),
    ({"detector": {"mode_field_diameter": "0 um"}}, "detector.mode_field_diameter: '0 um' given; it should be greater than or equal to 0.000001 um"),
    ({"detector": {"fibre_na": 1}}, "detector.fibre_na: 1 given; it should be less than 1"),
    ({"detector": {"fibre_na": 0}}, "detector.fibre_na: 0 given; it should be greater than 0"),
    ({"interferometer": {"reference": 0.004}}, "interferometer.reference: 0.004 given; it should be none, or {amplitude: 0.004, length: 9 um}"),
    ({"interferometer": {"reference": {"amplitude": 0.1}}}, "interferometer.reference.length: missing"),
    ({"interferometer": {"reference": {**ARM, "amplitude": -1}}}, "interferometer.reference.amplitude: -1 given; it should be greater than or equal to 0"),
    ({"interferometer": {"reference": {**ARM, "length": 9}}}, "interferometer.reference.length: 9 given; a length needs its unit"),
    ({"objective": {"pupil": {"fiber": "5 um"}}}, "objective.pupil: {fiber: 5 um} given; the nearest that is known is fibre; it should be uniform, {gaussian: 1.0} or {fibre: 5 um}"),
    ({"objective": {"pupil": {"Gaussian": 1}}}, "objective.pupil: {Gaussian: 1} given; the nearest that is known is gaussian; it should be"),
    ({"polarisation": {"input": "x"}}, "did you mean 0 deg, along x?"),
    ({"polarisation": {"input": "linear"}}, "polarisation.input: 'linear' given; it should be an angle as 30 deg, unpolarised, left or right; did you mean an angle from x to y"),
    ({"polarisation": {"analyser": "V"}}, "did you mean 90 deg, along y?"),
    ({"scene": {"attenuation": {"neuron": "10 um"}}}, "scene.attenuation.neuron: '10 um' given; 10 um is a length; give an inverse length, as 100 /cm"),
    ({"scene": {"attenuation": {"neuron": "-1 /cm"}}}, "scene.attenuation.neuron: '-1 /cm' given; it should be greater than or equal to 0 /um"),
    ({"scene": {"gap": "1,4 um"}}, "scene.gap: '1,4 um' given; write it with a point, as 1.4 um"),
    ({"scene": {"refractive_index": {"neuron": "1,39"}}}, "scene.refractive_index.neuron: '1,39' given; write it with a point, as 1.39"),
    ({"objective": {"pupil": {"gaussian": 0}}}, "objective.pupil.gaussian: 0 given; it should be greater than or equal to 0.000001"),
]  # fmt: skip


@pytest.mark.parametrize(("overlay", "line"), BAD, ids=[line[:60] for _, line in BAD])
def test_a_bad_effect_is_refused_in_one_line(overlay: dict[str, Any], line: str) -> None:
    with pytest.raises(ConfigError) as raised:
        checked(overlay)
    assert line in str(raised.value)
    assert "\n" not in str(raised.value)


ASKED: list[tuple[dict[str, Any], Ability, str, str]] = [
    (zernike(spherical="10 nm"), Ability.ZERNIKE, "objective.zernike", "{11: 0.01 um} (spherical)"),
    (shifted(), Ability.FOCAL_SHIFT, "objective.focal_shift", "{linear: 0.4 um/um, quadratic: -0.2 1/um, reference: 0.755 um}"),
    ({"detector": {"falloff": "top_hat"}}, Ability.FALLOFF, "detector.falloff", "top_hat"),
    ({"beam": {"waist": "diffraction"}}, Ability.WAIST, "beam.waist", "diffraction"),
    ({"beam": {"waist": "0.1 um"}}, Ability.WAIST, "beam.waist", "0.1 um"),
    ({"interferometer": {"reference": ARM}}, Ability.REFERENCE, "interferometer.reference", "{amplitude: 0.004, length: 9.0 um}"),
]  # fmt: skip


@pytest.mark.parametrize(("overlay", "ability", "key", "given"), ASKED)
def test_an_effect_is_asked_of_a_scheme_and_dropped_where_it_can_t(
    overlay: dict[str, Any], ability: Ability, key: str, given: str
) -> None:
    config = checked(overlay)
    (asked,) = asked_of_scheme(config)
    assert asked == (ability, key, given)
    unable = replace(COUNTED_RAYS, honours=frozenset(Ability) - {ability})
    assert as_far_as(unable, config) == Config()
    able = replace(COUNTED_RAYS, honours=frozenset(Ability))
    assert as_far_as(able, config) == config


@pytest.mark.parametrize(
    "overlay",
    [
        zernike(spherical="0 nm"),
        {"objective": {"zernike_rays": "phase"}},
        shifted(linear="0 um/um", quadratic="0 1/um"),
        {"beam": {"wavelength": "755 nm"}},
        {"detector": {"falloff": "parabolic", "fibre_na": 0.2, "mode_field_diameter": "5 um"}},
        {"interferometer": {"reference": {**ARM, "amplitude": 0}}},
    ],
)
def test_what_changes_nothing_is_asked_of_nobody(overlay: dict[str, Any]) -> None:
    assert list(asked_of_scheme(checked(overlay))) == []


@pytest.mark.parametrize(
    ("terms", "given"),
    [
        (
            {"spherical": "10 nm"},
            ["objective.zernike.11: 0.01 um (spherical) moves rays by less than the"],
        ),
        ({"4": "-6 nm", "11": "4 nm", "piston": "1 um"}, ["objective.zernike.4: -0.006 um"]),
        ({"11": "5 nm"}, []),
    ],
)
def test_an_aberration_that_rays_are_not_to_be_trusted_with_is_remarked_on(
    terms: dict[str, str], given: list[str]
) -> None:
    config = checked({"objective": {"zernike": terms}})
    said = [one for one in plain_remarks(config) if "zernike" in one]
    assert [one[: len(line)] for one, line in zip(said, given, strict=True)] == given
    assert all(one.endswith("compare with tracing.scheme: fullwave") for one in said)
    for other in ({"objective": {"zernike_rays": "phase"}}, {"tracing": {"scheme": "fullwave"}}):
        config = checked({"objective": {"zernike": terms}}, other)
        assert not [one for one in plain_remarks(config) if "zernike" in one]


def test_the_focus_stays_below_what_the_objective_reaches_at_each_wavelength() -> None:
    near = {"objective": {"focus_distance": "4.05 um"}}
    assert not [one for one in impossible(checked(near)) if "focus_distance" in one]
    away = [one for one in impossible(checked(near, shifted())) if "focus_distance" in one]
    (said,) = away
    assert said.startswith("objective.focus_distance: 4.05 um given; it must exceed every focus")
    assert said.endswith(
        "focus_scan.focus.stop asks for one at 4.053795 um, of which objective.focal_shift is "
        "0.053795 um (the objective lies in glass)"
    )


IN_VAIN: list[tuple[dict[str, Any], str, str]] = [
    ({"objective": {"zernike_rays": "phase"}}, "objective.zernike_rays", "phase given, but objective.zernike is not, and nothing else reads it; leave it out, or give objective.zernike"),
    ({"beam": {"wavelength": "755 nm"}}, "beam.wavelength", "755 nm given, but beam.waist is not"),
    ({"detector": {"fibre_na": 0.12}}, "detector.fibre_na", "0.12 given, but detector.falloff: parabolic does not read it; leave it out, or give detector.falloff: fibre"),
    ({"detector": {"mode_field_diameter": "5 um"}}, "detector.mode_field_diameter", "5 um given, but detector.falloff: parabolic does not read it; leave it out, or give detector.falloff: gaussian"),
]  # fmt: skip


@pytest.mark.parametrize(("overlay", "key", "line"), IN_VAIN, ids=[key for _, key, _ in IN_VAIN])
def test_what_of_an_effect_is_given_in_vain_is_said(
    overlay: dict[str, Any], key: str, line: str
) -> None:
    with pytest.warns(OctsimWarning, match="given, but") as caught:
        load_config(overlay)
    (only,) = caught
    assert str(only.message).startswith(f"{key}: {line}")


def test_what_of_an_effect_is_read_is_not_said() -> None:
    config = checked(EVERY)
    asked = {
        "objective.zernike_rays": "phase", "beam.wavelength": "755 nm", "detector.fibre_na": 0.12,
        "detector.falloff": "fibre", "objective.zernike.11": "10 nm",
    }  # fmt: skip
    assert [*unread(config, asked), *unread_scene(config, asked)] == []


def test_units_of_effects_are_known() -> None:
    lengths = (
        "beam.waist", "beam.wavelength", "detector.mode_field_diameter",
        "objective.focal_shift.reference", "interferometer.reference.length",
    )  # fmt: skip
    assert {unit_of(key) for key in lengths} == {"um"}
    assert unit_of("objective.focal_shift.linear") == unit_of("detector.fibre_na") == "1"
    assert nearest_key("interferometer.reference.lenght") == "interferometer.reference.length"


def test_a_grid_varies_effects() -> None:
    config = gridded({"detector.fibre_na": [0.12, 0.13]})
    assert config.grid.varied == {"detector.fibre_na": [0.12, 0.13]}
    with pytest.raises(ConfigError, match=r"grid\.detector\.falloff: 'fiber' given; the nearest"):
        gridded({"detector.falloff": ["fibre", "fiber"]})
