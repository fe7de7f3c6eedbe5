"""The values in a page are the datasets'."""

import base64
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from octsim.archive.run_folder import run_in
from octsim.config.load import load_config
from octsim.report import plots
from octsim.report.plots import a_scans, every, packed, values_of
from octsim.report.shown import shown_of


def unpacked(one: dict[str, str]) -> np.ndarray[Any, Any]:
    return np.frombuffer(base64.b64decode(one["data"]), f"<{one['type']}")


def test_numbers_are_read_back_to_the_precision_that_is_said() -> None:
    values = np.array([0.1, -1e-7, np.nan])
    np.testing.assert_array_equal(unpacked(packed(values, double=True)), values)
    np.testing.assert_array_equal(unpacked(packed(values)), values.astype(np.float32))


@pytest.mark.parametrize("count", [0, 1, 9, 10, 11, 19, 20, 21, 1000])
def test_of_many_things_at_most_so_many_are_taken_and_of_few_all(count: int) -> None:
    taken = list(range(count))[every(count, 10)]
    assert len(taken) <= 10
    assert taken[:1] == list(range(count))[:1]
    assert len(taken) == count or count > 10


def test_an_a_scan_has_its_peak_at_the_depth_of_a_fringe() -> None:
    config = load_config({"spectrum": {"samples": 300}})
    k = config.spectrum.wavenumbers()
    diameter = np.array([4.0, 5.0])
    depth = 1.39 * diameter
    intensity = 1 + np.cos(2 * depth[:, np.newaxis] * k)
    place, decibel = a_scans(config, intensity, k, diameter)
    assert decibel.max(axis=1).tolist() == [0, 0]
    step = place[1] - place[0]
    np.testing.assert_allclose(place[decibel.argmax(axis=1)], depth, atol=2 * step)
    assert place[-1] >= 4 * depth.max()
    # far from a fringe there is the window's side lobes alone
    assert decibel[0][np.abs(place - depth[0]) > 4].max() < -30


def test_an_a_scan_is_the_sum_that_a_transform_is() -> None:
    config = load_config({"processing": {"window": "hann", "centre": "mean"}})
    k = np.linspace(7.0, 9.0, 40)
    intensity = np.random.default_rng(1).random((1, 40))
    place, decibel = a_scans(config, intensity, k, np.array([1.5]))
    shaped = (intensity[0] - intensity[0].mean()) * np.hanning(40)
    shaped -= shaped.mean()
    sums = np.abs([(shaped * np.exp(-2j * z * k)).sum() for z in place])
    np.testing.assert_allclose(
        decibel[0], 20 * np.log10(np.maximum(sums / sums.max(), 1e-6)), atol=1e-6
    )


def test_a_dark_spectrum_and_one_that_is_not_known_have_no_a_scan() -> None:
    config = load_config()
    k = config.spectrum.wavenumbers()
    intensity = np.array([np.zeros(k.size), np.full(k.size, np.nan)])
    assert np.isnan(a_scans(config, intensity, k, np.array([1.0, 2.0]))[1]).all()


def test_deep_a_scans_have_no_more_points_than_a_page_takes() -> None:
    config = load_config()
    k = config.spectrum.wavenumbers()
    for diameter in (1.0, 20.0, 60.0, 300.0):
        depth, _ = a_scans(config, np.ones((1, k.size)), k, np.array([diameter]))
        assert depth.size <= plots.MOST_DEPTHS + 1


def test_a_page_has_the_run_s_values(plain: Path, stages: dict[str, xr.Dataset]) -> None:
    values = values_of(shown_of(run_in(plain)))
    spectra, slopes, paths = (stages[name] for name in ("spectra", "phase_slope", "paths"))
    columns = values["slope"]["columns"]
    np.testing.assert_array_equal(unpacked(values["diameter"]), spectra["diameter"])
    for name in ("phase_slope", "ideal_phase_slope"):
        np.testing.assert_array_equal(unpacked(columns[name]), slopes[name])
    step = values["spectra"]["every"]
    expected = spectra["intensity"].values[:, ::step].astype(np.float32)
    np.testing.assert_array_equal(unpacked(values["spectra"]["intensity"]), expected.ravel())
    assert values["paths"]["names"] == paths["path"].values[:8].tolist()
    shares = paths["share"].transpose("path", "diameter").values[:8].astype(np.float32)
    np.testing.assert_array_equal(unpacked(values["paths"]["share"]), shares.ravel())
    mean, scatter = (
        float(slopes[name]) for name in ("mean_phase_slope", "phase_slope_standard_deviation")
    )
    assert unpacked(values["slope"]["low"]).tolist() == [mean - scatter] * 2
    assert values["traces"] == []


def test_the_band_is_a_calibration_s_standard_error_where_there_is_one(full: Path) -> None:
    values = values_of(shown_of(run_in(full)))
    with xr.open_dataset(full / "calibration.nc") as table:
        slope = table["fixed_focus_phase_slope"].values
        error = table["fixed_focus_phase_slope_standard_error"].values
        np.testing.assert_array_equal(unpacked(values["slope"]["high"]), slope + error)
        np.testing.assert_array_equal(unpacked(values["slope"]["band_diameter"]), table["diameter"])
    (trace,) = values["traces"]
    with xr.open_dataset(full / "expansion.nc") as found:
        np.testing.assert_array_equal(unpacked(trace["change"]), found["expansion"])
        np.testing.assert_allclose(unpacked(trace["time"]), 1e3 * found["time"].values, rtol=1e-15)
