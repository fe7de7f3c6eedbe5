"""The band: wavenumbers at which a source's light is looked at."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def wavenumbers(shortest: float, longest: float, samples: int) -> "NDArray[np.float64]":
    """Return wavenumbers 2π/λ, evenly spaced and increasing, shape (samples,), in 1/µm.

    Parameters
    ----------
    shortest, longest : float
        Wavelengths in vacuum at both ends of the band, µm; both are included.
    samples : int
        Number of wavenumbers.
    """
    import numpy as np  # here, as reading a config needs none of it

    return np.linspace(2 * np.pi / longest, 2 * np.pi / shortest, samples)
