"""Estimators of a spectrum's phase, interchangeable: spectra in, phase and depth out."""

from collections.abc import Callable, Mapping

import numpy as np

from octsim.config.processing import Processing
from octsim.phase.estimators.esprit import esprit
from octsim.phase.estimators.estimate import Array, Estimate
from octsim.phase.estimators.fft import fft, peak_depths, zero_padded
from octsim.phase.estimators.fringe import fringe
from octsim.phase.estimators.hilbert import hilbert
from octsim.phase.estimators.sinusoid import sinusoid

Estimator = Callable[[Array, Array, Array, Processing], Estimate]

ESTIMATORS: Mapping[str, Estimator] = {
    "fft": fft,
    "zero_padded": zero_padded,
    "sinusoid": sinusoid,
    "hilbert": hilbert,
    "esprit": esprit,
    "fringe": fringe,
}
"""Each takes spectra (D, K), wavenumbers (K,), depths (D,) and the processing. Maximum likelihood
needs modelled spectra too: `octsim.phase.estimators.likelihood`."""


def estimate(
    intensity: Array, wavenumber: Array, nominal: Array, processing: Processing
) -> Estimate:
    """Estimate the phase of spectra as the processing says.

    Parameters
    ----------
    intensity : ndarray, shape (D, K)
        Spectra.
    wavenumber : ndarray, shape (K,)
        Evenly spaced, increasing wavenumbers, 1/µm.
    nominal : ndarray, shape (D,)
        Nominal optical depths n_neuron · diameter, µm, for ``processing.depth: nominal``.
    processing : Processing
        Which estimator, at which depth, with which options.
    """
    # each spectrum's samples beside each other: the order in which numpy sums hangs on that
    intensity = np.ascontiguousarray(intensity)
    depth = nominal
    if processing.depth == "peak":
        depth = peak_depths(intensity, wavenumber, processing)
    elif isinstance(processing.depth, float):
        depth = np.full(intensity.shape[0], processing.depth)
    return ESTIMATORS[processing.estimator](intensity, wavenumber, depth, processing)
