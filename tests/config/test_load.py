"""The config: what is refused and with which words, what merges, and what agrees with what."""

import json
import warnings
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from octsim.base.errors import ConfigError, OctsimWarning
from octsim.config.derive import parts_of
from octsim.config.following import fitted_diameters
from octsim.config.grid import remarks
from octsim.config.known_keys import known_keys
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.units import format_length, parse_length
from octsim.schemes.table import PRESETS

ROOT = Path(__file__).parents[2]

BAD: list[tuple[dict[Any, Any], str]] = [
    # unknown keys, with the nearest known one
    ({"objective": {"na": 1.1}}, "objective.na: unknown key; the nearest known one is objective.numerical_aperture"),
    ({"objective": {"numerical_apperture": 1.1}}, "nearest known one is objective.numerical_aperture"),
    ({"objectve": {}}, "objectve: unknown key; the nearest known one is objective"),
    ({"gap": "5 nm"}, "gap: unknown key; the nearest known one is scene.gap"),
    ({"sweep": {"focus": {"slop": 1, "intercept": "1 nm"}}}, "nearest known one is sweep.focus.slope"),
    # lengths
    ({"scene": {"gap": 5}}, "scene.gap: 5 given; a length needs its unit"),
    ({"scene": {"gap": "5"}}, "scene.gap: '5' given; a length needs its unit"),
    ({"scene": {"gap": "5 kg"}}, "scene.gap: '5 kg' given; 'kg' is not a unit of length"),
    ({"scene": {"gap": "5 nn"}}, "scene.gap: '5 nn' given; 'nn' is not a unit that is known"),
    ({"scene": {"gap": "five nm"}}, "scene.gap: 'five nm' given; not a length"),
    ({"scene": {"gap": "1e999 m"}}, "'1e999 m' given; it should be less than or equal to 1000000 um"),
    ({"scene": {"gap": "1e9999999 m"}}, "far out of range"),
    ({"scene": {"gap": "5 nan"}}, "scene.gap: '5 nan' given; 'nan' is not a unit that is known"),
    ({"scene.gap": "5 nm"}, "scene.gap: unknown key; keys nest, so write scene: {gap: ...}"),
    ({"sweep": {"focus": {"law": 1, "slope": 0, "intercept": "1 um"}}}, "sweep.focus.law: unknown key"),
    ({"spectrum": {"wavelength": {"min": "1e-320 um"}}}, "it should be greater than or equal to 0.001 um"),
    ({"scene": {"gap": None}}, "scene.gap: null given; not a length"),
    ({"scene": {"gap": "-1 nm"}}, "scene.gap: '-1 nm' given; it should be greater than or equal to 0 um"),
    ({"detector": {"core_diameter": "0 um"}}, "it should be greater than or equal to 0.000001 um"),
    ({"focus_scan": {"diameter": "0 um"}}, "focus_scan.diameter: '0 um' given"),
    ({"sweep": {"diameters": {"start": "0 um"}}}, "sweep.diameters.start: '0 um' given"),
    # types
    ({"scene": None}, "scene: null given; it should be a mapping"),
    ({"sweep": {"diameters": [1, "2 um"]}}, "sweep.diameters.0: 1 given; a length needs its unit"),
    ({"tracing": {"rays": "3000"}}, "tracing.rays: '3000' given; it should be a whole number"),
    ({"tracing": {"rays": 1.5}}, "tracing.rays: 1.5 given; it should be a whole number"),
    ({"tracing": {"rays": True}}, "tracing.rays: true given"),
    ({"objective": {"numerical_aperture": "wide"}}, "objective.numerical_aperture: 'wide' given"),
    ({"objective": {"magnification": float("nan")}}, "objective.magnification: nan given"),
    ({"processing": {"window": "hammin"}}, "processing.window: 'hammin' given; the nearest that is known is 'hamming'; it should be"),
    ({"tracing": {"scheme": "grid"}}, "tracing.scheme: 'grid' given; the nearest that is known is 'vogel'"),
    ({"sweep": {"focus": "best"}}, "sweep.focus: 'best' given; it should be 'law', or {slope"),
    ({"sweep": {"focus": {"slope": 0.5}}}, "sweep.focus.intercept: missing"),
    ({3: 4}, "3 given as a key; keys are names, such as scene"),
    ({"calibration": {"step": "1 um"}}, "calibration.step: '1 um' given; it should be less than or equal to 0.01 um"),
    ({"calibration": {"tolerances": {"index": 1}}}, "calibration.tolerances.index: unknown key"),
    ({"calibration": {"tolerances": {"scene": {"gap": "1 nm"}}}}, "calibration.tolerances.scene: unknown key; keys of the scene don't nest here, so write scene.cylinders.0.x: 50 nm"),
    ({"calibration": {"tolerances": {"scene.cylinder.0.azimut": "1 deg"}}}, "calibration.tolerances.scene.cylinder.0.azimut: 0.017453292519943295 rad given, but scene.cylinder.0.azimut is no number of this scene; the nearest that is one is scene.cylinders.0.azimuth"),
    ({"calibration": {"tolerances": {"scene.cylinders.0.medium": 0.1}}}, "scene.cylinders.0.medium is no number of this scene; the nearest that is one is scene.cylinders.0.diameter, of which diameter is the tolerance"),
    ({"calibration": {"tolerances": {"scene.cylinders.0.azimuth": "1 nm"}}}, "calibration.tolerances.scene.cylinders.0.azimuth: 0.001 um given, which is not an angle; write it with its unit, such as 30 deg or 0.5 rad"),
    ({"calibration": {"tolerances": {"scene.cylinders.0.azimuth": 0.1}}}, "0.1 given, which is not an angle; write it with its unit"),
    ({"calibration": {"tolerances": {"scene.cylinders.0.azimuth": "-1 deg"}}}, "calibration.tolerances.scene.cylinders.0.azimuth: '-1 deg' given; it should be from 0"),
    ({"calibration": {"tolerances": {"scene.cylinders.0.azimuth": "1 s"}}}, "'1 s' given; it should be a length or an angle with its unit"),
    ({"calibration": {"tolerances": {"scene.gap": "1 nm"}}}, "calibration.tolerances.scene.gap: 0.001 um given, but that is what calibration.tolerances.gap is of; give that one instead"),
    ({"calibration": {"tolerances": {"scene.cylinders.0.x": "50 nm"}}}, "but that is what calibration.tolerances.offset is of"),
    ({"calibration": {"tolerances": {"scene.refractive_index.neuron": 0.002}}}, "but that is what calibration.tolerances.neuron is of"),
    ({"calibration": {"tolerances": {"scene.attenuation.neuron": "1 nm"}}, "scene": {"attenuation": {"neuron": "1 /cm"}}}, "0.001 um given, which is not an attenuation; write it with its unit, such as 100 /cm"),
    ({"calibration": {"tolerances": {"scene.refractive_index.myelin": "5 nm"}}, "scene": {"refractive_index": {"myelin": 1.44}, "cylinders": [{"medium": "neuron", "shells": [{"medium": "myelin", "thickness": "5 nm"}]}]}}, "0.005 um given, which is no index; write a number, such as 0.005"),
    ({"calibration": {"tolerances": {"scene.refractive_index.myelin": 0.005}}}, "scene.refractive_index.myelin is no number of this scene"),
    ({"expansion": {"series": 5}}, "expansion.series: 5 given"),
    ({"expansion": {"outliers": "dropp"}}, "expansion.outliers: 'dropp' given; the nearest that is known is 'drop'"),
    ({"expansion": {"drift": "square"}}, "expansion.drift: 'square' given; it should be 'none', 'linear' or {reference:"),
    ({"expansion": {"drift": {"reference": [[200, 181]]}}}, "expansion.drift.reference.0: [200, 181] given; it should be"),
    ({"expansion": {"drift": {"reference": []}}}, "expansion.drift.reference: [] given; it should be"),
    # what an archive says of itself
    ({"archive": {"date": "2026-1-1"}}, "archive.date: '2026-1-1' given; it should be a day as 2026-01-31"),
    ({"archive": {"date": "2026-02-30"}}, "archive.date: '2026-02-30' given; it should be a day"),
    ({"archive": {"date": 20260101}}, "archive.date: 20260101 given; it should be a day"),
    ({"archive": {"license": "mine"}}, "archive.license: 'mine' given; it should be one SPDX id"),
    ({"archive": {"license": "MIT OR CC0-1.0"}}, "it should be one SPDX id"),
    ({"archive": {"license": "LicenseRef-mine"}}, "it should be one SPDX id"),
    ({"archive": {"creators": "Ada Ray"}}, "archive.creators: 'Ada Ray' given; it should be a list"),
    ({"archive": {"creators": [{"orcid": None}]}}, "archive.creators.0.name: missing"),
    ({"archive": {"creators": [{"name": "A", "orchid": "x"}]}}, "archive.creators.0.orchid: unknown key; the nearest known one is archive.creators.orcid"),
    ({"archive": {"creators": [{"name": "A", "orcid": "0000-0002-1825-009"}]}}, "archive.creators.0.orcid: '0000-0002-1825-009' given; it should be an ORCID iD"),
    ({"archive": {"creators": [{"name": "A", "orcid": "0000-0002-1825-0079"}]}}, "its last digit does not fit the others"),
    ({"archive": {"title": "a\nb"}}, "archive.title: 'a\\nb' given; it should be one line of text"),
    ({"archive": {"title": ["a", "b"]}}, "archive.title: [a, b] given; it should be a valid string"),
    # ranges and what is impossible
    ({"calibration": {"diameters": {"num": 3}}}, "it should be greater than or equal to 8"),
    ({"tracing": {"rays": 0}}, "tracing.rays: 0 given; it should be greater than or equal to 1"),
    ({"tracing": {"min_amplitude": 1}}, "tracing.min_amplitude: 1 given; it should be less than 1"),
    ({"spectrum": {"samples": 1}}, "spectrum.samples: 1 given"),
    ({"sweep": {"diameters": {"num": 1}}}, "sweep.diameters.num: 1 given"),
    ({"focus_law": {"fraction": {"num": 3}}}, "focus_law.fraction.num: 3 given"),
    ({"focus_law": {"diameters": {"num": 1}}}, "focus_law.diameters.num: 1 given"),
    ({"scene": {"refractive_index": {"glass": 0.9}}}, "scene.refractive_index.glass: 0.9 given"),
    ({"objective": {"numerical_aperture": 1.52}}, "objective.numerical_aperture: 1.52 given; it must be below the index of glass"),
    ({"scene": {"refractive_index": {"glass": 1.1}}}, "objective.numerical_aperture: 1.2 given; it must be below"),
    ({"spectrum": {"wavelength": {"min": "900 nm"}}}, "spectrum.wavelength.min: 0.9 um given; it must be below"),
    ({"sweep": {"diameters": {"start": "3 um"}}}, "sweep.diameters.start: 3.0 um given; it must be below sweep.diameters.stop = 2.0 um"),
    ({"focus_law": {"fraction": {"start": 0.8}}}, "focus_law.fraction.start: 0.8 given; it must be below"),
    ({"objective": {"focus_distance": "4 um"}}, "objective.focus_distance: 4.0 um given; it must exceed every focus, and focus_scan.focus.stop"),
    ({"focus_law": {"fraction": {"stop": 200.0}}}, "and focus_law.fraction.stop asks for one at 480 um"),
    ({"sweep": {"focus": {"slope": 0, "intercept": "1 mm"}}}, "and sweep.focus asks for one at 1000 um"),
    ({"run": "../elsewhere"}, "run: '../elsewhere' given; it should be a plain name as text"),
    ({"run": ".hidden"}, "run: '.hidden' given; it should be a plain name as text"),
    ({"run": "x" * 101}, "' given; it should be a plain name as text: letters, digits, '.', '_' and '-', no path, 100 at most"),
    ({"expansion": {"diameter": ["1 um", "2 um"]}}, "expansion.diameter: [1 um, 2 um] given; not a length"),
    ({"run": ["a"]}, "run: [a] given; it should be a plain name as text"),
    ({"run": ""}, "run: '' given; it should be a plain name as text"),
    ({"run": 20240601}, "put it in quotes in a config file, or write --config 'run=!!str NAME' on the command line"),
    ({"tracing": {"rays": "3000"}}, "it should be a whole number, written out as digits and without quotes, in a config file"),
    ({"objective": {"magnification": "20"}}, "it should be a number, written out as digits and without quotes, in a config file"),
]  # fmt: skip


