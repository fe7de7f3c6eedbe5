"""The Fourier transform of the spectra: a literal sum, and which components have a phase."""

import cmath
import json

import numpy as np
import pytest
import reference
import xarray as xr

import octsim
from octsim.config.load import load_config
from octsim.stages.fourier import PhaseStatus


def test_components_are_a_literal_sum_over_the_samples(stages: dict[str, xr.Dataset]) -> None:
    signal = reference.preprocess(stages["spectra"]["intensity"].values[2]).tolist()
    found, num = stages["fourier"].isel(diameter=2), len(signal)
    assert found.sizes["component"] == num // 2 + 1
    for component in (1, 2, 3, 17, 500):
        turn = -2j * cmath.pi * component / num
        expected = sum(value * cmath.exp(turn * n) for n, value in enumerate(signal))
        one = found.sel(component=component)
        tolerance = 1e-12 * float(found["magnitude"].max())
        assert float(one["magnitude"]) == pytest.approx(abs(expected), abs=tolerance)
        assert float(one["magnitude"]) * cmath.exp(1j * float(one["phase"])) == pytest.approx(
            expected, abs=tolerance
        )
        assert one["phase_status"] == PhaseStatus.KNOWN


def test_a_component_s_depth_is_half_the_length_that_turns_it_once_more_over_the_band(
    stages: dict[str, xr.Dataset],
) -> None:
    k, depth = stages["spectra"]["wavenumber"].values, stages["fourier"]["depth"].values
    # samples are periodic after the last but one step: N steps of k
    period = k.size * (k[-1] - k[0]) / (k.size - 1)
    assert depth == pytest.approx(np.arange(depth.size) * np.pi / period, rel=1e-12)


def test_a_component_of_rounding_alone_has_no_phase_and_says_so() -> None:
    overlay = {"spectrum": {"samples": 64}, "sweep": {"diameters": {"num": 4}}}
    config = load_config(overlay, {"sweep": {"focus": {"slope": 0.58, "intercept": "69 nm"}}})
    spectra = octsim.spectra(config, octsim.detections(config))
    # a whole number of oscillations has two components without a window; the rest is rounding
    pure = 2 + np.cos(2 * np.pi * 3 * np.arange(64) / 64)
    spectra["intensity"][1] = pure
    spectra["intensity"][2] = np.nan
    spectra.attrs["config"] = json.dumps(
        json.loads(spectra.attrs["config"]) | {"processing": {"window": "boxcar"}}
    )
    plain = load_config(config.to_dict(), {"processing": {"window": "boxcar"}})
    found = octsim.fourier(plain, spectra)
    status, phase = found["phase_status"], found["phase"].values
    assert status.attrs["flag_meanings"] == "known below_rounding no_spectrum"
    assert (np.isnan(phase) == (status.values != PhaseStatus.KNOWN)).all()
    assert np.flatnonzero(status.values[1] == PhaseStatus.KNOWN).tolist() == [3]
    assert (status.values[2] == PhaseStatus.NO_SPECTRUM).all()
    for row in (0, 3):
        assert np.flatnonzero(status.values[row]).tolist() == [0]
    slopes = octsim.phase_slope(plain, found)
    assert np.isnan(slopes["component_phase_slope"].values[:, 0]).all()
