"""The band: wavenumbers of the source's spectrum."""

import numpy as np
from numpy.typing import NDArray

from octsim.config.models import Spectrum


def wavenumbers(spectrum: Spectrum) -> NDArray[np.float64]:
    """Wavenumbers 2π/λ of the samples, evenly spaced and increasing, shape (K,), in 1/µm."""
    band = spectrum.wavelength
    return np.linspace(2 * np.pi / band.max, 2 * np.pi / band.min, spectrum.samples)
