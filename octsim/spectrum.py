"""From detected rays to the spectrum that the detector gives."""

import numpy as np
from numpy.typing import NDArray

from octsim.compiled import compiled
from octsim.config import Spectrum

# A phasor is set anew after so many steps, so that rounding does not add up over long spectra.
_STRETCH = 128


def wavenumbers(spectrum: Spectrum) -> NDArray[np.float64]:
    """Wavenumbers 2π/λ of the samples, evenly spaced and increasing, shape (K,), in 1/µm."""
    band = spectrum.wavelength
    return np.linspace(2 * np.pi / band.max, 2 * np.pi / band.min, spectrum.samples)


@compiled(fastmath={"reassoc", "contract"})
def _field(
    amplitude: NDArray[np.float64],
    optical_path_length: NDArray[np.float64],
    first: float,
    step: float,
    num: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    real, imaginary = np.zeros(num), np.zeros(num)
    turn_cos, turn_sin = np.cos(step * optical_path_length), np.sin(step * optical_path_length)
    for begin in range(0, num, _STRETCH):
        phase = (first + begin * step) * optical_path_length
        cos, sin = amplitude * np.cos(phase), amplitude * np.sin(phase)
        for k in range(begin, min(begin + _STRETCH, num)):
            sum_cos, sum_sin = 0.0, 0.0
            for j in range(amplitude.size):
                c, s = cos[j], sin[j]
                sum_cos += c
                sum_sin += s
                cos[j] = c * turn_cos[j] - s * turn_sin[j]
                sin[j] = c * turn_sin[j] + s * turn_cos[j]
            real[k] = sum_cos
            imaginary[k] = sum_sin
    return real, imaginary


def intensity(
    amplitude: NDArray[np.float64],
    optical_path_length: NDArray[np.float64],
    wavenumber: NDArray[np.float64],
) -> NDArray[np.float64]:
    r"""Sum the fields of detected rays to the intensity at each wavenumber.

    .. math:: I(k) = \left| \sum_j E_j e^{i k \Lambda_j} \right|^2

    (thesis §4.4), by a recurrence :math:`e^{i(k + \Delta k)\Lambda} = e^{ik\Lambda}
    e^{i\Delta k\Lambda}` over evenly spaced wavenumbers.

    Parameters
    ----------
    amplitude : ndarray, shape (D,)
        Amplitudes E of the rays.
    optical_path_length : ndarray, shape (D,)
        Their optical path lengths Λ, µm.
    wavenumber : ndarray, shape (K,)
        Evenly spaced wavenumbers, 1/µm.

    Returns
    -------
    ndarray, shape (K,)
        Intensity; 1 is all of the launched light in phase.
    """
    num = wavenumber.size
    step = (wavenumber[-1] - wavenumber[0]) / max(num - 1, 1)
    real, imaginary = _field(amplitude, optical_path_length, wavenumber[0], step, num)
    squared: NDArray[np.float64] = real * real + imaginary * imaginary
    return squared
