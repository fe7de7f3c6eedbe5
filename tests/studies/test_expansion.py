"""From phases to nanometres: closed forms, a series that is expanded, and what a neuron does."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

import octsim
from octsim.base.errors import ConfigError, OctsimError
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.figures.expansion import expansion_figure
from octsim.figures.style import look, save
from octsim.instrument.instrument import Instrument
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.series import series_phases
from octsim.phase.measured_series import Series, change_from_rest, read_series
from octsim.phase.noise import shot_noise
from octsim.studies.calibration import study as calibrate
from octsim.studies.calibration.expansion import (
    LARGEST,
    expansion,
    expansion_of_series,
    sensitivity_at,
    series_expansion,
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
