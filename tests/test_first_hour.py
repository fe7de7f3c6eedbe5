"""What a newcomer does in the first hour, in Python and xarray, on a small run."""

import inspect
import json
import pydoc
import rlcompleter
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from missing import unexplained

import octsim
from octsim.cli.show import in_words
from octsim.datasets.files import write

CONFIG: dict[str, Any] = {
    "run": "first",
    "tracing": {"rays": 150},
    "spectrum": {"samples": 64},
    "focus_scan": {"diameter": None, "focus": {"num": 9}},
    "focus_law": {"diameters": None, "fraction": {"num": 11}},
    "sweep": {"diameters": {"start": "1.2 um", "stop": "1.6 um", "num": 9}},
}
Run = dict[str, xr.Dataset]


@pytest.fixture(scope="module")
def run() -> Run:
    return octsim.run(CONFIG, threads=2)


@pytest.fixture(scope="module")
def dark() -> Run:
    """Make a run in which nothing is reflected but by the glass: some spectra have no fringe."""
    index = {"scene": {"refractive_index": {"neuron": 1.33}}}
    focus = {"sweep": {"focus": {"slope": 0.58, "intercept": "66 nm"}}}
    return octsim.run(octsim.load_config(CONFIG, index, focus), "phase_slope", threads=2)


def test_one_call_gives_every_dataset_in_order(run: Run) -> None:
    assert list(run) == [
        "focus_scan", "focus_sweep", "gaussian_fits", "focus_law", "detections", "spectra",
        "paths", "fourier", "phase_slope",
    ]  # fmt: skip


def test_one_dataset_comes_with_what_it_is_made_from(dark: Run) -> None:
    assert list(dark) == ["detections", "spectra", "fourier", "phase_slope"]


def test_stages_by_themselves_give_the_same_bits(run: Run) -> None:
    config = octsim.load_config(CONFIG)
    spectra = octsim.spectra(config, octsim.detections(config, run["focus_law"]))
    xr.testing.assert_identical(spectra, run["spectra"])


def test_a_name_that_is_no_dataset_is_told_the_nearest() -> None:
    with pytest.raises(octsim.ConfigError, match="the nearest that is one is spectra"):
        octsim.run(CONFIG, "spectrum")


