"""From phases to nanometres: closed forms, a series that is expanded, and what a neuron does."""

import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from made_runs import CALIBRATED
from missing import unexplained
from numpy.typing import NDArray

import octsim
from octsim.base.errors import ConfigError, OctsimError, OctsimWarning
from octsim.config.derive import calibrating
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.figures.expansion import expansion_figure
from octsim.figures.style import look, save
from octsim.instrument.instrument import Instrument
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.series import series_phases
from octsim.phase.measured_series import Series, change_from_rest, read_series
from octsim.phase.noise import shot_noise
from octsim.studies.calibration.expansion import (
    doubts,
    expansion,
    expansion_of_series,
    series_expansion,
)
from octsim.studies.calibration.expansion import summary as expansion_summary
from octsim.studies.calibration.scheme import converged
from octsim.studies.calibration.sensitivity import LARGEST, sensitivity_at

Array = NDArray[np.float64]
ROOT = Path(__file__).parents[2]
SLOPE, ERROR, CURVATURE = 24.0, 0.24, -0.02


@pytest.fixture
def table() -> xr.Dataset:
    """Give a calibration whose slope and errors are the same everywhere."""
    diameter = np.linspace(1, 2, 8)
    constant = {
        "fixed_focus_phase_slope": SLOPE,
        "fixed_focus_phase_slope_standard_error": ERROR,
        "phase_curvature": CURVATURE,
    }
    variables = {name: ("diameter", np.full(8, value)) for name, value in constant.items()}
    return xr.Dataset(variables, {"diameter": diameter})


def phases(change: Array) -> Array:
    """Give the phase (rad) of a change of the diameter (nm)."""
    moved: Array = (SLOPE * change + CURVATURE * change**2 / 2) / 1e3
    return moved


def test_eleven_milliradians_are_what_the_slope_says(table: xr.Dataset) -> None:
    found = octsim.expansion(0.011, 1.4, table)
    assert float(found.expansion) == pytest.approx(11 / SLOPE, rel=1e-3)
    assert float(found.systematic_error) == pytest.approx(11 / SLOPE * ERROR / SLOPE, rel=1e-3)
    assert float(found.statistical_error) == 0


def test_phases_come_back_to_the_expansion_that_they_are_of(table: xr.Dataset) -> None:
    change = np.array([-LARGEST, -3.0, 0.0, 1e-3, 0.46, 5.0, 0.99 * LARGEST])
    found = expansion(phases(change), 1.3, table)
    assert found.expansion == pytest.approx(change * 0.99999999, rel=1e-7)


def test_errors_are_those_of_a_small_change_of_phase_and_slope(table: xr.Dataset) -> None:
    change, small = np.array([-10.0, 0.5, 10.0]), 1e-6
    found = expansion(phases(change), 1.3, table, np.array([1e-3, 2e-3, 3e-3]))
    by_phase = (
        expansion(phases(change) + small, 1.3, table).expansion - found.expansion
    ) / small  # fmt: skip
    assert found.statistical_error == pytest.approx(by_phase * [1e-3, 2e-3, 3e-3], rel=1e-4)
    steeper = table.assign(fixed_focus_phase_slope=table["fixed_focus_phase_slope"] + small)
    by_slope = (expansion(phases(change), 1.3, steeper).expansion - found.expansion) / small
    assert found.systematic_error == pytest.approx(np.abs(by_slope) * ERROR, rel=1e-4)
    assert found.standard_error == pytest.approx(
        np.sqrt(found.statistical_error**2 + found.systematic_error**2)
    )


@pytest.mark.parametrize("diameter", [0.99, 2.01, np.nan])
def test_a_diameter_outside_the_table_is_refused(table: xr.Dataset, diameter: float) -> None:
    with pytest.raises(OctsimError, match=r"diameter: .* outside the calibration's 1 to 2 um"):
        expansion(0.011, diameter, table)


@pytest.mark.parametrize("phase", [0.6, -0.6, np.inf, 1e6])
def test_a_change_too_large_for_the_calibration_is_refused(table: xr.Dataset, phase: float) -> None:
    with pytest.raises(OctsimError, match=r"mrad given, more than the 20 nm"):
        expansion([0.01, phase], 1.4, table)


def test_a_missing_phase_is_a_missing_expansion(table: xr.Dataset) -> None:
    found = expansion([0.01, np.nan], 1.4, table)
    assert np.isfinite(found.expansion).tolist() == [True, False]
    assert np.isnan(found.systematic_error[1])


