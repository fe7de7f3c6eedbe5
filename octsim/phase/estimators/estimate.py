"""What every estimator gives, and the terms in which all are written."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Estimate(NamedTuple):
    """Phase and depth of D spectra.

    The oscillation is cos(2 z (k − k_mid) + phase), with k_mid the middle of the band: the phase
    there hardly depends on the depth, which few oscillations leave uncertain.
    """

    phase: Array
    """Phase at the middle of the band, (D,), rad; wrapped, or not."""
    depth: Array
    """Optical depth z, (D,), µm."""


def middle(wavenumber: Array) -> float:
    """Wavenumber (1/µm) in the middle of a band (K,)."""
    return float(wavenumber[0] + wavenumber[-1]) / 2


def place(wavenumber: Array) -> Array:
    """Place of each wavenumber (K,) in its band, from −1 to 1."""
    x: Array = (wavenumber - middle(wavenumber)) / ((wavenumber[-1] - wavenumber[0]) / 2)
    return x


def oscillation(wavenumber: Array, depth: Array) -> NDArray[np.complex128]:
    """Oscillations e^{2iz(k − k_mid)} of depths (D,), shape (D, K)."""
    waves: NDArray[np.complex128] = np.exp(
        2j * depth[:, np.newaxis] * (wavenumber - middle(wavenumber))
    )
    return waves
