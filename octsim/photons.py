"""Shot noise: spectra as counted photons."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def shot_noise(spectra: Array, photons: float, generator: np.random.Generator) -> Array:
    """Count the photons of spectra (..., K): Poisson, with `photons` in a spectrum as a mean.

    The scale is one for all spectra, so what changes in their intensity stays.
    """
    scale = photons / spectra.sum(axis=-1).mean()
    counts: Array = generator.poisson(scale * spectra).astype(np.float64)
    return counts
