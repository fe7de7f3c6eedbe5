"""Sums of the fields of light paths, each interpolated in k about its mean optical path."""

import math

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.compiled import compiled
from octsim.schemes.light import Field
from octsim.tracing.light_paths import first_rays

_STRETCH = 128  # wavenumbers in a row, between phases set anew
_MOST_NODES = 64  # along k, of one light path


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
    """Add some rays' fields at each wavenumber; return how far the rougher rule's is from them."""
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


@register_jitable
def _about(
    begin: int, end: int, amplitude: NDArray[np.float64], optical_path_length: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Return the summed amplitude of some rays, their mean path and how far it spreads."""
    size, mean = 0.0, 0.0
    for j in range(begin, end):
        size += abs(amplitude[j])
        mean += abs(amplitude[j]) * optical_path_length[j]
    mean = mean / size if size > 0 else optical_path_length[begin]
    spread = 0.0
    for j in range(begin, end):
        spread = max(spread, abs(optical_path_length[j] - mean))
    return size, mean, spread


@register_jitable
def _nodes_for(size: float, half: float, spread: float, tolerance: float) -> tuple[int, float]:
    """Return the number of nodes that a tolerance needs, and what they leave out.

    Chebyshev coefficients of e^{ikΛ} fall as Bessel functions: 2 (h/2)^n / n!, where h is the
    spread of Λ times half of the band.
    """
    n, left_out = 1, 2 * size * 0.5 * half * spread
    while n < _MOST_NODES and left_out > tolerance:
        n += 1
        left_out *= 0.5 * half * spread / n
    return n, left_out


@register_jitable
def _fit(
    begin: int, end: int, amplitude: NDArray[np.float64], rough_amplitude: NDArray[np.float64],
    optical_path_length: NDArray[np.float64], mean: float, middle: float, half: float, n: int,
    values: NDArray[np.float64], coefficients: NDArray[np.float64],
) -> float:  # fmt: skip
    """Fill in the coefficients of a path's field in k; return how far the rougher rule's is off."""
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
    for a in range(n):
        scale = (1.0 if a == 0 else 2.0) / n
        coefficients[0, a], coefficients[1, a] = 0.0, 0.0
        for i in range(n):
            t = scale * math.cos(math.pi * a * (i + 0.5) / n)
            coefficients[0, a] += t * values[0, i]
            coefficients[1, a] += t * values[1, i]
    return off_field


@register_jitable
def _add_fitted(
    coefficients: NDArray[np.float64], n: int, mean: float, first: float, step: float,
    real: NDArray[np.float64], imaginary: NDArray[np.float64],
) -> None:  # fmt: skip
    """Add a path's field at each wavenumber, from its coefficients (by Clenshaw)."""
    num = real.size
    turn, last, before = np.empty((2, _STRETCH)), np.empty((2, _STRETCH)), np.empty((2, _STRETCH))
    place = np.empty(_STRETCH)
    for j in range(_STRETCH):
        turn[0, j], turn[1, j] = math.cos(j * step * mean), math.sin(j * step * mean)
    for start in range(0, num, _STRETCH):
        count = min(_STRETCH, num - start)
        for j in range(count):
            place[j] = 2 * (start + j) / max(num - 1, 1) - 1
        last[:], before[:] = 0.0, 0.0
        for a in range(n - 1, 0, -1):
            c, d = coefficients[0, a], coefficients[1, a]
            for j in range(count):
                x = c + 2 * place[j] * last[0, j] - before[0, j]
                y = d + 2 * place[j] * last[1, j] - before[1, j]
                before[0, j], before[1, j] = last[0, j], last[1, j]
                last[0, j], last[1, j] = x, y
        phase = (first + start * step) * mean
        cos, sin, c, d = math.cos(phase), math.sin(phase), coefficients[0, 0], coefficients[1, 0]
        for j in range(count):
            x = c + place[j] * last[0, j] - before[0, j]
            y = d + place[j] * last[1, j] - before[1, j]
            u = cos * turn[0, j] - sin * turn[1, j]
            v = cos * turn[1, j] + sin * turn[0, j]
            real[start + j] += x * u - y * v
            imaginary[start + j] += x * v + y * u


@compiled(fastmath={"reassoc", "contract"})
def _field_of_paths(
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
    for p in range(first_ray.size - 1):
        begin, end = first_ray[p], first_ray[p + 1]
        size, mean, spread = _about(begin, end, amplitude, optical_path_length)
        n, left_out = _nodes_for(size, half, spread, tolerance)
        if left_out > tolerance and n == _MOST_NODES:
            # paths so far apart that no few nodes hold their field: ray by ray
            error += _add_rays(
                begin, end, amplitude, rough_amplitude, optical_path_length, first, step, real,
                imaginary,
            )  # fmt: skip
            continue
        error += left_out + _fit(
            begin, end, amplitude, rough_amplitude, optical_path_length, mean, middle, half, n,
            values, coefficients,
        )  # fmt: skip
        _add_fitted(coefficients, n, mean, first, step, real, imaginary)
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
    r"""Return the field of light paths, each interpolated in k about its mean path.

    .. math:: E(k) = \sum_p e^{ik\bar\Lambda_p} \sum_{j \in p} E_j e^{ik(\Lambda_j - \bar\Lambda_p)}

    whose inner sum is smooth in k: as many Chebyshev nodes as the accuracy needs give it at all
    wavenumbers.

    Parameters
    ----------
    path : ndarray, shape (D,)
        Code of each ray's path; the rays of a path stand together.
    amplitude, rough_amplitude, optical_path_length : ndarray, shape (D,)
        As in `octsim.schemes.field_sum.field_of_rays`.
    missing : float
        Field that was left out.
    wavenumber : ndarray, shape (K,)
        Evenly spaced wavenumbers, 1/µm.
    accuracy : float
        Of which the interpolation may use a hundredth.
    """
    first_ray = np.append(first_rays(path), path.size)
    num = wavenumber.size
    step = (wavenumber[-1] - wavenumber[0]) / max(num - 1, 1)
    tolerance = 0.01 * accuracy * _scale(first_ray, amplitude) / max(first_ray.size - 1, 1)
    real, imaginary, error = _field_of_paths(
        first_ray, amplitude, rough_amplitude, optical_path_length, wavenumber[0], step, num,
        tolerance,
    )  # fmt: skip
    return Field((real + 1j * imaginary)[np.newaxis], error + missing)


def _scale(first_ray: NDArray[np.int64], amplitude: NDArray[np.float64]) -> float:
    """Return the largest of the paths' summed amplitudes."""
    if amplitude.size == 0:
        return 0.0
    return float(np.abs(np.add.reduceat(amplitude, first_ray[:-1])).max())