def test_the_slope_of_what_fits_measured_spectra_best_is_taken_where_it_fits(
    table: xr.Dataset,
) -> None:
    match = xr.Dataset({
        "matched_phase_slope": SLOPE + 1, "matched_phase_slope_standard_error": ERROR / 2,
        "misfit": 0.01,
    })  # fmt: skip
    series = Series(TIME, phases(CHANGE), np.full(30, 1e-5))
    config = load_config({"expansion": {"diameter": "1.4 um"}})
    plain = series_expansion(config, series, table)
    found = series_expansion(config, series, table, match=match)
    assert float(found["fixed_focus_phase_slope"]) == SLOPE + 1
    ratio = float(found["expansion"][-1] / plain["expansion"][-1])
    assert ratio == pytest.approx(SLOPE / (SLOPE + 1), rel=1e-3)
    last = found.isel(time=-1)
    relative = float(last["systematic_error"] / abs(last["expansion"]))
    assert relative == pytest.approx(ERROR / 2 / (SLOPE + 1), rel=1e-2)
    with pytest.raises(OctsimError, match=r"expansion\.slope: match given, but the best fit"):
        series_expansion(config, series, table, match=match.assign(misfit=0.2))


def test_a_match_is_of_measured_spectra_alone() -> None:
    with pytest.raises(ConfigError, match=r"^expansion\.slope: match given"):
        load_config({"expansion": {"slope": "match", "series": "phases.csv"}})


TIME = 1e-3 * np.arange(30, dtype=np.float64)
CHANGE = np.where(np.arange(30) < 20, 0.0, 0.01 * (np.arange(30) - 20))


def test_the_series_that_a_config_names_is_the_one_that_is_expanded(
    table: xr.Dataset, tmp_path: Path
) -> None:
    rows = "\n".join(f"{t},{p}" for t, p in zip(TIME, CHANGE, strict=True))
    (tmp_path / "s.csv").write_text(f"time,phase\n{rows}\n", encoding="utf-8")
    named = load_config({"expansion": {"series": str(tmp_path / "s.csv"), "rest": 20}})
    found = expansion_of_series(named, table)
    assert found.equals(series_expansion(named, read_series(tmp_path / "s.csv"), table))
    with pytest.raises(ConfigError, match=r"expansion.series: not given"):
        expansion_of_series(Config(), table)


def test_a_series_becomes_a_dataset_that_explains_itself(table: xr.Dataset, tmp_path: Path) -> None:
    phase = phases(np.where(TIME < 0.02, 0.0, 100 * (TIME - 0.02)))
    phase[22] = np.nan
    found = series_expansion(Config(), Series(TIME, phase, np.full(30, 1e-3)), table)
    assert float(found["expansion"][29]) == pytest.approx(0.9)
    assert int(found["samples_missing"]) == 1
    assert np.isnan(found["expansion"][22])
    for name, variable in found.variables.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name
    assert "1 of 30 samples missing" in expansion_summary(found)
    with look():
        save(expansion_figure(found), tmp_path / "expansion.png")


QUIET: Array = 2e-4 * np.random.default_rng(11).normal(size=200)  # rad
PULSE: Array = np.exp(-(((np.arange(200) - 120) / 6) ** 2))  # of 1 nm
LONG = 5e-5 * np.arange(200, dtype=np.float64)


def test_an_outlier_is_named_and_never_the_largest_change(table: xr.Dataset) -> None:
    phase = phases(PULSE) + QUIET
    phase[149] += 0.2
    series = Series(LONG, phase)
    with pytest.warns(OctsimWarning, match=r"outliers.*: sample 150 at 0.00745 s \(\+8\.") as said:
        kept = series_expansion(Config(), series, table)
    assert [str(one.message) for one in said] == doubts(kept)
    assert "expansion.outliers: drop leaves them out" in doubts(kept)[0]
    assert "outlier" not in kept
    assert expansion_summary(kept).startswith("largest change +1.0")
    assert "at 0.00595 s" in expansion_summary(kept) or "at 0.006 s" in expansion_summary(kept)
    assert "1 outliers not counted; 0 of 200 samples missing" in expansion_summary(kept)
    marking, dropping = (load_config({"expansion": {"outliers": o}}) for o in ("mark", "drop"))
    marked = series_expansion(marking, series, table)
    assert np.flatnonzero(marked["outlier"]).tolist() == [149]
    assert marked["outlier"].attrs["flag_meanings"] == "among_others alone"
    assert np.array_equal(marked["expansion"], kept["expansion"])
    dropped = series_expansion(dropping, series, table)
    assert np.isnan(dropped["expansion"][149])
    assert np.isnan(dropped["statistical_error"][149])
    there = np.delete(np.arange(200), 149)
    assert np.array_equal(dropped["expansion"][there], kept["expansion"][there])
    assert dropped["measured_phase"][149] == phase[149], "as it was measured"
    assert "left out, as expansion.outliers says" in doubts(dropped)[0]


