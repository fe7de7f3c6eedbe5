"""Which keys of a config a dataset depends on, and so what an edit makes anew."""

import pytest
from checkout import GIVEN, TINY, merged
from edits import EDITS, EVERYTHING, edit_of
from gridded import gridded

from octsim.config.derive import parts_of
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.config.scheme import light_keys
from octsim.datasets import keys
from octsim.datasets.catalog import CATALOG
from octsim.datasets.gallery import figures_of
from octsim.datasets.keys import differing, inputs_of, jobs_of, keys_read, stage_axes, stages_of
from octsim.datasets.stage import Stage


@pytest.mark.parametrize(
    ("key", "stages"),
    [
        ("processing.window", {"fourier", "phase_slope"}),
        ("spectrum.wavelength.min", {
            "focus_scan", "focus_sweep", "gaussian_fits", "focus_law", "spectra", "paths",
            "fourier", "phase_slope"}),
        ("focus_scan.diameter", {"focus_scan"}),
        ("focus_law.fraction.num", {"focus_sweep", "gaussian_fits", "focus_law"}),
        ("scene.gap", set(stages_of(load_config()))),
        ("tracing.accuracy", set()),
    ],
)  # fmt: skip
def test_a_stage_has_the_axes_of_the_keys_it_depends_on(key: str, stages: set[str]) -> None:
    values = {
        "processing.window": ["hann", "boxcar"], "spectrum.wavelength.min": ["650 nm", "700 nm"],
        "focus_scan.diameter": ["1 um", "2 um"], "focus_law.fraction.num": [9, 11],
        "scene.gap": ["1 nm", "5 nm"], "tracing.accuracy": [1e-3, 1e-4],
    }  # fmt: skip
    config = gridded({key: values[key]}, GIVEN)
    assert {stage for stage in stages_of(config) if stage_axes(stage, config)} == stages


def test_stages_whose_datasets_have_the_same_axes_are_together() -> None:
    config = gridded(
        {"scene.gap": ["1 nm", "5 nm"], "processing.window": ["hann", "boxcar"]}, GIVEN
    )
    asked = ("detections", "fourier", "spectra", "phase_slope")
    found = keys.with_the_same_axes(asked, config)
    assert found == [["detections", "spectra"], ["fourier", "phase_slope"]]
    assert keys.with_the_same_axes(asked, load_config(GIVEN)) == [list(asked)]


def made_anew(before: Config, after: Config) -> set[str]:
    """Return the jobs of a run that an edit makes anew, where all was made before it."""

    def read(row: Stage, config: Config) -> dict[str, object]:
        return dict(parts_of(config.to_dict(), *keys_read(row.name, config)))

    names, anew = set[str](), set[str]()
    for job, rows in jobs_of(after).items():
        sources = {name for row in rows for name in inputs_of(row, after)}
        if sources & names or any(read(row, before) != read(row, after) for row in rows):
            anew.add(job)
            names |= {row.name for row in rows}
    drawn = {name for sources in figures_of(after).values() for name in sources}
    return anew | ({"figures"} if drawn & names else set())


@pytest.mark.parametrize("key", EDITS)
def test_an_edit_makes_anew_only_what_follows_from_the_key(key: str) -> None:
    _, with_law, with_focus = EDITS[key]
    if key == "run":  # another run, of which nothing is there, and no part of what a stage reads
        with_law = with_focus = set()
    for given, expected in (({}, with_law), (GIVEN, with_focus)):
        plain = merged(TINY, given)
        edited = merged(plain, edit_of(key))
        assert made_anew(load_config(plain), load_config(edited)) == expected
    assert expected <= EVERYTHING


def test_an_expansion_is_by_a_calibration_or_where_more_is_fitted_by_responses() -> None:
    bands = [["650 nm", "760 nm"], ["760 nm", "900 nm"]]
    more = load_config({"expansion": {"fit": ["diameter", "gap"], "bands": bands}})
    one = load_config({"expansion": {"bands": bands}})
    row = CATALOG["expansion"]
    assert inputs_of(row, Config()) == ("calibration",)
    assert inputs_of(row, more) == inputs_of(row, one) == ("responses",)


