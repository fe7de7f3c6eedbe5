"""Phases of a series: spectra of one neuron, by an estimator whose settings are held."""

import numpy as np

from octsim.config.processing import Processing
from octsim.phase.estimators.by_name import phases
from octsim.phase.estimators.estimate import Array
from octsim.phase.estimators.one_fit import Model, design_of, fitted
from octsim.phase.transform import fourier_components, without_source


def series_phases(
    intensity: Array, wavenumber: Array, depth: float, processing: Processing,
    source: Array | None = None,
) -> Array:  # fmt: skip
    """Estimate the phases of a series, which is of one optical depth as far as is known.

    Of fft it is that of one component, the strongest of all spectra together, as phases of two
    can't be compared. Weights of shot noise are those of the mean spectrum: ones that followed each
    spectrum would move the phase of what is no sinusoid with it.

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
    if processing.estimator == "sinusoid" and _weights_would_follow(processing):
        model = Model(wavenumber, depth, processing.sinusoid, source)
        design = design_of(model, intensity.mean(axis=0), processing.read_noise**2)
        return fitted(design, intensity, np.ones_like(wavenumber)).phase
    depths = np.full(len(intensity), depth)
    return phases(intensity, wavenumber, depths, processing, source).phase


def _weights_would_follow(processing: Processing) -> bool:
    """Return whether each spectrum would have weights of its own, and a depth that is held."""
    asked = processing.sinusoid
    held = asked.depth == "held" and processing.depth == "nominal"
    return held and asked.weights == "shot"