@pytest.mark.parametrize("outliers", ["mark", "drop"])
@pytest.mark.parametrize("error", [None, 1e-4])
def test_a_status_says_why_a_number_is_missing(
    table: xr.Dataset, outliers: str, error: float | None
) -> None:
    phase = phases(PULSE) + QUIET
    phase[149] += 0.2
    phase[22] = np.nan
    series = Series(LONG, phase, None if error is None else np.full(200, error))
    config = load_config({"expansion": {"outliers": outliers}})
    found = series_expansion(config, series, table)
    assert list(unexplained(found)) == []
    codes = found["sample_status"].values
    assert np.flatnonzero(codes).tolist() == ([22, 149] if outliers == "drop" else [22])
    not_known = table.assign(fixed_focus_phase_slope_standard_error=np.nan * table["diameter"])
    assert list(unexplained(series_expansion(config, series, not_known))) == []
    flat = series_expansion(config, Series(LONG, np.full(200, 0.3)), table)
    assert np.isnan(flat["statistical_error"]).all()
    assert list(unexplained(flat)) == []


def test_an_outlier_that_stops_the_rest_is_named_with_its_remedy(table: xr.Dataset) -> None:
    dropping = load_config({"expansion": {"outliers": "drop"}})
    clean = series_expansion(Config(), Series(LONG, phases(PULSE) + QUIET), table)
    for size in (0.8, 2.8, -100.0):  # beyond 20 nm, not to be unwrapped, neither nor
        phase = phases(PULSE) + QUIET
        phase[[5, 149]] += size
        with pytest.raises(OctsimError, match=r"; sample 6 at 0.00025 s, sample 150 at") as error:
            series_expansion(Config(), Series(LONG, phase), table)
        assert str(error.value).endswith("expansion.outliers: drop leaves them out")
        dropped = series_expansion(dropping, Series(LONG, phase), table)
        off = dropped["expansion"] - clean["expansion"]
        assert float(np.abs(off).max()) < 0.02


def test_a_drift_is_warned_of_and_subtracted_by_samples_at_rest(table: xr.Dataset) -> None:
    drifting = Series(LONG, phases(PULSE) + 5 * LONG + QUIET)
    plain = series_expansion(load_config({"expansion": {"rest": 60}}), drifting, table)
    assert "the phase at rest drifts" in " ".join(doubts(plain))
    straight, held = (
        series_expansion(load_config({"expansion": {"rest": 60, "drift": drift}}), drifting, table)
        for drift in ("linear", {"reference": [[171, 200]]})
    )
    assert float(held["drift"]) == pytest.approx(5, abs=0.02)
    for found in (straight, held):
        assert doubts(found) == []
        off = np.abs(found["expansion"].values - PULSE)
        assert (off < 5 * found["statistical_error"].values).all()
    # the farther from rest, the less a line through it is known: n samples, 169.5 from their middle
    error = straight["statistical_error"].values
    grown = np.sqrt((61 / 60 + 12 * 169.5**2 / (60**3 - 60)) / (61 / 60))
    assert error[-1] / error[29:31].mean() == pytest.approx(grown, rel=1e-3)
    assert float(held["statistical_error"][-1]) < 1.03 * float(held["statistical_error"][30])
    at_rest = series_expansion(Config(), Series(LONG, phases(PULSE) + QUIET), table)
    assert doubts(at_rest) == []
    assert float(at_rest["drift"]) == 0


def test_a_rest_without_scatter_is_asked_about(table: xr.Dataset, tmp_path: Path) -> None:
    rounded = 0.01 * np.round(phases(10 * PULSE) / 0.01)
    with pytest.warns(OctsimWarning, match="rest scatter by 0 mrad, less .* step of 10 mrad"):
        found = series_expansion(Config(), Series(LONG, rounded), table)
    assert found["error_status"].attrs["flag_meanings"].split()[int(found["error_status"])] == (
        "rounding"
    )
    least = 10 / SLOPE / np.sqrt(12)
    assert (found["statistical_error"] > least).all()
    with pytest.warns(OctsimWarning, match="is not known, and NaN"):
        still = series_expansion(Config(), Series(LONG, np.full(200, 0.3)), table)
    assert np.isnan(still["statistical_error"]).all()
    assert "± unknown (statistical)" in expansion_summary(still)
    none = Series(LONG, phases(PULSE) + QUIET, np.zeros(200))
    with pytest.warns(OctsimWarning, match="phase_error is 0 throughout"):
        series_expansion(Config(), none, table)
    some = none._replace(phase_error=np.where(np.arange(200) == 3, 0.0, QUIET[:60].std()))
    with pytest.warns(OctsimWarning, match="phase_error is 0 at 1 of 200"):
        series_expansion(Config(), some, table)
    with look():
        for number, one in enumerate((found, still)):
            save(expansion_figure(one), tmp_path / f"{number}.png")


