"""From detected rays to the spectrum that the detector gives, and its error."""

import math

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.compiled import compiled
from octsim.schemes.light import Field

# A phasor is set anew after so many steps, so that rounding does not add up over long spectra.
_STRETCH = 128
_SPARSE = 64  # wavenumbers at which an error is looked for
_MOST_NODES = 64  # along k, of one light path


def relative_error(largest_field: float, field_error: float) -> float:
    r"""Give max :math:`|\Delta I|` / max :math:`I` for an error of the field, both magnitudes.

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
    """Sum the fields of rays at each wavenumber, (K,); parameters are those of `intensity`."""
    num = wavenumber.size
    step = (wavenumber[-1] - wavenumber[0]) / max(num - 1, 1)
    real, imaginary = _field(amplitude, optical_path_length, wavenumber[0], step, num)
    return real + 1j * imaginary


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
    return intensity_of(field(amplitude, optical_path_length, wavenumber))


def intensity_of(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return the intensity |E|² of a field, (K,)."""
    squared: NDArray[np.float64] = values.real * values.real + values.imag * values.imag
    return squared


def spectrum_of(field: Field) -> tuple[NDArray[np.float64], float]:
    """Return the intensity of a field, (K,), and the estimate of max |ΔI| / max I."""
    squared = intensity_of(field.values)
    return squared, relative_error(math.sqrt(float(squared.max())), field.error)


