"""Noise of a measured spectrum: photons are counted, and each sample is read out."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def expected_counts(intensity: Array, photons: float) -> Array:
    """Scale spectra (..., K) so that one is expected to hold a number of photons, as a mean.

    The scale is the same for all, so what changes in their brightness stays.
    """
    counts: Array = intensity * (photons / intensity.sum(axis=-1).mean())
    return counts


def shot_noise(intensity: Array, photons: float, generator: np.random.Generator) -> Array:
    """Count the photons of spectra (..., K): Poisson, with `photons` in one as a mean."""
    counts: Array = generator.poisson(expected_counts(intensity, photons)).astype(float)
    return counts


def measured_counts(
    intensity: Array, photons: float, read_noise: float, generator: np.random.Generator
) -> Array:
    """Draw noisy spectra: Poisson counts of photons, and normal read noise on each sample.

    Parameters
    ----------
    intensity : ndarray, shape (..., K)
        Noise-free spectra, in any unit.
    photons : float
        Expected number of photons detected in a spectrum, over all samples, as a mean.
    read_noise : float
        Standard deviation of a dark sample, in photons.
    generator : numpy.random.Generator
        Where the draws come from; its seed makes them again.

    Returns
    -------
    ndarray, shape (..., K)
        Counts of photons; with read noise they can be negative.
    """
    counts = shot_noise(intensity, photons, generator)
    return counts + read_noise * generator.standard_normal(counts.shape)


def signal_to_noise(intensity: Array, photons: float, read_noise: float) -> Array:
    r"""Return the signal-to-noise ratio of spectra (..., K), as a ratio of powers, shape (...).

    .. math:: \mathrm{SNR} = \frac{\sum_k (\mu_k - \bar\mu)^2}{2\,\overline{(\mu_k + \sigma^2)}}

    with the expected counts μ: for a fringe, the power of the peak of its depth profile over the
    mean power of the noise there, as in optical coherence tomography. The phase of a weak
    fringe is then known to 1/√(2 SNR) (Park et al. 2005, doi:10.1364/OPEX.13.003931, whose
    differences of two phases have √2 times that).
    """
    counts = expected_counts(intensity, photons)
    fringe = ((counts - counts.mean(axis=-1, keepdims=True)) ** 2).sum(axis=-1)
    ratio: Array = fringe / (2 * (counts.mean(axis=-1) + read_noise**2))
    return ratio


def photons_for(intensity: Array, ratio: float, read_noise: float) -> float:
    """Return the photons in a spectrum (K,) whose signal-to-noise ratio (of powers) is as asked.

    The ratio is a N² / (N/K + σ²), which is solved for N.
    """
    samples = intensity.shape[-1]
    # of one photon without read noise: a K
    strength = float(signal_to_noise(intensity, 1.0, 0.0)) / samples
    linear = ratio / samples
    root = np.sqrt(linear**2 + 4 * strength * ratio * read_noise**2)
    return float((linear + root) / (2 * strength))