@pytest.mark.parametrize("factor", [1e-3, 0.5, 2.0, 1e3])
def test_a_phase_error_of_another_unit_than_the_phase_is_asked_about(
    factor: float, table: xr.Dataset
) -> None:
    series = Series(LONG, phases(PULSE) + QUIET, np.full(200, factor * QUIET[:20].std()))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        series_expansion(Config(), series, table)
    said = [str(one.message) for one in caught if "see that its unit is right" in str(one.message)]
    assert len(said) == (factor in (1e-3, 1e3))
    # too few samples scatter by anything
    few = load_config({"expansion": {"rest": 4}})
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        series_expansion(few, series, table)
    assert not [one for one in caught if "see that its unit" in str(one.message)]


def test_an_outlier_at_rest_is_told_as_one_that_moves_all(table: xr.Dataset) -> None:
    phase = phases(PULSE) + QUIET
    phase[5] += 0.3
    with pytest.warns(OctsimWarning, match="and 1 at rest move the level of all samples"):
        series_expansion(Config(), Series(LONG, phase), table)


def test_few_samples_at_rest_widen_the_error_as_student_s_t_does(table: xr.Dataset) -> None:
    series = Series(LONG, phases(PULSE) + QUIET)
    for rest, factor in ((3, 1.3213), (60, 1.0086)):
        found = series_expansion(load_config({"expansion": {"rest": rest}}), series, table)
        scatter = QUIET[:rest].std(ddof=1)
        expected = factor * scatter * np.sqrt(1 + 1 / rest) * 1e3 / SLOPE
        assert float(found["statistical_error"][0]) == pytest.approx(expected, rel=1e-3)
        assert float(found["rest_scatter"]) == pytest.approx(scatter)


def test_a_figure_marks_the_outliers(table: xr.Dataset) -> None:
    phase = phases(PULSE) + QUIET
    phase[149] += 0.2
    marking = load_config({"expansion": {"outliers": "mark"}})
    (axes,) = expansion_figure(series_expansion(marking, Series(LONG, phase), table)).axes
    said = "doubtful: outliers, alone among others"
    (marked,) = [line for line in axes.lines if line.get_label() == said]
    assert np.asarray(marked.get_xdata()) == pytest.approx([7.45])


@pytest.mark.parametrize("change", [-10.0, -1.0, 1.0, 10.0])
def test_the_phase_of_a_thicker_neuron_gives_its_thickness(
    calibrated: xr.Dataset, change: float
) -> None:
    config = load_config(CALIBRATED)
    focus, k = 0.58 * 1.4 + 0.066, config.spectrum.wavenumbers()
    spectra = Instrument(converged(config)).spectra((1.4, 1.4 + change / 1e3), (focus, focus))
    rest, moved = series_phases(
        spectra, k, 1.4 * config.scene.refractive_index.neuron, calibrating(config)
    )
    found = expansion(wrapped(moved - rest), 1.4, calibrated)
    assert float(found.expansion) == pytest.approx(change, rel=1e-3)
    # a straight line would not do for 10 nm
    straight = 1e3 * wrapped(moved - rest) / sensitivity_at(1.4, calibrated).slope
    assert abs(float(found.expansion) - change) < 0.2 * abs(float(straight) - change)


def test_the_error_of_a_trace_covers_it_as_often_as_one_sigma_should() -> None:
    config = Config()
    k, n_neuron = config.spectrum.wavenumbers(), config.scene.refractive_index.neuron
    at_rest = np.tile(1 + 0.5 * np.cos(2 * n_neuron * 1.4 * k), (240, 1))
    covered = []
    for seed in range(20):
        counts = shot_noise(at_rest, 1e8, np.random.default_rng(seed))
        phase = series_phases(counts, k, 1.4 * n_neuron, calibrating(config))
        change = change_from_rest(Series(np.arange(240.0), phase), 60)
        covered.append((np.abs(change.phase) <= change.error)[60:].mean())
    # five of the mean's own deviations, about the share of a normal law within one
    assert np.mean(covered) == pytest.approx(0.683, abs=5 * np.std(covered) / np.sqrt(20))
    assert 0.60 <= np.mean(covered) <= 0.76


def snakemake(folder: Path, *arguments: str) -> tuple[int, str]:
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile")]
    done = subprocess.run(
        [*command, "--cores", "1", *arguments], cwd=folder, capture_output=True, text=True
    )  # fmt: skip
    return done.returncode, done.stdout + done.stderr


def test_an_expansion_without_a_series_is_one_clear_line(tmp_path: Path) -> None:
    code, said = snakemake(tmp_path, "expansion")
    assert code != 0
    assert "octsim: expansion.series: not given" in said
    assert "Traceback" not in said
    assert "fixed focus" not in said, "nothing is calibrated for it"
