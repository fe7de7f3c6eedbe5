"""Spectra to components: known phases come back, and the thesis's processing is met."""

import numpy as np
import pytest
import reference

from octsim.config.load import load_config
from octsim.config.processing import Processing
from octsim.optics.two_beams import ideal_spectra
from octsim.phase.transform import centred, fourier_components, optical_depths, windowed

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
