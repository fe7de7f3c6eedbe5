"""Two runs side by side: each difference is told by its name and size, and nothing else is."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_rgb

import octsim
from octsim.archive.compare import Comparison, DatasetComparison, VariableComparison
from octsim.archive.compare_conditions import TOLERANCE
from octsim.archive.compare_origins import Change
from octsim.archive.compare_points import blocks, common_points
from octsim.archive.compare_text import lines
from octsim.archive.compare_values import MEASURED, WRAPPED, Deviation, ValueKind, deviation
from octsim.cli.main import main
from octsim.datasets.files import make as dataset_of_stage
from octsim.datasets.files import write
from octsim.datasets.variables import MEANINGS
from octsim.figures.compare import figure_compare
from octsim.figures.style import look

TINY: dict[str, Any] = {
    "run": "tiny",
    "tracing": {"rays": 200},
    "spectrum": {"samples": 64},
    "sweep": {"diameters": {"num": 9}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
}
Edit = Callable[[xr.Dataset], xr.Dataset]


def make(folder: Path, *overlays: dict[str, Any]) -> Path:
    config = octsim.load_config(TINY, *overlays)
    made = {"detections": octsim.detections(config)}
    made["spectra"] = octsim.spectra(config, made["detections"])
    made["paths"] = octsim.light_paths(config, made["detections"])
    made["fourier"] = octsim.fourier(config, made["spectra"])
    made["phase_slope"] = octsim.phase_slope(config, made["fourier"])
    for stage, dataset in made.items():
        write(dataset, folder / f"{stage}.nc")
    return folder


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make(tmp_path_factory.mktemp("tiny"))


@pytest.fixture
def edited(tiny: Path, tmp_path: Path) -> Callable[[str, Edit], Path]:
    """Copy the run and edit one of its datasets."""

    def edited(stage: str, edit: Edit) -> Path:
        folder = tmp_path / "edited"
        shutil.copytree(tiny, folder)
        with xr.open_dataset(folder / f"{stage}.nc") as stored:
            dataset = edit(stored.load())
        write(dataset, folder / f"{stage}.nc")
        return folder

    return edited


def replaced(name: str, change: Callable[[Any], Any]) -> Edit:
    def edit(dataset: xr.Dataset) -> xr.Dataset:
        values = change(dataset[name].values.copy())
        return dataset.assign({name: dataset[name].copy(data=values)})

    return edit


def at(place: tuple[int, ...], value: Any) -> Callable[[Any], Any]:
    def change(values: Any) -> Any:
        values[place] = value(values[place]) if callable(value) else value
        return values

    return change


def differing(found: Comparison) -> dict[str, VariableComparison]:
    return {
        f"{dataset.stage}.{variable.name}": variable
        for dataset in found.datasets
        for variable in dataset.variables
        if variable.differs(found.tolerance)
    }


def dataset_of(found: Comparison, stage: str) -> DatasetComparison:
    return next(one for one in found.datasets if one.stage == stage)


def test_a_run_is_the_same_as_itself(tiny: Path) -> None:
    found = octsim.compare(tiny, tiny, 0.0)
    assert not found.differs
    assert (found.config, found.versions, found.missing) == ((), (), ((), ()))
    assert len(found.datasets) == 5
    assert all(v.deviation.values > 0 for one in found.datasets for v in one.variables)


def test_a_config_edit_is_told_first_with_its_keys_and_units(tiny: Path, tmp_path: Path) -> None:
    law: dict[str, Any] = {"sweep": {"focus": {"slope": 0.5, "intercept": "0.1 um"}}}
    other = make(tmp_path, {"run": "wide", "scene": {"gap": "20 nm"}}, law)
    found = octsim.compare(tiny, other)
    assert found.config == (
        Change("run", "tiny", "wide"),
        Change("scene.gap", "0.005 um", "0.02 um"),
        Change("sweep.focus.slope", "0.58", "0.5"),
        Change("sweep.focus.intercept", "0.069 um", "0.1 um"),
    )
    assert found.versions == ()
    assert {"spectra.intensity", "phase_slope.mean_phase_slope"} <= set(differing(found))
    said = list(lines(found))
    headings = ["config, A -> B", "versions, A -> B", "what it comes to"]
    places = [next(i for i, one in enumerate(said) if one.startswith(h)) for h in headings]
    assert places == sorted(places)
    assert said[places[0] + 2] == "  scene.gap: 0.005 um -> 0.02 um"
    row = next(one.split() for one in said if one.startswith("phase_slope mean_phase_slope"))
    both = [float(octsim.read(run / "phase_slope.nc")["mean_phase_slope"]) for run in (tiny, other)]
    assert [float(cell) for cell in row[3:5]] == pytest.approx(both, rel=1e-5)


def test_another_config_alone_is_no_difference(
    tiny: Path, edited: Callable[[str, Edit], Path]
) -> None:
    def renamed(dataset: xr.Dataset) -> xr.Dataset:
        config = json.loads(dataset.attrs["config"]) | {"run": "other"}
        return dataset.assign_attrs(config=json.dumps(config))

    folder = edited("phase_slope", renamed)
    found = octsim.compare(tiny / "phase_slope.nc", folder / "phase_slope.nc")
    assert found.config == (Change("run", "tiny", "other"),)
    assert not found.differs


def test_one_bit_of_one_value_is_told_by_name_and_size(
    tiny: Path, edited: Callable[[str, Edit], Path]
) -> None:
    nudged = at((3, 10), lambda value: np.nextafter(value, 1.0))
    folder = edited("spectra", replaced("intensity", nudged))
    found = octsim.compare(tiny, folder, 0.0)
    assert set(differing(found)) == {"spectra.intensity"}
    intensity = octsim.read(tiny / "spectra.nc")["intensity"].values
    value = intensity[3, 10]
    relative = found.datasets[-1].variables[0].deviation.relative
    assert relative == (np.nextafter(value, 1.0) - value) / intensity.max()
    assert 0 < relative < 2.3e-16
    assert f"*   intensity        {relative:.2e}" in list(lines(found))
    assert not octsim.compare(tiny, folder).differs


@pytest.mark.parametrize(
    ("stage", "name", "change", "told"),
    [
        ("fourier", "magnitude", at((1, 1), np.nan), "NaN at 1 of 297 places"),
        ("spectra", "intensity", at((0, 0), np.inf), "NaN at 1 of 576 places"),
        ("phase_slope", "strongest_component", at((4,), 9), "1 of 9 not equal"),
        ("detections", "path_code", at((7,), 1), "1 of "),
        ("spectra", "accuracy_status", at((2,), 1), "1 of 9 not equal"),
        ("spectra", "intensity", lambda v: v.astype(np.float32), "type float64 -> float32"),
        ("phase_slope", "strongest_component", lambda v: v.astype(np.int32), "type int64 -> int32"),
    ],
)
def test_what_has_to_be_equal_and_is_not_is_told_whatever_the_tolerance(
    stage: str,
    name: str,
    change: Callable[[Any], Any],
    told: str,
    tiny: Path,
    edited: Callable[[str, Edit], Path],
) -> None:
    found = octsim.compare(tiny, edited(stage, replaced(name, change)), 1e9)
    assert set(differing(found)) == {f"{stage}.{name}"}
    (said,) = [line for line in lines(found) if line.startswith("*")]
    assert said.split()[1] == name
    assert told in said


def test_nan_that_moves_is_told(tiny: Path, edited: Callable[[str, Edit], Path]) -> None:
    phases = octsim.read(tiny / "paths.nc")["field_phase"]
    assert phases.isnull().any()
    folder = edited("paths", replaced("field_phase", lambda values: np.roll(values, 1, axis=1)))
    found = octsim.compare(tiny, folder, 1e9)
    moved = (phases.isnull() != np.roll(phases.isnull(), 1, axis=1)).sum()
    assert differing(found)["paths.field_phase"].deviation.misplaced == int(moved) > 0


@pytest.mark.parametrize(("stage", "name"), [("fourier", "phase"), ("paths", "field_phase")])
def test_phases_are_compared_but_for_whole_turns(
    stage: str, name: str, tiny: Path, edited: Callable[[str, Edit], Path]
) -> None:
    def across(values: Any) -> Any:
        assert (values > 2.9).any()
        return np.where(values > 2.9, values - 2 * np.pi + 1e-6, values)

    found = octsim.compare(tiny, edited(stage, replaced(name, across)), 1e-12)
    relative = differing(found)[f"{stage}.{name}"].deviation.relative
    assert relative == pytest.approx(1e-6 / np.pi, rel=0.15)


def test_zero_is_as_far_from_something_as_can_be() -> None:
    values = np.zeros(3), np.array([0.0, 1e-300, 0.0])
    assert deviation([values], ValueKind.NUMBER).relative == 1.0
    assert deviation([values[::-1]], ValueKind.NUMBER).relative == np.inf
    assert deviation([(values[0], values[0])], ValueKind.NUMBER) == Deviation(values=3)


def test_missing_variables_datasets_and_other_dimensions_are_named(
    tiny: Path, edited: Callable[[str, Edit], Path]
) -> None:
    def edit(dataset: xr.Dataset) -> xr.Dataset:
        less = dataset.drop_vars("intensity_error").rename_dims(wavenumber="colour")
        return less.assign(hue=dataset["focus"].assign_attrs(units="1"))

    folder = edited("spectra", edit)
    (folder / "paths.nc").unlink()
    found = octsim.compare(tiny, folder)
    assert found.missing == ((), ("paths",))
    assert dataset_of(found, "spectra").missing == (("hue",), ("intensity_error",))
    assert differing(found)["spectra.intensity"].unlike == (
        "dimensions (diameter, wavenumber) -> (diameter, colour)"
    )
    said = "\n".join(lines(found))
    assert "* paths.nc: missing in B" in said
    assert "*   hue: missing in A" in said
    assert "*   intensity_error: missing in B" in said
    # of one file, and not of a run, nothing else is asked
    alone = octsim.compare(tiny / "fourier.nc", folder)
    assert [one.stage for one in alone.datasets] == ["fourier"]
    assert not alone.differs


def test_other_diameters_are_compared_where_both_have_them(tiny: Path, tmp_path: Path) -> None:
    finer = make(tmp_path, {"sweep": {"diameters": {"num": 17}}})
    found = octsim.compare(tiny, finer, 0.0)
    assert found.config == (Change("sweep.diameters.num", "9", "17"),)
    assert found.differs
    unshared = {(one.stage, u.dimension): u for one in found.datasets for u in one.unshared}
    assert unshared["spectra", "diameter"][1:] == (9, (9, 17))
    assert "*   diameter: compared at 9 of 9 (A) and 17 (B)" in list(lines(found))
    # the light of a diameter does not depend on the others: rays, spectra and phases are the same
    apart = {key.split(".")[0] for key in differing(found)}
    assert apart == {"phase_slope"}
    rays = unshared["detections", "ray"]
    assert rays.common == rays.sizes[0] < rays.sizes[1]


def test_rays_are_those_of_the_same_diameters(tiny: Path, tmp_path: Path) -> None:
    other = make(tmp_path, {"sweep": {"diameters": {"start": "1.5 um", "num": 5}}})
    found = octsim.compare(other, tiny, 0.0)
    detections = dataset_of(found, "detections")
    counts = octsim.read(tiny / "detections.nc")["rays_detected"].values
    (rays,) = [one for one in detections.unshared if one.dimension == "ray"]
    assert rays.common == counts[4:].sum()
    assert not any(v.differs(0.0) for v in detections.variables)


def test_points_that_have_not_as_many_rays_are_counted_and_left_out(
    tiny: Path, edited: Callable[[str, Edit], Path]
) -> None:
    def edit(dataset: xr.Dataset) -> xr.Dataset:
        counts = dataset["rays_detected"].values.copy()
        counts[2] -= 1
        kept = np.delete(np.arange(dataset.sizes["ray"]), counts[:2].sum())
        return replaced("rays_detected", lambda _: counts)(dataset.isel(ray=kept))

    found = octsim.compare(tiny, edited("detections", edit), 0.0)
    detections = dataset_of(found, "detections")
    assert detections.uneven == 1
    # rays behind those that were left out still meet their own
    assert set(differing(found)) == {"detections.rays_detected"}


def test_nothing_in_common_is_said(tiny: Path, tmp_path: Path) -> None:
    other = make(tmp_path, {"sweep": {"diameters": {"start": "3 um", "stop": "3.1 um", "num": 5}}})
    found = octsim.compare(tiny / "spectra.nc", other)
    assert differing(found)["spectra.intensity"].unlike == "no diameter in common"
    with pytest.raises(octsim.DatasetError, match=r"no dataset in common \(paths and spectra\)"):
        octsim.compare(tiny / "paths.nc", tiny / "spectra.nc")


GRID = {"run": "grid", "grid": {"scene.gap": ["5 nm", "20 nm"], "tracing.rays": [200, 220]}}


def test_grids_are_compared_at_the_combinations_that_both_have(tmp_path: Path) -> None:
    wider: dict[str, Any] = {"grid": {"scene.gap": ["0 nm", "20 nm", "5 nm"]}}
    one = make(tmp_path / "one", GRID)
    other = make(tmp_path / "other", GRID, wider)
    found = octsim.compare(one, other, 0.0)
    assert found.config == (
        Change("grid.scene.gap", "[0.005 um, 0.02 um]", "[0.0 um, 0.02 um, 0.005 um]"),
    )
    assert differing(found) == {}
    for dataset in found.datasets:
        shared = {u.dimension: (u.common, u.sizes) for u in dataset.unshared}
        assert shared.pop("gap") == (2, (2, 3))
        assert set(shared) <= {"ray", "path"}


def test_zipped_grids_are_compared_row_by_row(tmp_path: Path) -> None:
    zipped = {"grid": {"combine": "zip"}}
    swapped = {"grid": {"scene.gap": ["20 nm", "5 nm"], "tracing.rays": [220, 230]}}
    one = make(tmp_path / "one", GRID, zipped)
    other = make(tmp_path / "other", GRID, zipped, swapped)
    found = octsim.compare(one, other, 0.0)
    assert differing(found) == {}
    slopes = dataset_of(found, "phase_slope")
    assert [u[:2] for u in slopes.unshared] == [("combination", 1)]
    assert found.scalars == ()


def test_combinations_with_diameters_of_their_own_are_compared(tmp_path: Path) -> None:
    grid = {"grid": {"sweep.diameters.num": [5, 9]}}
    longer = {"grid": {"sweep.diameters.num": [5, 9, 17]}}
    one = make(tmp_path / "one", grid)
    other = make(tmp_path / "other", longer)
    found = octsim.compare(one, other, 0.0)
    assert differing(found) == {}
    assert found.differs


def test_blocks_hold_every_shared_value_once() -> None:
    rows = np.arange(9000.0)
    one = xr.Dataset({"a": (("x", "y"), rows[:, None] * np.ones(1000))}, {"x": rows})
    other = one.isel(x=slice(None, None, -3), y=slice(0, 700))
    common, _ = common_points(one, other)
    parts = list(blocks(one["a"].variable, other["a"].variable, common))
    assert len(parts) > 1
    assert max(part.nbytes for pair in parts for part in pair) <= 16e6
    first, second = (np.concatenate(side) for side in zip(*parts, strict=True))
    np.testing.assert_array_equal(first, second)
    assert sorted(first[:, 0]) == sorted(other["x"].values)
    assert first.shape[1] == 700


def measured(cost: float, segments: float) -> xr.Dataset:
    """Return a trade-off of two settings that cost so much."""
    columns: dict[str, Any] = {
        "cpu_seconds": np.array([cost, 2 * cost]),
        "peak_memory": np.array([cost, 1.0]),
        "phase_slope_frontier": np.array([1, cost < 2], np.int8),
        "segments_per_diameter": np.array([segments, 10.0]),
    }
    return dataset_of_stage(
        "tradeoff",
        octsim.load_config(TINY),
        "Cost",
        {name: ("setting", values) for name, values in columns.items()},
        {"setting": ["rays 1", "rays 2"]},
    )


def test_what_a_clock_gave_is_named_and_never_judged(tmp_path: Path) -> None:
    files = [tmp_path / name / "tradeoff.nc" for name in "abc"]
    for file, costs in zip(files, ((1.0, 5.0), (3.0, 5.0), (1.0, 6.0)), strict=True):
        write(measured(*costs), file)
    found = octsim.compare(files[0], files[1], 0.0)
    assert not found.differs
    said = [line for line in lines(found) if line.endswith("measured, not judged")]
    names = {line.split()[0] for line in said}
    assert names == {"cpu_seconds", "peak_memory", "phase_slope_frontier"}
    found = octsim.compare(files[0], files[2])
    assert set(differing(found)) == {"tradeoff.segments_per_diameter"}


def test_every_time_and_memory_that_has_a_meaning_is_a_measured_one() -> None:
    assert set(MEANINGS) >= MEASURED | WRAPPED
    clocks = {n for n, (unit, text) in MEANINGS.items() if unit == "MiB" or "time to" in text}
    clocks |= {n for n, (unit, _) in MEANINGS.items() if unit == "s"} - {"time"}
    clocks |= {n for n, (_, text) in MEANINGS.items() if "as little time" in text}
    clocks |= {n for n, (_, text) in MEANINGS.items() if text.startswith("processor time of a")}
    assert clocks == MEASURED
    assert {n for n, (_, text) in MEANINGS.items() if "(-pi, pi]" in text} <= WRAPPED


def test_versions_and_libraries_that_differ_are_named(
    tiny: Path, edited: Callable[[str, Edit], Path]
) -> None:
    def edit(dataset: xr.Dataset) -> xr.Dataset:
        environment = json.loads(dataset.attrs["environment"]) | {"numpy": "1.0"}
        return dataset.assign_attrs(
            environment=json.dumps(environment), octsim_version="9\n\x1b[2J", source_digest="0" * 12
        )

    folder = edited("fourier", edit)
    found = octsim.compare(folder, tiny)
    digest = octsim.read(tiny / "fourier.nc").attrs["source_digest"]
    assert set(found.versions) == {
        Change("octsim (fourier)", r"9\n\x1b[2J", octsim.__version__),
        Change("numpy (fourier)", "1.0", np.__version__),
        Change("sources of fourier", "0" * 12, digest),
    }
    assert not found.differs
    alone = octsim.compare(folder / "fourier.nc", tiny / "fourier.nc")
    assert {change.what for change in alone.versions} == {"octsim", "numpy", "sources of fourier"}


def test_a_file_without_an_environment_is_told_in_one_line(
    edited: Callable[[str, Edit], Path], tiny: Path
) -> None:
    def edit(dataset: xr.Dataset) -> xr.Dataset:
        del dataset.attrs["environment"]
        return dataset

    file = edited("spectra", edit) / "spectra.nc"
    assert octsim.compare(file, file).versions == ()
    (change,) = octsim.compare(file, tiny).versions
    assert (change.what, change.first) == ("libraries", "not recorded")
    assert f"numpy {np.__version__}" in change.second


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # where figures go that nobody names


def test_the_figure_is_drawn_in_the_folder_that_one_is_in_unless_none_is_wanted(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = make(tmp_path / "other", {"run": "other", "scene": {"gap": "6 nm"}})
    before = set(tmp_path.iterdir())
    assert main(["compare", str(tiny), str(other), "--no-figure"]) == 1
    assert main(["compare", str(tiny / "spectra.nc"), str(other)]) == 1
    assert "\nfigure: " not in capsys.readouterr().out
    assert set(tmp_path.iterdir()) == before
    assert main(["compare", str(tiny), str(other)]) == 1
    assert capsys.readouterr().out.splitlines()[-1] == "figure: compare_tiny_other.png"
    assert (tmp_path / "compare_tiny_other.png").stat().st_size > 10_000


@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_the_figure_is_drawn_where_it_is_asked_for(
    suffix: str, tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / f"both.{suffix}"
    assert main(["compare", str(tiny), str(tiny), "--figure", str(file)]) == 0
    assert file.stat().st_size > 10_000
    assert capsys.readouterr().out.splitlines()[-1] == f"figure: {file}"


def test_the_figure_has_both_runs_told_apart_in_grey_with_units(tiny: Path) -> None:
    slopes = octsim.read(tiny / "phase_slope.nc")
    with look():
        figure = figure_compare((slopes, slopes), ("one", "x" * 100))
    (axes,) = figure.axes
    one, ideal, prediction, other, _, _ = axes.get_lines()
    np.testing.assert_array_equal(np.asarray(one.get_ydata()), slopes["phase_slope"].values)
    np.testing.assert_array_equal(np.asarray(ideal.get_ydata()), slopes["ideal_phase_slope"])
    assert np.allclose(np.asarray(prediction.get_ydata()), float(slopes["predicted_phase_slope"]))
    lightness = [np.dot(to_rgb(line.get_color()), (0.299, 0.587, 0.114)) for line in (one, other)]
    assert abs(lightness[0] - lightness[1]) > 0.15
    assert one.get_marker() != other.get_marker()
    assert axes.get_xlabel().endswith("(µm)")
    assert axes.get_ylabel() == "Phase slope (mrad/nm)"
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names[0] == "one"
    assert names[3] == "…" + 35 * "x"


def elsewhere(dataset: xr.Dataset) -> xr.Dataset:
    libraries = json.loads(dataset.attrs["environment"]) | {"processor": "another"}
    return dataset.assign_attrs(environment=json.dumps(libraries))


@pytest.mark.parametrize(
    ("stage", "name", "within", "beyond"),
    [
        ("spectra", "intensity", 1e-9, 1e-7),
        ("fourier", "magnitude", 1e-9, 1e-7),
        ("phase_slope", "phase_slope", 1e-10, 1e-6),
        ("phase_slope", "predicted_phase_slope", 1e-13, 1e-11),
    ],
)
def test_another_environment_is_judged_by_the_condition_unless_a_tolerance_is_given(
    stage: str, name: str, within: float, beyond: float, tiny: Path, edited: Any
) -> None:
    def comparisons(by: float, where: Edit) -> list[Comparison]:
        """Compare with a value that is off, without and with a tolerance."""
        change = replaced(name, lambda values: values * (1 + by))
        other = edited(stage, lambda dataset: where(change(dataset)))
        found = [octsim.compare(tiny, other, tolerance) for tolerance in (None, TOLERANCE)]
        shutil.rmtree(other)
        return found

    key = f"{stage}.{name}"
    near, strict = comparisons(within, elsewhere)
    assert key not in differing(near)
    assert (key in differing(strict)) == (within > TOLERANCE)
    assert key in differing(comparisons(beyond, elsewhere)[0])
    same, _ = comparisons(within, lambda dataset: dataset)
    assert (key in differing(same)) == (within > TOLERANCE)


def test_a_phase_that_one_side_calls_rounding_is_left_out_and_no_other_nan_is(
    tiny: Path, edited: Any
) -> None:
    def old(dataset: xr.Dataset) -> xr.Dataset:
        numbers = replaced("phase", lambda values: np.where(np.isnan(values), 1.0, values))
        return numbers(dataset).drop_vars("phase_status")

    other = edited("fourier", old)
    for pair in ((tiny, other), (other, tiny)):
        found = octsim.compare(*pair)
        assert not dataset_of(found, "fourier").differs(0.0)
        phase = next(v for v in dataset_of(found, "fourier").variables if v.name == "phase")
        assert phase.deviation.unknown > 0
        assert any("left out: rounding alone in one" in line for line in lines(found))
    shutil.rmtree(other)
    other = edited("fourier", replaced("magnitude", at((0, 1), np.nan)))
    assert "fourier.magnitude" in differing(octsim.compare(tiny, other))


def test_the_exit_status_tells_the_same_from_different_and_from_wrong(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = make(tmp_path / "other", {"scene": {"gap": "6 nm"}})
    assert main(["compare", str(tiny), str(tiny)]) == 0
    assert main(["compare", str(tiny), str(other)]) == 1
    assert main(["compare", str(tiny), str(other), "--tolerance", "1e9"]) == 1  # whole numbers
    said = capsys.readouterr()
    assert said.err == ""
    assert f"(beyond {TOLERANCE:g})" in said.out
    notes = tmp_path / "notes.txt"
    notes.write_text("mine")
    wrong: list[tuple[list[str], str]] = [
        ([str(tiny), str(tmp_path / "none")], "none: not there; give a run's folder"),
        ([str(tiny), str(notes)], "notes.txt: neither a run's folder, nor an archive, nor a"),
        ([str(tmp_path), str(tiny)], "no datasets"),
        ([str(tiny / "paths.nc"), str(tiny), "--figure", str(tmp_path / "a.png")],
         "no phase_slope.nc, which the figure is drawn from"),
    ]  # fmt: skip
    for arguments, message in wrong:
        assert main(["compare", *arguments]) == 2
        said = capsys.readouterr()
        assert said.out == ""
        assert message in said.err
        assert said.err.count("\n") == 1
    for bad in (
        ["--tolerance", "-1"],
        ["--tolerance", "nan"],
        ["--figure", "a.gif"],
        ["more"],
        ["--figure", "a.png", "--no-figure"],
    ):
        with pytest.raises(SystemExit) as caught:
            main(["compare", str(tiny), str(tiny), *bad])
        assert caught.value.code == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_rays_of_grids_with_other_keys_are_not_compared(tmp_path: Path) -> None:
    one = make(tmp_path / "one", {"grid": {"scene.gap": ["5 nm", "20 nm"]}})
    other = make(tmp_path / "other", {"grid": {"detector.core_diameter": ["4 um", "5 um"]}})
    found = octsim.compare(one / "detections.nc", other / "detections.nc")
    (dataset,) = found.datasets
    rays = {v.name: v for v in dataset.variables if v.name in ("amplitude", "path_code")}
    assert {variable.unlike for variable in rays.values()} == {"no ray in common"}


def test_who_reads_the_first_lines_alone_sees_no_traceback(tiny: Path) -> None:
    shell = f"'{sys.executable}' -m octsim compare '{tiny}' '{tiny}' --no-figure | true"
    done = subprocess.run(shell, shell=True, capture_output=True, text=True, check=False)
    assert done.stderr == ""


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_slope_that_is_not_finite_is_told_and_drawn_as_far_as_it_is(
    value: float, tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "odd"
    shutil.copytree(tiny, folder)
    for places in (slice(0, 1), slice(None)):
        dataset = xr.load_dataset(folder / "phase_slope.nc")
        dataset["phase_slope"][places] = value
        write(dataset, folder / "phase_slope.nc")
        assert main(["compare", str(tiny), str(folder)]) == 1
        assert "phase_slope.phase_slope" in capsys.readouterr().out
        assert (tmp_path / "compare_tiny_tiny.png").stat().st_size > 10_000


def test_what_a_hostile_file_says_of_its_sizes_and_libraries_is_one_line(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "hostile"
    shutil.copytree(tiny, folder)
    dataset = xr.load_dataset(folder / "detections.nc")
    dataset["rays_detected"][:] = 10**6
    write(dataset.assign_attrs(environment="[" * 100_000), folder / "detections.nc")
    assert main(["compare", str(folder), str(folder)]) == 2
    said = capsys.readouterr()
    assert "detections.nc: can't be read" in said.err.replace(" or ", ": ")
    assert said.err.count("\n") == 1


def test_the_figure_of_a_grid_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = make(tmp_path, GRID)
    file = tmp_path / "both.png"
    assert main(["compare", str(folder), str(folder)]) == 0  # none is drawn that nobody asked for
    assert not list(tmp_path.glob("*.png"))
    capsys.readouterr()
    assert main(["compare", str(folder), str(folder), "--figure", str(file)]) == 2
    assert "phase_slope.nc: of a grid" in capsys.readouterr().err
    assert not file.exists()


def test_a_damaged_dataset_is_one_line(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "damaged"
    shutil.copytree(tiny, folder)
    content = (folder / "spectra.nc").read_bytes()
    half = len(content) // 2
    (folder / "spectra.nc").write_bytes(content[:half] + bytes(2000) + content[half + 2000 :])
    assert main(["compare", str(tiny), str(folder)]) == 2
    said = capsys.readouterr().err
    assert "spectra.nc" in said
    assert said.count("\n") == 1
