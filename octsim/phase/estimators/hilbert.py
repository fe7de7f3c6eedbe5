"""The phase of the analytic signal: transform, keep a band of depths, transform back."""

import numpy as np

from octsim.config.processing import Processing
from octsim.phase.estimators.estimate import Array, Phases, middle
from octsim.phase.transform import optical_depths, prepared

_ZEROS = 8
"""How many times as many samples are transformed, the rest of them zeros."""


def hilbert(intensity: Array, wavenumber: Array, depth: Array, processing: Processing) -> Phases:
    r"""Fit a line to the phase of the analytic signal over the band.

    .. math:: a(k) = 2\int_{(1-b)z}^{(1+b)z} \hat I(z') e^{2iz'k} dz', \quad
        \arg a(k) \approx \phi + 2z(k - k_{mid})

    by least squares with the weights :math:`|a|^2` (Takeda, Ina and Kobayashi 1982,
    doi:10.1364/JOSA.72.000156; the half plane of positive depths alone is the Hilbert transform).

    Parameters
    ----------
    intensity : ndarray, shape (D, K)
        Spectra.
    wavenumber : ndarray, shape (K,)
        Evenly spaced wavenumbers, 1/µm.
    depth : ndarray, shape (D,)
        Optical depths in the middle of the band that is kept, µm.
    processing : Processing
        Its centre and window, and ``hilbert.band``, b.
    """
    num = _ZEROS * wavenumber.size
    components = np.fft.rfft(prepared(intensity, processing), num, axis=1)
    off = np.abs(optical_depths(wavenumber, num) / depth[:, np.newaxis] - 1)
    kept = np.where(off <= processing.hilbert.band, components, 0)
    # the full transform with no negative depths
    signal = np.fft.ifft(kept, num, axis=1)[:, : wavenumber.size]
    return _line(np.unwrap(np.angle(signal), axis=1), np.abs(signal) ** 2, wavenumber)


def _line(phase: Array, weights: Array, wavenumber: Array) -> Phases:
    """Fit lines to phases (D, K) by weighted least squares: value at the middle, half the slope."""
    x = wavenumber - middle(wavenumber)
    total = weights.sum(axis=1)
    mean_x, mean_phase = (weights * x).sum(axis=1) / total, (weights * phase).sum(axis=1) / total
    from_mean = x - mean_x[:, np.newaxis]
    slope = (weights * from_mean * phase).sum(axis=1) / (weights * from_mean**2).sum(axis=1)
    return Phases(mean_phase - slope * mean_x, slope / 2)
