"""From phases to nanometres: closed forms, series as they are measured, and round trips."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

import octsim
from octsim.base.errors import ConfigError, DatasetError, OctsimError
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.figures.action_potential import action_potential_figure
from octsim.figures.expansion import expansion_figure
from octsim.figures.style import look, save
from octsim.instrument.instrument import Instrument
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.series import series_phases
from octsim.phase.measured_series import Series, change_from_rest, read_series
from octsim.phase.noise import shot_noise
from octsim.studies.calibration import round_trips as round_trip
from octsim.studies.calibration import study as calibrate
from octsim.studies.calibration.action_potential import (
    DURATION,
    INTERVAL,
    SAMPLES,
    action_potential,
    summary,
    swelling,
)
from octsim.studies.calibration.expansion import (
    LARGEST,
    expansion,
    expansion_of_series,
    sensitivity_at,
    series_expansion,
    series_of,
)
from octsim.studies.calibration.expansion import summary as expansion_summary
from octsim.studies.calibration.study import converged

Array = NDArray[np.float64]
ROOT = Path(__file__).parents[2]
SLOPE, ERROR, CURVATURE = 24.0, 0.24, -0.02
LAW = {"sweep": {"focus": {"slope": 0.58, "intercept": "66 nm"}}}


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


# series

TIME = 1e-3 * np.arange(30, dtype=np.float64)
CHANGE = np.where(np.arange(30) < 20, 0.0, 0.01 * (np.arange(30) - 20))


def test_wrapped_phases_are_the_same_as_unwrapped_ones() -> None:
    whole = Series(TIME, 3.1 + CHANGE, np.full(30, 1e-3))
    wrapped = whole._replace(phase=np.angle(np.exp(1j * whole.phase)))
    assert (np.abs(np.diff(wrapped.phase)) > 6).any()
    assert change_from_rest(wrapped, 20).phase == pytest.approx(CHANGE, abs=1e-12)


def test_missing_samples_stay_missing_and_are_passed_over() -> None:
    phase = np.angle(np.exp(1j * (3.1 + CHANGE)))
    gone = [3, 19, 24, 25]
    phase[gone] = np.nan
    found = change_from_rest(Series(TIME, phase, np.full(30, 1e-3)), 20)
    there = np.setdiff1d(np.arange(30), gone)
    assert found.phase[there] == pytest.approx(CHANGE[there], abs=1e-12)
    assert np.isnan(found.phase[gone]).all()
    assert np.isnan(found.error[gone]).all()
    assert found.error[there] == pytest.approx(1e-3 * np.sqrt(1 + 1 / 18))


def test_without_phase_errors_the_scatter_at_rest_serves() -> None:
    noise = np.random.default_rng(5).normal(0, 2e-3, 30)
    found = change_from_rest(Series(TIME, CHANGE + noise), 20)
    assert found.error == pytest.approx(noise[:20].std(ddof=1) * np.sqrt(1 + 1 / 20))
    assert found.phase[:20].mean() == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize(
    ("series", "rest", "message"),
    [
        (Series(TIME, np.where(TIME > 0.02, 2.8, 0.0)), 20, r"moves by 2.8 rad up to 0.021 s"),
        (Series(TIME, np.where(TIME < 0.018, np.nan, 0.0)), 20, r"first 20 of 30 samples 2 have"),
        (Series(TIME, CHANGE), 31, r"first 31 of 30 samples"),
        (Series(TIME, np.where(TIME < 0.02, np.nan, 0), CHANGE), 20, r"samples 0 have .* 1 are"),
    ],
)
def test_a_series_without_a_sure_rest_is_refused(series: Series, rest: int, message: str) -> None:
    with pytest.raises(DatasetError, match=message):
        change_from_rest(series, rest)


def test_csv_and_netcdf_hold_the_same_series(tmp_path: Path) -> None:
    rows = [f"{1e3 * t:.6f}, {1e3 * p:.9f}, 0.5  # one" for t, p in zip(TIME, CHANGE, strict=True)]
    rows[4], rows[7] = "4.0,,0.5", "7.0,nan,"
    text = "\ufeff# my axon\ntime (ms),phase [mrad],phase_error (mrad)\n\n" + "\n".join(rows)
    (tmp_path / "s.csv").write_text(text, encoding="utf-8")
    first = read_series(tmp_path / "s.csv")
    assert first.time == pytest.approx(TIME)
    assert np.isnan(first.phase[[4, 7]]).all()
    kept = np.delete(np.arange(30), [4, 7])
    assert first.phase[kept] == pytest.approx(CHANGE[kept], abs=1e-12)
    assert first.phase_error is not None
    assert first.phase_error[0] == pytest.approx(5e-4)
    stored = xr.Dataset(
        {"phase": ("time", 1e3 * first.phase, {"units": "mrad"})},
        {"time": ("time", first.time, {"units": "s"})},
    )
    stored.to_netcdf(tmp_path / "s.nc", engine="netcdf4")
    second = read_series(tmp_path / "s.nc")
    assert second.phase_error is None
    assert second.time == pytest.approx(first.time)
    assert second.phase == pytest.approx(first.phase, nan_ok=True)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no 'time'"),
        ("time,fase\n0,1\n", "holds no 'phase'"),
        ("time,phase\n", "no sample has a phase"),
        ("time,phase\n0,\n1,nan\n", "no sample has a phase"),
        ("time,phase\n0,1\n1,one\n", "phase of sample 2 is 'one'"),
        ("time,phase\n0,1\n,1\n", "sample 2 has no time"),
        ("time,phase\n0,1\n0,1\n", "from 0 to 0 s at sample 2; sort"),
        ("time,phase\n0,inf\n1,1\n", "phase of sample 1 is infinite"),
        ("time,phase (deg)\n0,1\n", "unit of phase is 'deg'; the known ones are rad, mrad"),
        ("time,phase,phase_error\n0,1,-1\n", "phase_error of sample 1 is -1"),
        ("time,phase,phase_error\n0,1,\n", "phase_error of sample 1 is nan"),
    ],
)
def test_a_file_that_is_no_series_is_refused_in_one_line(
    tmp_path: Path, text: str, message: str
) -> None:
    (tmp_path / "s.csv").write_text(text, encoding="utf-8")
    with pytest.raises(DatasetError, match=message) as said:
        read_series(tmp_path / "s.csv")
    assert "\n" not in str(said.value)


def test_files_that_are_missing_or_damaged_are_refused(tmp_path: Path) -> None:
    for name in ("none.csv", "none.nc"):
        with pytest.raises(DatasetError, match="not there"):
            read_series(tmp_path / name)
    for name in ("bad.csv", "bad.nc"):
        (tmp_path / name).write_bytes(b"\xff\xfe\x00")
        with pytest.raises(DatasetError, match="can't be read"):
            read_series(tmp_path / name)
    with pytest.raises(ConfigError, match=r"expansion.series: not given"):
        series_of(Config())


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


# the instrument, there and back


@pytest.mark.parametrize("change", [-10.0, -1.0, 1.0, 10.0])
def test_the_phase_of_a_thicker_neuron_gives_its_thickness(
    calibrated: xr.Dataset, change: float
) -> None:
    config = load_config(LAW)
    focus, k = 0.58 * 1.4 + 0.066, config.spectrum.wavenumbers()
    spectra = Instrument(converged(config)).spectra((1.4, 1.4 + change / 1e3), (focus, focus))
    rest, moved = series_phases(
        spectra, k, 1.4 * config.scene.refractive_index.neuron, calibrate.calibrating(config)
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
        phase = series_phases(counts, k, 1.4 * n_neuron, calibrate.calibrating(config))
        change = change_from_rest(Series(np.arange(240.0), phase), 60)
        covered.append((np.abs(change.phase) <= change.error)[60:].mean())
    # five of the mean's own deviations, about the share of a normal law within one
    assert np.mean(covered) == pytest.approx(0.683, abs=5 * np.std(covered) / np.sqrt(20))
    assert 0.60 <= np.mean(covered) <= 0.76


def test_shot_noise_is_poissonian() -> None:
    spectra = np.full((400, 50), 2.0)
    counts = shot_noise(spectra, 5000, np.random.default_rng(1))
    assert counts.mean() == pytest.approx(100, rel=0.005)
    assert counts.var() == pytest.approx(100, rel=0.05)
    dimmer = shot_noise(np.stack((spectra[0], 3 * spectra[0])), 1e9, np.random.default_rng(1))
    assert dimmer[1].sum() / dimmer[0].sum() == pytest.approx(3, rel=1e-3)


def test_the_action_potential_has_its_height_and_duration() -> None:
    time = INTERVAL * np.arange(SAMPLES, dtype=np.float64)
    pulse = swelling(time, 2.0)
    assert pulse.max() == pytest.approx(2.0)
    assert INTERVAL * (pulse > 1.0).sum() == pytest.approx(DURATION, abs=2 * INTERVAL)


def test_the_stated_error_covers_the_truth_as_often_as_one_sigma_should(
    calibrated: xr.Dataset, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(round_trip, "TRIALS", 40)
    config = load_config(LAW, {"calibration": {"diameters": {"num": 11}}})
    fired = action_potential(config, calibrated, None, 2)
    assert fired["trip_expansion"].shape == (5, 40)
    for name in ("coverage_both", "coverage_noise", "coverage_instrument"):
        assert 0.60 <= float(fired[name].mean()) <= 0.76, name
    assert abs(float(fired["trip_bias"].mean())) < 0.01
    assert (np.abs(fired["trip_bias"]) < 0.01).all()
    # and so does the trace, where the thesis's way does not
    off = np.abs(fired["expansion"] - fired["true_expansion"])
    stated = np.hypot(fired["statistical_error"], fired["systematic_error"])
    assert 0.60 <= float((off <= stated).mean()) <= 0.76
    middle = slice(95, 106)
    of_fft = (fired["fft_expansion"] - fired["true_expansion"])[middle].mean()
    ours = (fired["expansion"] - fired["true_expansion"])[middle].mean()
    assert abs(float(ours)) < 0.005 < 0.02 < abs(float(of_fft))
    for variable in fired.variables.values():
        assert variable.attrs["units"]
        assert variable.attrs["long_name"]
    assert "200 round trips" in summary(fired)
    with look():
        save(action_potential_figure(fired, calibrated), tmp_path / "fired.png")


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


def test_the_targets_have_their_names(tmp_path: Path) -> None:
    (tmp_path / "phases.csv").write_text("time,phase\n0,0\n", encoding="utf-8")
    (tmp_path / "mine.yaml").write_text("expansion: {series: phases.csv}\n", encoding="utf-8")
    _, planned = snakemake(
        tmp_path, "expansion", "action_potential", "--dry-run", "--configfile", "mine.yaml"
    )
    for said in ("at a fixed focus and gap", "into nanometres", "Simulate an action potential"):
        assert said in planned
