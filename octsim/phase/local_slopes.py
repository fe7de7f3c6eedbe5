"""The phase slope at single diameters, of a few spectra around each."""

import numpy as np

from octsim.config.processing import Processing
from octsim.phase.estimators.by_name import phases
from octsim.phase.estimators.estimate import Array
from octsim.phase.slopes import phase_slopes, slope_of
from octsim.phase.transform import fourier_components, without_source


def local_slope(
    intensity: Array, wavenumber: Array, diameter: Array, index: float, processing: Processing,
    source: Array | None = None,
) -> float:  # fmt: skip
    """Return the phase slope at the middle one of three diameters, as a sweep over them has it.

    Parameters
    ----------
    intensity : ndarray, shape (3, K)
        Spectra.
    wavenumber : ndarray, shape (K,)
        Wavenumbers, 1/µm.
    diameter : ndarray, shape (3,)
        Increasing diameters, µm.
    index : float
        Of the neuron, for its nominal optical depth.
    processing : Processing
        Which estimator, with which options; all but maximum likelihood.
    source : ndarray, shape (K,), optional
        The source's power; None of a flat one.

    Returns
    -------
    float
        mrad/nm.
    """
    if processing.estimator == "fft":
        components = fourier_components(without_source(intensity, source), processing)
        slopes = phase_slopes(diameter, np.abs(components), np.angle(components)).strongest
    else:
        found = phases(intensity, wavenumber, index * diameter, processing, source)
        slopes = slope_of(diameter, found.phase)
    return float(slopes[1])