@pytest.mark.parametrize(("overlay", "message"), BAD, ids=[message[:50] for _, message in BAD])
def test_a_bad_config_is_refused_with_its_key_value_and_remedy(
    overlay: dict[str, Any], message: str
) -> None:
    with pytest.raises(ConfigError) as caught:
        load_config(overlay)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value).replace("\nsweep.focus.slop", " sweep.focus.slop")


def test_every_problem_gets_its_line() -> None:
    with pytest.raises(ConfigError) as caught:
        load_config({"scene": {"gap": 5}, "tracing": {"rays": 0}, "colour": "blue"})
    assert len(str(caught.value).splitlines()) == 3


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: : b", r", line 1, column 4: not as YAML should be: "),
        ("- 1", "holds a list, not keys with values"),
        ("archive: {date: 2026-13-01}", "2026-13-01 is no date that there is"),
        ("scene: {gap: 1 nm}\nscene: {gap: 2 nm}", "the key 'scene' stands twice"),
    ],
)
def test_a_bad_file_is_refused_in_one_line(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError, match=message) as caught:
        load_config(file)
    assert str(caught.value).startswith(str(file))
    assert "\n" not in str(caught.value)


def test_a_missing_or_binary_file_is_refused_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"none\.yaml: can't be read \(No such file"):
        load_config(tmp_path / "none.yaml")
    (tmp_path / "x.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ConfigError, match="it is not text"):
        load_config(tmp_path / "x.yaml")


def test_overlays_merge_deeply_and_the_last_wins() -> None:
    config = load_config(
        {"sweep": {"diameters": {"num": 11}}, "scene": {"gap": "1 nm"}},
        {"scene": {"gap": "0.02 um"}, "sweep": {"focus": {"slope": 0, "intercept": "1 um"}}},
        {"sweep": {"focus": {"slope": 0.5}}},
    )
    assert (config.sweep.diameters.start, config.sweep.diameters.num) == (1.0, 11)
    assert config.scene.gap == 0.02
    assert config.sweep.focus.slope == 0.5  # type: ignore[union-attr]
    assert config.sweep.focus.intercept == 1.0  # type: ignore[union-attr]


def test_an_overlay_can_go_back_to_the_law() -> None:
    line = {"sweep": {"focus": {"slope": 0, "intercept": "1 um"}}}
    assert load_config(line, {"sweep": {"focus": "law"}}) == load_config()


def test_numbers_in_yaml_may_have_an_exponent_without_a_dot(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text("tracing: {min_amplitude: 1e-6}\nobjective: {magnification: 2e1}\n")
    assert load_config(file).tracing.min_amplitude == 1e-6


def test_yaml_may_reuse_parts(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text(
        "focus_law: {diameters: &few {start: 1 um, stop: 2 um, num: 5}}\n"
        "sweep: {diameters: {<<: *few, num: 11}}\n"
    )
    assert load_config(file).sweep.diameters.num == 11
    assert fitted_diameters(load_config(file)).num == 5


@given(st.sampled_from(BAD))
def test_a_message_ends_in_words_or_a_bound(case: tuple[dict[Any, Any], str]) -> None:
    with pytest.raises(ConfigError) as caught:
        load_config(case[0])
    assert not str(caught.value).endswith("mm um")


def test_an_empty_overlay_is_the_thesis(tmp_path: Path) -> None:
    (tmp_path / "empty.yaml").write_text("# nothing\n")
    assert load_config(tmp_path / "empty.yaml") == load_config() == Config()


def test_the_resolved_config_reads_back_to_the_same_bits() -> None:
    config = load_config({"scene": {"gap": "1.2345678901234567 nm"}})
    assert load_config(json.loads(json.dumps(config.to_dict()))) == config


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_length_reads_back_to_the_same_bits(length: float) -> None:
    assert parse_length(format_length(length)) == length


def test_equal_lengths_in_different_units_are_the_same_number() -> None:
    assert parse_length("650 nm") == parse_length("0.65 um") == parse_length("6.5e-7 m") == 0.65
    assert parse_length("2 µm") == parse_length("2 μm") == parse_length("2um") == 2.0


def test_what_an_archive_says_is_written_as_the_standards_do(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text(
        "archive:\n  date: 2026-01-31\n  license: cc0-1.0\n  description: >\n    Two\n    lines.\n"
        "  creators: [{name: Josiah, orcid: https://orcid.org/0000-0002-1694-233X}]\n"
    )
    config = load_config(file)
    said = config.archive
    assert (said.date, said.license, said.description) == ("2026-01-31", "CC0-1.0", "Two lines.")
    assert said.creators[0].orcid == "0000-0002-1694-233X"
    assert load_config(config.to_dict()) == config


def test_a_config_is_frozen() -> None:
    with pytest.raises(ValueError, match="frozen"):
        load_config().scene.gap = 1.0  # type: ignore[misc]


def test_a_diameter_step_that_makes_the_phase_ambiguous_is_warned_of() -> None:
    with pytest.warns(OctsimWarning, match=r"a step of 0\.142857 um is above .* = 0\.135762 um"):
        load_config({"sweep": {"diameters": {"num": 8}}})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load_config({"sweep": {"diameters": {"num": 9}}})


@pytest.mark.parametrize(
    ("overlay", "message"),
    [
        (
            {
                "sweep": {
                    "diameters": {"start": "2 nm", "stop": "4 nm"},
                    "focus": {"slope": 1, "intercept": "0 nm"},
                }
            },
            "less than one oscillation",
        ),
        ({"spectrum": {"samples": 5}}, "spectrum.samples: 5 do not resolve .* give 6 or more"),
        ({"sweep": {"diameters": {"stop": "3 um"}}}, "is beyond the diameters that the focus law"),
    ],
)
def test_what_is_likely_not_meant_is_warned_of(overlay: dict[str, Any], message: str) -> None:
    with pytest.warns(OctsimWarning, match=message):
        load_config(overlay)


def test_the_default_config_file_is_the_defaults_and_names_every_key() -> None:
    file = ROOT / "config" / "default.yaml"
    assert load_config(file) == Config()
    written = yaml.safe_load(file.read_text(encoding="utf-8"))

    def keys(part: object, prefix: str = "") -> set[str]:
        if not isinstance(part, dict):
            return set()
        return {prefix + k for k in part}.union(
            *(keys(value, f"{prefix}{k}.") for k, value in part.items())
        )

    optional = {"sweep.focus.slope", "sweep.focus.intercept", "tracing.preset"}
    optional |= {f"archive.creators.{name}" for name in ("name", "orcid", "affiliation")}
    optional |= {"objective.pupil.gaussian", "objective.pupil.fibre"}
    optional |= {f"objective.focal_shift.{name}" for name in ("reference", "linear", "quadratic")}
    optional |= {f"interferometer.reference.{name}" for name in ("amplitude", "length")}
    optional |= {
        key
        for key in known_keys()
        if key.startswith(("scene.cylinders.", "scene.layers.", "design.bands."))
    }
    assert keys(written) == set(known_keys()) - optional


@pytest.mark.parametrize(
    "file", sorted((ROOT / "config" / "examples").glob("*.yaml")), ids=lambda f: f.stem
)
def test_the_examples_are_valid_and_raise_no_remark(file: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert load_config(file).run == file.stem


def test_the_schema_file_is_the_models_schema() -> None:
    schema = json.loads((ROOT / "config" / "schema.json").read_text(encoding="utf-8"))
    assert schema == Config.model_json_schema(), "run `make docs`"


def test_a_preset_fills_in_what_is_not_given() -> None:
    draft = load_config({"tracing": {"preset": "draft"}}).tracing
    assert (draft.scheme, draft.accuracy) == ("paths", PRESETS["draft"]["accuracy"])
    mixed = load_config({"tracing": {"accuracy": 1e-3}}, {"tracing": {"preset": "draft"}}).tracing
    assert (mixed.scheme, mixed.accuracy) == ("paths", 1e-3)
    assert load_config(load_config({"tracing": {"preset": "draft"}}).to_dict()).tracing == draft


def test_a_steep_beam_is_remarked_on_under_the_scheme_paths() -> None:
    steep = {"objective": {"numerical_aperture": 1.3}}
    assert not any(
        "paths" in said for said in remarks(Config.model_validate(load_config(steep).to_dict()))
    )
    with pytest.warns(OctsimWarning, match="'paths' with a numerical aperture of 1.3"):
        load_config(steep, {"tracing": {"scheme": "paths"}})


def test_parts_of_a_config_change_with_the_keys_they_hold_alone() -> None:
    config = load_config()
    moved = load_config({"scene": {"gap": "6 nm"}})
    data, changed = config.to_dict(), moved.to_dict()
    assert parts_of(data, "scene") != parts_of(changed, "scene")
    assert parts_of(data, "scene.refractive_index", "sweep") == parts_of(
        changed, "scene.refractive_index", "sweep"
    )


def test_an_unknown_preset_lists_the_known() -> None:
    with pytest.raises(ConfigError) as said:
        load_config({"tracing": {"preset": "standart"}})
    assert all(name in str(said.value) for name in PRESETS)


def test_off_and_nothing_are_what_yaml_reads_them_as(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text("expansion: {outliers: off, drift: null}\n", encoding="utf-8")
    assert load_config(file) == Config()
    file.write_text("expansion: {drift: {reference: [[181, 200], [1, 3]]}}\n", encoding="utf-8")
    found = load_config(file)
    assert found.expansion.references == ((181, 200), (1, 3))
    assert load_config(found.to_dict()) == found
