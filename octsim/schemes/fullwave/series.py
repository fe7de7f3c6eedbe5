"""The field between its nodes: a Chebyshev series in the wavenumber, and the phase put back."""

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from octsim.schemes.light import Waves


def nodes(band: tuple[float, float], number: int) -> NDArray[np.float64]:
    """Return the Chebyshev nodes of the first kind in a band, increasing, (N,)."""
    middle, half = (band[0] + band[1]) / 2, (band[1] - band[0]) / 2
    return middle - half * np.cos(np.pi * (np.arange(number) + 0.5) / number)


def coefficients(values: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return the Chebyshev coefficients (N, ...) of values at the nodes, (..., N)."""
    number = values.shape[-1]
    angle = np.pi * (np.arange(number)[::-1] + 0.5) / number
    cosines = np.cos(np.outer(np.arange(number), angle)) * (2 / number)
    cosines[0] /= 2
    # one node after the other, not by a library whose rounding hangs on the shapes
    turned = np.moveaxis(values, -1, 0)
    found = np.zeros_like(turned)
    for node in range(number):
        found += cosines[:, node].reshape(-1, *[1] * (turned.ndim - 1)) * turned[node]
    return found


def over_band(
    waves: Waves, values: NDArray[np.complex128], wavenumber: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Return a field, given at the nodes without the phase that was taken out, with it.

    Parameters
    ----------
    waves : Waves
        Whose nodes and optical path these are.
    values : ndarray, shape (..., N)
        At the nodes.
    wavenumber : ndarray, shape (K,)
        Where it is asked for, 1/µm.

    Returns
    -------
    ndarray, shape (..., K)
    """
    number = len(waves.wavenumber)
    if not number:
        return np.full((*values.shape[:-1], wavenumber.size), complex(np.nan, np.nan))
    # the nodes' own ends, so that nothing else has to be kept
    outermost = np.cos(np.pi / (2 * number))
    first, last = waves.wavenumber[0], waves.wavenumber[-1]
    middle, half = (first + last) / 2, (last - first) / 2 / outermost if number > 1 else 1.0
    smooth = chebyshev.chebval((wavenumber - middle) / half, coefficients(values))
    phase = wavenumber * waves.optical_path_length
    cosine, sine = np.cos(phase), np.sin(phase)
    field = np.empty(smooth.shape, np.complex128)
    # real arithmetic, as the rounding of complex products hangs on a value's place in memory
    field.real = smooth.real * cosine - smooth.imag * sine
    field.imag = smooth.real * sine + smooth.imag * cosine
    return field
