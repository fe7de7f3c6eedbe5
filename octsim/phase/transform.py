"""The Fourier transform of spectra, after centring and windowing (thesis §5)."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.config.processing import Processing

Array = NDArray[np.float64]
Named = str | tuple[Any, ...]
"""A window of scipy.signal: its name, or that and its parameters."""


def window_samples(window: Named, num: int) -> Array:
    """Return a symmetric window of scipy.signal.windows, shape (num,)."""
    # half a second to import, which only those who need it should wait for
    from scipy.signal import get_window

    samples: Array = get_window(window, num, fftbins=False)
    return samples


def _polynomial(intensity: Array, weights: Array, degree: int) -> Array:
    """Fit a polynomial over the samples by weighted least squares, (..., K)."""
    columns = np.polynomial.legendre.legvander(np.linspace(-1, 1, intensity.shape[-1]), degree)
    root = np.sqrt(np.abs(weights))  # those of a flat top are negative at the ends
    onto = np.linalg.pinv(columns * root[:, np.newaxis]) * root
    fitted = np.zeros_like(intensity)
    # a product of matrices, or einsum, sums in an order that depends on how many spectra there are
    for column, part in zip(columns.T, onto, strict=True):
        fitted += (intensity * part).sum(axis=-1, keepdims=True) * column
    return fitted


_CENTRES: Mapping[str, Callable[[Array, Array, int], Array]] = {
    "midpoint": lambda spectra, _, __: (
        (spectra.max(axis=-1, keepdims=True) + spectra.min(axis=-1, keepdims=True)) / 2
    ),
    "mean": lambda spectra, _, __: spectra.mean(axis=-1, keepdims=True),
    "weighted": lambda spectra, weights, _: (
        (spectra * weights).sum(axis=-1, keepdims=True) / weights.sum()
    ),
    "polynomial": _polynomial,
}


def centred(intensity: Array, centre: str, window: Named = "boxcar", degree: int = 1) -> Array:
    """Subtract their centre from spectra.

    Parameters
    ----------
    intensity : ndarray, shape (..., K)
        Spectra.
    centre : str
        ``midpoint``, (max + min)/2; ``mean``; ``weighted``, the mean weighted by the window, which
        leaves no constant after windowing; or ``polynomial``, fitted with the same weights.
    window : str or tuple
        Window of scipy.signal whose samples are the weights.
    degree : int
        Of the polynomial.
    """
    # each spectrum's samples beside each other: the order in which numpy sums hangs on that
    intensity = np.ascontiguousarray(intensity)
    weights = window_samples(window, intensity.shape[-1])
    without: Array = intensity - _CENTRES[centre](intensity, weights, degree)
    return without


def without_source(intensity: Array, source: Array | None) -> Array:
    r"""Subtract from spectra (D, K) the source's own, as bright as each by least squares.

    .. math:: I - S \frac{\sum I S}{\sum S^2}

    What is left oscillates, with the source for a window. Of a flat source, None, nothing is
    subtracted: `centred` does so.
    """
    if source is None:
        return intensity
    bright = (intensity * source).sum(axis=-1, keepdims=True) / (source * source).sum()
    without: Array = intensity - bright * source
    return without


def windowed(intensity: Array, window: Named) -> Array:
    """Multiply spectra (..., K) by a symmetric window of scipy.signal.windows."""
    product: Array = intensity * window_samples(window, intensity.shape[-1])
    return product


def centred_by(intensity: Array, processing: Processing) -> Array:
    """Subtract from spectra (..., K) the centre that a processing asks for."""
    return centred(intensity, processing.centre, processing.window, processing.centre_degree)


def prepared(intensity: Array, processing: Processing) -> Array:
    """Centre spectra (..., K), multiply them by the window and subtract the mean that is left."""
    shaped = windowed(centred_by(intensity, processing), processing.window)
    shaped -= shaped.mean(axis=-1, keepdims=True)
    return shaped


def fourier_components(intensity: Array, processing: Processing) -> NDArray[np.complex128]:
    """Take the discrete Fourier transform of spectra after centring and windowing (thesis §5).

    Parameters
    ----------
    intensity : ndarray, shape (..., K)
        Spectra over evenly spaced, increasing wavenumbers.
    processing : Processing
        What to subtract, and the window. The mean is subtracted last.

    Returns
    -------
    ndarray, shape (..., K//2 + 1)
        Complex components; a spectrum cos(2ndk) has phase 2nd k_min at its first sample.
    """
    return np.fft.rfft(prepared(intensity, processing), axis=-1)


def rounding_level(intensity: Array, processing: Processing) -> Array:
    r"""Magnitude below which a component of spectra (..., K) holds nothing but rounding, (..., 1).

    .. math:: \epsilon \log_2 K \sum_j |w_j I_j|

    The error of a fast Fourier transform grows with its \log_2 K stages (Higham 2002, §24.1); the
    samples' own rounding, and that of the level that is subtracted, are as large as one of them.
    """
    shaped = np.abs(windowed(np.ascontiguousarray(intensity), processing.window))
    stages = max(1.0, float(np.log2(intensity.shape[-1])))
    level: Array = np.finfo(float).eps * stages * shaped.sum(axis=-1, keepdims=True)
    return level


def optical_depths(wavenumber: Array, samples: int | None = None) -> Array:
    """Optical depth nd (µm) at which cos(2ndk) falls on each component.

    Parameters
    ----------
    wavenumber : ndarray, shape (K,)
        Evenly spaced wavenumbers, 1/µm.
    samples : int, optional
        Number N of samples that are transformed, where zeros are appended; else K.

    Returns
    -------
    ndarray, shape (N//2 + 1,)
        Depths, µm.
    """
    step = (wavenumber[-1] - wavenumber[0]) / (wavenumber.size - 1)
    depths: Array = np.pi * np.fft.rfftfreq(samples or wavenumber.size, step)
    return depths