def field_of_rays(
    amplitude: NDArray[np.float64],
    rough_amplitude: NDArray[np.float64],
    optical_path_length: NDArray[np.float64],
    wavenumber: NDArray[np.float64],
) -> Field:
    """Sum rays one by one to a field, and estimate its error from a rougher rule.

    Parameters are those of `intensity`, with the rougher amplitudes, shape (D,).
    """
    values = field(amplitude, optical_path_length, wavenumber)
    every = max(1, wavenumber.size // _SPARSE)
    sparse = wavenumber[::every]
    step = (sparse[-1] - sparse[0]) / max(sparse.size - 1, 1)
    off = rough_amplitude - amplitude
    real, imaginary = _field(off, optical_path_length, sparse[0], step, sparse.size)
    return Field(values, float(np.hypot(real, imaginary).max()))


@register_jitable
def _add_rays(
    begin: int,
    end: int,
    amplitude: NDArray[np.float64],
    rough_amplitude: NDArray[np.float64],
    optical_path_length: NDArray[np.float64],
    first: float,
    step: float,
    real: NDArray[np.float64],
    imaginary: NDArray[np.float64],
) -> float:
    """Add some rays' fields at each wavenumber; give how far the rougher rule's is from them."""
    error = 0.0
    for k in range(real.size):
        off, off_i = 0.0, 0.0
        for j in range(begin, end):
            phase = (first + k * step) * optical_path_length[j]
            cos, sin = math.cos(phase), math.sin(phase)
            real[k] += amplitude[j] * cos
            imaginary[k] += amplitude[j] * sin
            off += (amplitude[j] - rough_amplitude[j]) * cos
            off_i += (amplitude[j] - rough_amplitude[j]) * sin
        error = max(error, math.hypot(off, off_i))
    return error


@compiled(fastmath={"reassoc", "contract"})
def _path_fields(
    first_ray: NDArray[np.int64],
    amplitude: NDArray[np.float64],
    rough_amplitude: NDArray[np.float64],
    optical_path_length: NDArray[np.float64],
    first: float,
    step: float,
    num: int,
    tolerance: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    real, imaginary, error = np.zeros(num), np.zeros(num), 0.0
    middle, half = first + 0.5 * step * (num - 1), 0.5 * step * (num - 1)
    values, coefficients = np.empty((2, _MOST_NODES)), np.empty((2, _MOST_NODES))
    turn, last, before = np.empty((2, _STRETCH)), np.empty((2, _STRETCH)), np.empty((2, _STRETCH))
    place = np.empty(_STRETCH)
    for p in range(first_ray.size - 1):
        begin, end = first_ray[p], first_ray[p + 1]
        size, mean = 0.0, 0.0
        for j in range(begin, end):
            size += abs(amplitude[j])
            mean += abs(amplitude[j]) * optical_path_length[j]
        mean = mean / size if size > 0 else optical_path_length[begin]
        spread = 0.0
        for j in range(begin, end):
            spread = max(spread, abs(optical_path_length[j] - mean))
        # Chebyshev coefficients of e^{ikΛ} fall as Bessel functions: 2 (h/2)^n / n!
        n, left_out = 1, 2 * size * 0.5 * half * spread
        while n < _MOST_NODES and left_out > tolerance:
            n += 1
            left_out *= 0.5 * half * spread / n
        if left_out > tolerance and n == _MOST_NODES:
            # paths so far apart that no few nodes hold their field: ray by ray
            error += _add_rays(
                begin, end, amplitude, rough_amplitude, optical_path_length, first, step, real,
                imaginary,
            )  # fmt: skip
            continue
        off_field = 0.0
        for i in range(n):
            k = middle + half * math.cos(math.pi * (i + 0.5) / n)
            total, total_i, off, off_i = 0.0, 0.0, 0.0, 0.0
            for j in range(begin, end):
                phase = k * (optical_path_length[j] - mean)
                cos, sin, less = math.cos(phase), math.sin(phase), amplitude[j] - rough_amplitude[j]
                total += amplitude[j] * cos
                total_i += amplitude[j] * sin
                off += less * cos
                off_i += less * sin
            values[0, i], values[1, i] = total, total_i
            off_field = max(off_field, math.hypot(off, off_i))
        error += left_out + off_field
        for a in range(n):
            scale = (1.0 if a == 0 else 2.0) / n
            coefficients[0, a], coefficients[1, a] = 0.0, 0.0
            for i in range(n):
                t = scale * math.cos(math.pi * a * (i + 0.5) / n)
                coefficients[0, a] += t * values[0, i]
                coefficients[1, a] += t * values[1, i]
        for j in range(_STRETCH):
            turn[0, j], turn[1, j] = math.cos(j * step * mean), math.sin(j * step * mean)
        for start in range(0, num, _STRETCH):
            count = min(_STRETCH, num - start)
            for j in range(count):
                place[j] = 2 * (start + j) / max(num - 1, 1) - 1
            last[:], before[:] = 0.0, 0.0
            for a in range(n - 1, 0, -1):  # Clenshaw
                c, d = coefficients[0, a], coefficients[1, a]
                for j in range(count):
                    x = c + 2 * place[j] * last[0, j] - before[0, j]
                    y = d + 2 * place[j] * last[1, j] - before[1, j]
                    before[0, j], before[1, j] = last[0, j], last[1, j]
                    last[0, j], last[1, j] = x, y
            phase = (first + start * step) * mean
            cos, sin, c, d = (
                math.cos(phase),
                math.sin(phase),
                coefficients[0, 0],
                coefficients[1, 0],
            )
            for j in range(count):
                x = c + place[j] * last[0, j] - before[0, j]
                y = d + place[j] * last[1, j] - before[1, j]
                u = cos * turn[0, j] - sin * turn[1, j]
                v = cos * turn[1, j] + sin * turn[0, j]
                real[start + j] += x * u - y * v
                imaginary[start + j] += x * v + y * u
    return real, imaginary, error


def field_of_paths(
    path: NDArray[np.int64],
    amplitude: NDArray[np.float64],
    rough_amplitude: NDArray[np.float64],
    optical_path_length: NDArray[np.float64],
    missing: float,
    wavenumber: NDArray[np.float64],
    accuracy: float,
) -> Field:
    r"""Sum light paths to a field, each interpolated in k about its mean path.

    .. math:: E(k) = \sum_p e^{ik\bar\Lambda_p} \sum_{j \in p} E_j e^{ik(\Lambda_j - \bar\Lambda_p)}

    whose inner sum is smooth in k: as many Chebyshev nodes as the accuracy needs give it at all
    wavenumbers.

    Parameters
    ----------
    path : ndarray, shape (D,)
        Code of each ray's path; the rays of a path stand together.
    amplitude, rough_amplitude, optical_path_length : ndarray, shape (D,)
        As in `field_of_rays`.
    missing : float
        Field that was left out.
    wavenumber : ndarray, shape (K,)
        Evenly spaced wavenumbers, 1/µm.
    accuracy : float
        Of which the interpolation may use a hundredth.
    """
    first_ray = np.append(np.flatnonzero(np.diff(path, prepend=-1)), path.size)
    num = wavenumber.size
    step = (wavenumber[-1] - wavenumber[0]) / max(num - 1, 1)
    tolerance = 0.01 * accuracy * _scale(first_ray, amplitude) / max(first_ray.size - 1, 1)
    real, imaginary, error = _path_fields(
        first_ray, amplitude, rough_amplitude, optical_path_length, wavenumber[0], step, num,
        tolerance,
    )  # fmt: skip
    return Field(real + 1j * imaginary, error + missing)


def _scale(first_ray: NDArray[np.int64], amplitude: NDArray[np.float64]) -> float:
    """Give the largest of the paths' summed amplitudes."""
    if amplitude.size == 0:
        return 0.0
    return float(np.abs(np.add.reduceat(amplitude, first_ray[:-1])).max())
