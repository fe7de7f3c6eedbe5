"""Dispersion in the formulas: eq. (2) with the index at both ends, depths by the group index."""

import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.optics.materials import Cauchy, Constant, group_index
from octsim.optics.two_beams import ideal_spectra, predicted_phase_slope

NEURON = Cauchy((1.3815, 0.004, 0.00012))
K = np.linspace(2 * np.pi / 0.9, 2 * np.pi / 0.65, 400)
MIDDLE = float(K[0] + K[-1]) / 2


def rest_at(depth: float, spectrum: NDArray[np.float64]) -> float:
    """Return what a sinusoid of a held depth leaves of a spectrum."""
    columns = np.stack([np.cos(2 * depth * K), np.sin(2 * depth * K)], axis=1)
    return float(np.linalg.lstsq(columns, spectrum, rcond=None)[1][0])


@pytest.mark.parametrize("diameter", [1.0, 2.0, 5.0])
def test_the_depth_of_a_fringe_is_by_the_group_index(diameter: float) -> None:
    # d(nk)/dk is how fast the phase 2 n d k turns over the band
    (spectrum,) = ideal_spectra(NEURON, np.array([diameter]), K)
    depths = np.linspace(1.3, 1.5, 2001) * diameter
    best = depths[np.argmin([rest_at(one, spectrum) for one in depths])] / diameter
    group, phase = group_index(NEURON, MIDDLE), NEURON.index(MIDDLE).real
    assert best == pytest.approx(group, abs=4e-3 / diameter)
    assert abs(group - phase) > 0.01


def test_the_phase_moves_as_the_ends_of_the_band_predict() -> None:
    diameters = np.linspace(2.0, 2.2, 41)
    spectra = ideal_spectra(NEURON, diameters, K) * np.hamming(K.size)
    depth = group_index(NEURON, MIDDLE) * 2.1
    phase = np.unwrap(np.angle(spectra @ np.exp(-2j * depth * K)))
    slope = abs(np.polyfit(diameters, phase, 1)[0])
    assert slope == pytest.approx(predicted_phase_slope(NEURON, K[0], K[-1]), rel=1e-3)


def test_a_constant_index_is_the_thesiss_formula() -> None:
    constant = Constant(1.39)
    assert predicted_phase_slope(constant, 7.0, 9.0) == 1.39 * 16.0
    assert group_index(constant, 8.0) == 1.39
