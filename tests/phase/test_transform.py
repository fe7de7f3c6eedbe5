"""From spectra to the phase slope: known phases come back, and the thesis's processing is met."""

import json

import numpy as np
import pytest
import reference

import octsim
from octsim.config.load import load_config
from octsim.config.processing import Processing
from octsim.optics.two_beams import ideal_spectra, predicted_phase_slope
from octsim.phase.slopes import phase_slopes
from octsim.phase.transform import centred, fourier_components, optical_depths, windowed
from octsim.stages.fourier import PhaseStatus

CONFIG = load_config()
K = CONFIG.spectrum.wavenumbers()
DIAMETERS = np.linspace(1, 2, 151)


def test_a_whole_number_of_oscillations_has_its_phase_at_the_first_sample() -> None:
    n = np.arange(1000)
    for component, phase in ((3, 0.7), (10, -2.0)):
        spectrum = 5 + np.cos(2 * np.pi * component * n / 1000 + phase)
        found = fourier_components(spectrum, Processing(window="boxcar"))
        assert np.abs(found).argmax() == component
        assert np.angle(found[component]) == pytest.approx(phase, abs=1e-9)
        assert abs(found[component]) == pytest.approx(500, rel=1e-9)


def test_processing_is_the_literal_one() -> None:
    spectra = ideal_spectra(1.39, DIAMETERS[::30], K) ** 3 + 0.2
    magnitude, phase = (
        np.abs(fourier_components(spectra, CONFIG.processing)),
        np.angle(fourier_components(spectra, CONFIG.processing)),
    )
    for i, spectrum in enumerate(spectra):
        expected = reference.fft_phase(spectrum)
        assert np.allclose(magnitude[i], expected[0], atol=1e-10)
        # a component that is only rounding has no phase to speak of
        loud = expected[0] > 1e-6 * expected[0].max()
        assert np.allclose(np.exp(1j * phase[i])[loud], np.exp(1j * expected[1])[loud], atol=1e-6)


def test_centring_on_the_midpoint_or_the_mean() -> None:
    spectrum = np.array([[1.0, 2.0, 6.0]])
    assert centred(spectrum, "midpoint").tolist() == [[-2.5, -1.5, 2.5]]
    assert centred(spectrum, "mean").tolist() == [[-2.0, -1.0, 3.0]]


def test_the_window_is_the_symmetric_one() -> None:
    assert np.allclose(windowed(np.ones(1000), "hamming"), np.hamming(1000), atol=1e-15)


def test_depth_is_that_of_the_oscillation_on_a_component() -> None:
    depth = optical_depths(K)
    spectrum = np.cos(2 * depth[7] * (K - K[0]))
    assert np.abs(fourier_components(spectrum, Processing(window="boxcar"))).argmax() == 7
    assert depth[0] == 0
    assert depth[1] == pytest.approx(np.pi / (K[-1] - K[0]) * 999 / 1000)


def test_the_prediction_is_the_thesis_s() -> None:
    assert predicted_phase_slope(1.39, K[0], K[-1]) == pytest.approx(23.140, abs=5e-4)


def test_ideal_spectra_slope_about_the_prediction() -> None:
    found = fourier_components(ideal_spectra(1.39, DIAMETERS, K), CONFIG.processing)
    slopes = phase_slopes(DIAMETERS, np.abs(found), np.angle(found))
    # the numbers of a plain reading
    assert slopes.strongest.mean() == pytest.approx(23.138, abs=1e-3)
    assert slopes.strongest.std() == pytest.approx(0.168, abs=1e-3)
    literal = reference.phase_slopes(ideal_spectra(1.39, DIAMETERS, K), DIAMETERS.tolist())
    assert np.allclose(slopes.strongest, literal.slope, atol=1e-9)
    assert np.array_equal(slopes.component, literal.component)


def test_a_linear_phase_has_its_slope_whatever_its_wraps() -> None:
    diameter = np.linspace(1, 2, 50)
    phase = np.angle(np.exp(1j * np.outer(diameter, [0.0, 23.14, -80.0])))
    magnitude = np.tile([9.0, 2.0, 1.0], (50, 1))
    slopes = phase_slopes(diameter, magnitude, phase)
    assert np.allclose(slopes.by_component, [0, 23.14, -80.0], atol=1e-9)
    assert np.all(slopes.component == 1)
    assert np.allclose(slopes.strongest, 23.14)


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
