"""Phases of a series: spectra of one neuron, by an estimator whose settings are held."""

import numpy as np

from octsim.config.processing import Processing
from octsim.phase.estimators.by_name import phases
from octsim.phase.estimators.estimate import Array
from octsim.phase.transform import fourier_components, without_source


def series_phases(
    intensity: Array, wavenumber: Array, depth: float, processing: Processing,
    source: Array | None = None,
) -> Array:  # fmt: skip
    """Estimate the phases of a series, which is of one optical depth as far as is known.

    Of fft it is that of one component, the strongest of all spectra together, as phases of two
    can't be compared.

    Parameters
    ----------
    intensity : ndarray, shape (T, K)
        Spectra.
    wavenumber : ndarray, shape (K,)
        Wavenumbers, 1/µm.
    depth : float
        Nominal optical depth n_neuron · diameter, µm.
    processing : Processing
        Which estimator, with which options.
    source : ndarray, shape (K,), optional
        The source's power; None of a flat one.

    Returns
    -------
    ndarray, shape (T,)
        Phases, rad, wrapped or not: of fft at the first wavenumber, of others at the middle one.
    """
    if processing.estimator == "fft":
        components = fourier_components(without_source(intensity, source), processing)
        strongest = 1 + int(np.abs(components[:, 1:]).sum(axis=0).argmax())
        return np.angle(components[:, strongest])
    depths = np.full(len(intensity), depth)
    return phases(intensity, wavenumber, depths, processing, source).phase