def test_an_expansion_is_of_measured_spectra_where_they_are_given() -> None:
    row, spectra = CATALOG["expansion"], {"measured": {"spectra": "of_ours.csv"}}
    series = load_config({"expansion": {"series": "of_ours.csv"}})
    matched = load_config(spectra, {"expansion": {"slope": "match"}})
    assert inputs_of(row, load_config(spectra)) == ("calibration", "measured")
    assert inputs_of(row, series) == ("calibration",)
    assert inputs_of(row, matched) == ("calibration", "measured", "match")


def test_where_a_key_that_decides_is_varied_what_each_of_its_values_reads_counts() -> None:
    plain = [load_config(GIVEN, {"tracing": {"scheme": one}}) for one in ("vogel", "paths")]
    varied = gridded({"tracing.scheme": ["vogel", "paths"]}, GIVEN)
    for keys_of in (keys_read, keys.keys_behind):
        each = [set(keys_of("detections", one)) for one in plain]
        assert set(keys_of("detections", varied)) == each[0] | each[1]
        assert "tracing.rays" in each[0] - each[1]
        assert "tracing.accuracy" in each[1] - each[0]


@pytest.mark.parametrize(
    ("edit", "of_detections", "of_slopes"),
    [
        ({}, [], []),
        ({"processing": {"window": "boxcar"}}, [], ["processing"]),
        (
            {"scene": {"gap": "7 nm"}, "processing": {"window": "boxcar"}},
            ["scene"], ["scene", "processing"],
        ),
        ({"grid": {"processing.window": ["hann", "boxcar"]}}, [], [
            "grid.processing.window", "grid.combine"]),
    ],
)  # fmt: skip
def test_keys_are_named_in_which_another_config_differs_for_a_dataset(
    edit: dict[str, object], of_detections: list[str], of_slopes: list[str]
) -> None:
    other = load_config(GIVEN, edit).to_dict()
    assert differing("detections", load_config(GIVEN), other) == of_detections
    assert differing("phase_slope", load_config(GIVEN), other) == of_slopes


@pytest.mark.parametrize("combine", ["product", "zip"])
def test_of_many_indices_the_keys_are_found_once_and_one_that_disperses_counts(
    combine: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Config] = []

    def counted(config: Config) -> tuple[str, ...]:
        asked.append(config)
        return light_keys(config)

    monkeypatch.setattr(keys, "light_keys", counted)
    index = "scene.refractive_index.neuron"

    def behind(*indices: object) -> set[str]:
        grid = {"combine": combine, index: [*indices]}
        return set(keys.keys_behind("detections", load_config(GIVEN, {"grid": grid})))

    plain, few = behind(1.36), len(asked)
    asked.clear()
    assert behind(*(1.36 + number / 1000 for number in range(20))) == plain
    assert len(asked) == few
    assert "spectrum" not in plain
    assert "spectrum" in behind(1.36, {"cauchy": [1.35, 0.003]})


def test_of_many_foci_that_are_given_the_keys_are_found_once_and_a_law_counts() -> None:
    lines = [{"slope": 0.58, "intercept": f"{60 + number} nm"} for number in range(20)]

    def behind(*foci: object) -> set[str]:
        indices = [1.36 + number / 1000 for number in range(len(foci))]
        grid = {"combine": "zip", "sweep.focus": [*foci], "scene.refractive_index.neuron": indices}
        config = load_config({"grid": grid})
        assert len(keys._kinds(config)) == len({one == "law" for one in foci})
        return set(keys.keys_behind("detections", config))

    assert behind(*lines) == behind(lines[0]) < behind("law")
    assert behind("law", *lines) == behind("law")
