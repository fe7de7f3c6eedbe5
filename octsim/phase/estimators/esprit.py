"""ESPRIT: the exponentials that a spectrum is a sum of, from shifted pieces of it."""

import numpy as np
from numpy.typing import NDArray

from octsim.config.processing import Processing
from octsim.phase.estimators.estimate import Array, Phases, middle

_BLOCKS = 64
"""Fewest means of neighbouring samples that stand for a spectrum, where it has as many."""
_PER_OSCILLATION = 8
_NEAR = 0.5
"""How far the oscillation's depth may be from the one expected, over that."""


def esprit(intensity: Array, wavenumber: Array, depth: Array, processing: Processing) -> Phases:
    r"""Find the oscillation among a few exponentials by the rotational invariance of their span.

    .. math:: I_j = \sum_m a_m p_m^j, \quad U_{\uparrow} \Psi = U_{\downarrow}, \quad
        p_m = \mathrm{eig}\,\Psi, \quad z = \frac{\arg p}{2\Delta k}

    with U the first left singular vectors of the Hankel matrix of means of neighbouring samples
    (Roy and Kailath 1989, doi:10.1109/29.32276). A pole off the unit circle is an amplitude that
    grows or falls over the band. The a are then fitted by least squares; of the poles near the
    depth, the one with the largest is the oscillation.

    Parameters
    ----------
    intensity : ndarray, shape (D, K)
        Spectra.
    wavenumber : ndarray, shape (K,)
        Evenly spaced wavenumbers, 1/µm.
    depth : ndarray, shape (D,)
        Optical depths that are expected, µm.
    processing : Processing
        Its ``esprit.poles``.
    """
    found = np.empty((2, depth.size))
    size = _block_sizes(wavenumber, depth)
    for one in np.unique(size):
        rows = size == one
        found[:, rows] = _oscillation(intensity[rows], wavenumber, depth[rows], processing, one)
    return Phases(*found)


def _block_sizes(wavenumber: Array, depth: Array) -> NDArray[np.int64]:
    """Return how many neighbouring samples have one mean, of each spectrum (D,)."""
    band = wavenumber[-1] - wavenumber[0]
    wanted = np.maximum(_BLOCKS, (_PER_OSCILLATION * depth * band / np.pi).astype(int))
    sizes: NDArray[np.int64] = np.maximum(1, wavenumber.size // wanted)
    return sizes


def _oscillation(
    intensity: Array, wavenumber: Array, depth: Array, processing: Processing, size: int
) -> Phases:
    """Find the oscillation of spectra whose means are of as many samples."""
    means, at, within = _block_means(intensity, wavenumber, size)
    poles = _poles(means, processing.esprit.poles)
    step = at[1] - at[0]
    # in logarithms, as a wild pole's powers overflow
    growth = np.log(np.where(poles == 0, np.finfo(float).tiny, poles)) / step
    x = at - middle(wavenumber)
    exponents = growth[:, np.newaxis, :] * x[:, np.newaxis]
    limited = np.clip(exponents.real, -50, 50) + 1j * exponents.imag
    amplitude = (np.linalg.pinv(np.exp(limited)) @ means[..., np.newaxis])[..., 0]
    depths = growth.imag / 2
    near = np.abs(depths / depth[:, np.newaxis] - 1) < _NEAR
    chosen = np.where(near, np.abs(amplitude), -1.0).argmax(axis=1)
    rows = np.arange(depth.size)
    found = near[rows, chosen]
    # a mean over neighbours turns an exponential that grows or falls
    turn = np.exp(np.multiply.outer(growth[rows, chosen], within)).mean(axis=1)
    return Phases(
        np.where(found, np.angle(amplitude[rows, chosen] / turn), np.nan),
        np.where(found, depths[rows, chosen], np.nan),
    )


def _block_means(intensity: Array, wavenumber: Array, size: int) -> tuple[Array, Array, Array]:
    """Average neighbouring samples.

    Returns
    -------
    means : ndarray, shape (D, N)
        Their means.
    at : ndarray, shape (N,)
        Wavenumbers in the middle of each.
    within : ndarray, shape (S,)
        Places of the samples of one, from its middle.
    """
    num = wavenumber.size // size
    used = slice((wavenumber.size - num * size) // 2, None)
    blocks = intensity[:, used][:, : num * size].reshape(-1, num, size)
    places = wavenumber[used][: num * size].reshape(num, size)
    at = places.mean(axis=1)
    return blocks.mean(axis=2), at, places[0] - at[0]


def _poles(series: Array, num: int) -> NDArray[np.complex128]:
    """Find the poles (D, M) of series (D, N) of evenly spaced samples."""
    hankel = np.lib.stride_tricks.sliding_window_view(series, series.shape[1] // 2, axis=1)
    vectors, _, _ = np.linalg.svd(hankel, full_matrices=False)
    span = vectors[:, :, :num]
    turn = np.linalg.pinv(span[:, :-1]) @ span[:, 1:]
    return np.linalg.eigvals(turn).astype(complex)
