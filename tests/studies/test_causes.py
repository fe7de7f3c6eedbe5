"""The dataset of the spike and of the scatter: its numbers are the run's, and it is drawn."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from missing import unexplained

import octsim
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.datasets.files import read, write
from octsim.figures.causes import FIGURES
from octsim.figures.style import look, save
from octsim.studies.causes.study import causes, summary
from octsim.studies.causes.switches import CAUSES

SMALL = load_config({
    "sweep": {
        "diameters": {"start": "1.1 um", "stop": "1.2 um", "num": 16},
        "focus": {"slope": 0.58, "intercept": "64 nm"},
    },
})  # fmt: skip


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    return causes(SMALL, threads=2)


def run_of(config: Config) -> xr.Dataset:
    spectra = octsim.spectra(config, octsim.detections(config))
    return octsim.phase_slope(config, octsim.fourier(config, spectra))


def test_the_dataset_s_numbers_add_up_to_the_run_s_slope(found: xr.Dataset) -> None:
    run = run_of(SMALL)
    assert np.allclose(found["phase_slope"], run["phase_slope"], atol=1e-8)
    added = found["cause_phase_slope"].sum("cause") + found["trend_phase_slope"]
    assert np.allclose(added + found["unexplained_phase_slope"], run["phase_slope"], atol=1e-8)
    shares = float(found["cause_share"].sum() + found["trend_share"] + found["unexplained_share"])
    assert shares == pytest.approx(1, abs=1e-9)
    assert (found["least_share"] <= found["cause_share"] + 1e-12).all()
    assert (found["cause_share"] <= found["largest_share"] + 1e-12).all()
    # the beat's slope is found twice: by its fields, and as what no cause is left of
    none = found["trend_phase_slope"] + found["unexplained_phase_slope"]
    assert np.allclose(found["beat_phase_slope"], none, atol=1e-3)


def test_the_thesis_s_spike_is_the_midpoint_s(found: xr.Dataset) -> None:
    assert found["spike_diameter"].item() == pytest.approx(1.15, abs=0.01)
    place = found["spike_neighbour"].values
    at_edge = found["spike_maximum"].values == SMALL.spectrum.wavenumbers()[0]
    assert 0.2 < at_edge.mean() < 0.6
    jump = int(np.abs(np.diff(found["spike_phase_slope"].values)).argmax())
    assert at_edge[jump]
    assert not at_edge[jump + 1]
    assert place[jump] == pytest.approx(1.1535, abs=1e-3)
    assert found["spike_phase_slope"].values[jump] > 25.5
    assert np.ptp(found["spike_phase_slope_without_centre"].values) < 0.25
    assert abs(found["phase_slope_without"].sel(cause="centre").max() - 23.6) < 0.1
    assert found["left_without_all"] < 0.05


def test_the_dataset_explains_itself_and_is_drawn(found: xr.Dataset, tmp_path: Path) -> None:
    for name, variable in found.variables.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name
    assert found["cause"].values.tolist() == list(CAUSES)
    write(found, tmp_path / "causes.nc")
    stored = read(tmp_path / "causes.nc", "causes", SMALL)
    assert "spike at" in summary(stored)
    for name, draw in FIGURES.items():
        with look():
            save(draw(stored), tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 10_000


def test_a_status_says_why_a_number_is_missing(found: xr.Dataset) -> None:
    assert list(unexplained(found)) == []
