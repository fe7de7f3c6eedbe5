"""An action potential there and back: its height, and errors that cover the truth."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from made_runs import CALIBRATED, as_calibrated
from missing import unexplained

from octsim.config.load import load_config
from octsim.figures.action_potential import action_potential_figure
from octsim.figures.style import look, save
from octsim.studies.calibration import round_trips
from octsim.studies.calibration.action_potential import (
    DURATION,
    INTERVAL,
    SAMPLES,
    action_potential,
    summary,
    swelling,
)


def test_the_action_potential_has_its_height_and_duration() -> None:
    time = INTERVAL * np.arange(SAMPLES, dtype=np.float64)
    pulse = swelling(time, 2.0)
    assert pulse.max() == pytest.approx(2.0)
    assert INTERVAL * (pulse > 1.0).sum() == pytest.approx(DURATION, abs=2 * INTERVAL)


def test_the_stated_error_covers_the_truth_as_often_as_one_sigma_should(
    calibrated: xr.Dataset, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(round_trips, "TRIALS", 24)
    config = load_config(CALIBRATED, {"spectrum": {"samples": 1000}})
    with as_calibrated():
        fired = action_potential(config, calibrated, None, 2)
    assert fired["trip_expansion"].shape == (5, 24)
    assert 0.60 <= float(fired["coverage_noise"].mean()) <= 0.76
    # what is not known of an instrument moves the slope by no normal deviate, as that bends over
    # it: more is within the root of the mean square, and few are far beyond
    for name in ("coverage_both", "coverage_instrument"):
        assert 0.65 <= float(fired[name].mean()) <= 0.92, name
    off = np.abs(fired["trip_expansion"] - 1.0)
    whole = np.hypot(fired["trip_statistical_error"], fired["trip_systematic_error"])
    assert float((off < 2 * whole).mean()) > 0.93
    assert float(np.abs(fired["trip_bias"].mean())) < 0.02
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
    assert "120 round trips" in summary(fired)
    assert list(unexplained(fired)) == []
    with look():
        save(action_potential_figure(fired, calibrated), tmp_path / "fired.png")
