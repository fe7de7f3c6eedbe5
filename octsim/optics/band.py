"""The band: wavenumbers at which a source's light is looked at."""

import numpy as np
from numpy.typing import NDArray


def wavenumbers(shortest: float, longest: float, samples: int) -> NDArray[np.float64]:
    """Return wavenumbers 2π/λ, evenly spaced and increasing, shape (samples,), in 1/µm.

    Parameters
    ----------
    shortest, longest : float
        Wavelengths in vacuum at both ends of the band, µm; both are included.
    samples : int
        Number of wavenumbers.
    """
    return np.linspace(2 * np.pi / longest, 2 * np.pi / shortest, samples)
