"""Sums of the fields of weighted rays, one by one: Σ E e^{ikΛ}, and the intensity that it gives."""

import math

import numpy as np
from numpy.typing import NDArray

from octsim.base.compiled import compiled
from octsim.schemes.light import Field

# A phasor is set anew after so many steps, so that rounding does not add up over long spectra.
_STRETCH = 128
_SPARSE = 64  # wavenumbers at which an error is looked for


def relative_error(largest_field: float, field_error: float) -> float:
    r"""Return max :math:`|\Delta I|` / max :math:`I` for an error of the field, both magnitudes.

    .. math:: |\Delta |E|^2| \le 2 |E| |\Delta E| + |\Delta E|^2

    Without any field it is infinite, unless there is no error either.
    """
    if largest_field == 0:
        return math.inf if field_error > 0 else 0.0
    ratio = field_error / largest_field
    return 2 * ratio + ratio * ratio


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


def field(
    amplitude: NDArray[np.float64],
    optical_path_length: NDArray[np.float64],
    wavenumber: NDArray[np.float64],
) -> NDArray[np.complex128]:
    """Return the sum of rays' fields at each wavenumber, (K,); parameters are as in `intensity`."""
    num = wavenumber.size
    step = (wavenumber[-1] - wavenumber[0]) / max(num - 1, 1)
    real, imaginary = _field(amplitude, optical_path_length, wavenumber[0], step, num)
    return real + 1j * imaginary


def intensity(
    amplitude: NDArray[np.float64],
    optical_path_length: NDArray[np.float64],
    wavenumber: NDArray[np.float64],
) -> NDArray[np.float64]:
    r"""Return the intensity of detected rays at each wavenumber.

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
    return intensity_of(field(amplitude, optical_path_length, wavenumber))


def intensity_of(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return the intensity ``|E|²`` of a field, of its shape."""
    squared: NDArray[np.float64] = values.real * values.real + values.imag * values.imag
    return squared


def spectrum_of(field: Field) -> tuple[NDArray[np.float64], float]:
    """Return the intensity of a field, (K,), and the estimate of max ``|ΔI|`` / max I."""
    squared: NDArray[np.float64] = intensity_of(field.values).mean(axis=0)
    return squared, relative_error(math.sqrt(float(squared.max())), field.error)


def field_of_rays(
    amplitude: NDArray[np.float64],
    rough_amplitude: NDArray[np.float64],
    optical_path_length: NDArray[np.float64],
    wavenumber: NDArray[np.float64],
) -> Field:
    """Return the field of rays, and an estimate of its error from a rougher rule.

    Parameters are those of `intensity`, with the rougher amplitudes, shape (D,).
    """
    values = field(amplitude, optical_path_length, wavenumber)
    every = max(1, wavenumber.size // _SPARSE)
    sparse = wavenumber[::every]
    step = (sparse[-1] - sparse[0]) / max(sparse.size - 1, 1)
    off = rough_amplitude - amplitude
    real, imaginary = _field(off, optical_path_length, sparse[0], step, sparse.size)
    return Field(values[np.newaxis], float(np.hypot(real, imaginary).max()))


def field_at(
    amplitude: NDArray[np.float64], optical_path_length: NDArray[np.float64], wavenumber: float
) -> complex:
    """Return the sum of rays' fields at one wavenumber, 1/µm; 0 if there are none."""
    turns = np.exp(1j * wavenumber * optical_path_length)
    return complex((amplitude * turns).sum())


@compiled(fastmath={"contract"})
def fields_in_groups(
    group: NDArray[np.int64],
    amplitude: NDArray[np.float64],
    optical_path_length: NDArray[np.float64],
    groups: int,
    first: float,
    step: float,
    num: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the sums of the fields of groups of rays at evenly spaced wavenumbers.

    By the recurrence of `intensity`, without its fresh starts: for few wavenumbers.

    Parameters
    ----------
    group : ndarray, shape (D,)
        Number of the group that each ray is in, in any order.
    amplitude, optical_path_length : ndarray, shape (D,)
        As in `intensity`.
    groups : int
        Number of groups.
    first, step : float
        The first wavenumber and their spacing, 1/µm.
    num : int
        Number of wavenumbers.

    Returns
    -------
    real, imaginary : ndarray, shape (groups, num)
    """
    real, imaginary = np.zeros((groups, num)), np.zeros((groups, num))
    for j in range(group.size):
        reach, p = optical_path_length[j], group[j]
        cos, sin = amplitude[j] * np.cos(first * reach), amplitude[j] * np.sin(first * reach)
        turn_cos, turn_sin = np.cos(step * reach), np.sin(step * reach)
        for k in range(num):
            real[p, k] += cos
            imaginary[p, k] += sin
            cos, sin = cos * turn_cos - sin * turn_sin, cos * turn_sin + sin * turn_cos
    return real, imaginary