def test_a_stage_takes_a_file_s_name(run: Run, tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(json.dumps(CONFIG))
    for given in (tmp_path / "mine.yaml", str(tmp_path / "mine.yaml"), CONFIG):
        xr.testing.assert_identical(octsim.focus_scan(given), run["focus_scan"])  # type: ignore[arg-type]


@pytest.mark.parametrize("stage", [octsim.focus_scan, octsim.calibration])
def test_a_stage_says_what_it_takes(stage: Any) -> None:
    with pytest.raises(octsim.ConfigError, match="a int given; give octsim"):
        stage(5)


def test_a_config_s_repr_makes_it_again() -> None:
    config = octsim.load_config(CONFIG)
    assert "'num': 9" in repr(config)
    assert eval(repr(config), {"octsim": octsim, "None": None}) == config
    assert repr(octsim.Config()) == "octsim.load_config()"


def test_a_config_is_not_changed_but_made_anew() -> None:
    config = octsim.load_config(CONFIG)
    with pytest.raises(ValueError, match="frozen"):
        config.run = "other"  # type: ignore[misc]
    assert octsim.load_config(config.to_dict(), {"run": "other"}).run == "other"


def test_a_stage_s_repr_has_its_signature_and_purpose() -> None:
    assert repr(octsim.focus_sweep).startswith("<stage focus_sweep(config, threads=1, ")
    assert "Measure the intensity at fractions of the diameter" in repr(octsim.focus_sweep)


def test_help_tells_a_stage_and_what_it_returns() -> None:
    for stage in (octsim.focus_sweep, octsim.calibration, octsim.run):
        told = pydoc.render_doc(stage)
        assert "Returns" in told
        assert "config" in told
    assert "config" in inspect.signature(octsim.calibration).parameters


def test_tab_completes_public_names() -> None:
    completer = rlcompleter.Completer({"octsim": octsim})
    found = {completer.complete("octsim.foc", state) for state in range(8)} - {None}
    assert {str(one).rstrip("(") for one in found} == {
        "octsim.focus_law", "octsim.focus_scan", "octsim.focus_sweep"
    }  # fmt: skip


def test_tab_completes_variables(run: Run) -> None:
    assert "intensity" in dir(run["spectra"])
    assert "phase_slope" in run["phase_slope"]._ipython_key_completions_()


def test_select_by_label(run: Run) -> None:
    slopes = run["phase_slope"]["phase_slope"]
    assert float(slopes.sel(diameter=1.4)) == float(slopes[4])
    assert float(slopes.sel(diameter=1.41, method="nearest")) == float(slopes[4])


def test_select_a_range_by_label(run: Run) -> None:
    assert run["spectra"].sel(diameter=slice(1.24, 1.46)).sizes["diameter"] == 5


def test_the_wavelength_stands_beside_the_wavenumber(run: Run) -> None:
    spectra = run["spectra"]
    wavelength = spectra["wavelength"]
    assert wavelength.dims == ("wavenumber",)
    assert wavelength.attrs["units"] == "um"
    np.testing.assert_array_equal(wavelength, 2 * np.pi / spectra["wavenumber"].values)
    assert "wavelength" in spectra["intensity"].coords
    red = spectra["intensity"].where(wavelength > 0.8, drop=True)
    assert 0 < red.sizes["wavenumber"] < 64


def test_select_by_wavelength(run: Run) -> None:
    by_length = run["spectra"].swap_dims(wavenumber="wavelength").sortby("wavelength")
    assert float(by_length["wavelength"].sel(wavelength=0.7, method="nearest")) == pytest.approx(
        0.7, abs=5e-3
    )


def test_a_wavelength_is_of_every_dataset_that_has_a_wavenumber(run: Run) -> None:
    assert all("wavelength" in one.coords for one in run.values() if "wavenumber" in one.dims)


def test_interpolate(run: Run) -> None:
    slopes = run["phase_slope"]["phase_slope"]
    between = float(slopes.interp(diameter=1.425))
    assert between == pytest.approx(float(slopes[4:6].mean()))


def test_average_and_reduce(run: Run) -> None:
    slopes = run["phase_slope"]
    assert float(slopes["phase_slope"].mean()) == pytest.approx(float(slopes["mean_phase_slope"]))


def test_concatenate_two_runs(run: Run) -> None:
    other = octsim.load_config(CONFIG, {"scene": {"gap": "10 nm"}})
    spectra = octsim.spectra(other, octsim.detections(other, run["focus_law"]))
    both = xr.concat(
        [run["spectra"], spectra], xr.Variable("gap", [5.0, 10.0]), combine_attrs="drop_conflicts"
    )
    assert both["intensity"].dims == ("gap", "diameter", "wavenumber")
    assert both.sizes["gap"] == 2
    assert both.attrs["title"] == spectra.attrs["title"]


def test_compute_with_labels(run: Run) -> None:
    spectra = run["spectra"]["intensity"]
    relative = spectra / spectra.max("wavenumber")
    assert float(relative.max()) == 1.0
    assert relative.dims == spectra.dims


def test_plot_a_line_with_its_labels_and_units(run: Run) -> None:
    mpl.use("agg")
    (line,) = run["phase_slope"]["phase_slope"].plot()  # type: ignore[call-arg]
    axes = line.axes
    assert axes.get_xlabel() == "diameter of the cylinder [um]"
    assert axes.get_ylabel().endswith("[mrad/nm]")


def test_plot_an_image(run: Run) -> None:
    mpl.use("agg")
    image = run["spectra"]["intensity"].plot()  # type: ignore[call-arg]
    assert image.axes.get_xlabel().startswith("wavenumber")


def test_to_a_table_and_back(run: Run) -> None:
    table = run["phase_slope"][["phase_slope", "fringe_status"]].to_dataframe()
    assert list(table.columns) == ["phase_slope", "fringe_status"]
    assert table.index.name == "diameter"


def test_every_variable_says_its_unit_and_meaning(run: Run) -> None:
    for dataset in run.values():
        for name, variable in dataset.variables.items():
            assert {"units", "long_name"} <= variable.attrs.keys(), name


def test_every_status_is_a_cf_flag(run: Run, dark: Run) -> None:
    found = 0
    for dataset in (*run.values(), *dark.values()):
        for name, variable in dataset.data_vars.items():
            if not (str(name).endswith(("status", "_use", "_scheme"))):
                continue
            found += 1
            values = np.atleast_1d(variable.attrs["flag_values"])
            meanings = variable.attrs["flag_meanings"].split()
            assert len(values) == len(meanings) == len(set(meanings)), name
            assert values.dtype == variable.dtype, name
            assert set(np.unique(variable).tolist()) <= set(values.tolist()), name
    assert found > 10


def test_a_status_is_read_in_words(run: Run) -> None:
    assert in_words(run["phase_slope"]["fringe_status"]) == "visible 9"


def test_a_mask_by_a_status(dark: Run) -> None:
    slopes = dark["phase_slope"]
    status = slopes["fringe_status"]
    codes = dict(
        zip(status.attrs["flag_meanings"].split(), status.attrs["flag_values"], strict=True)
    )
    visible = slopes["phase_slope"].where(status == codes["visible"])
    assert int(visible.notnull().sum()) == int((status == codes["visible"]).sum())


def test_a_status_stands_beside_every_nan(run: Run, dark: Run) -> None:
    for dataset in (*run.values(), *dark.values()):
        assert list(unexplained(dataset)) == []
    slope = dark["phase_slope"]["phase_slope"]
    status = dark["phase_slope"][slope.attrs["ancillary_variables"]]
    assert slope.isnull().any()
    assert "no fringe" in in_words(status.where(slope.isnull(), drop=True))


def test_a_dataset_says_what_it_is(run: Run) -> None:
    for stage, dataset in run.items():
        told = dataset.attrs
        assert told["stage"] == stage
        assert told["summary"].startswith(told["title"])
        assert told["history"] == f"octsim {octsim.__version__}: stage {stage} of the run first"
        assert "archive.license" in told["license"]
        assert "CITATION.cff" in told["references"]
        assert octsim.load_config(json.loads(told["config"])).run == "first"


def test_write_and_read_back(run: Run, tmp_path: Path) -> None:
    write(run["spectra"], tmp_path / "spectra.nc")
    xr.testing.assert_identical(octsim.read(tmp_path / "spectra.nc"), run["spectra"])
    with xr.open_dataset(tmp_path / "spectra.nc") as plain:
        assert "wavelength" in plain.coords


@pytest.mark.parametrize("name", ["README.md", "notes.nc", "data.csv"])
def test_a_file_that_is_no_dataset_stays_where_it_is(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text("# mine")
    with pytest.raises(octsim.DatasetError) as refused:
        octsim.read(tmp_path / name)
    assert "give a dataset of octsim" in str(refused.value)
    assert "move" not in str(refused.value)


def test_an_estimate_says_what_it_holds(run: Run) -> None:
    told = repr(octsim.phase_of(run["spectra"][["intensity"]]))
    assert told.startswith("<Estimate of 9 spectra (")
    assert ": phase " in told
    assert "\n" not in told
