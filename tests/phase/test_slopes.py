"""Phases to their slopes over the diameter: known slopes come back, and the thesis's are met."""

import numpy as np
import pytest
import reference

from octsim.config.load import load_config
from octsim.optics.two_beams import ideal_spectra, predicted_phase_slope
from octsim.phase.slopes import phase_slopes
from octsim.phase.transform import fourier_components

CONFIG = load_config()
K = CONFIG.spectrum.wavenumbers()
DIAMETERS = np.linspace(1, 2, 151)


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
