"""Bessel functions of all orders at once, by recurrence."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import hankel1, hankel2, jv, y0, y1

Array = NDArray[Any]


class Cylindrical(NamedTuple):
    """A cylinder function and its derivative by the argument, of orders 0 to M: (..., M + 1)."""

    value: Array
    slope: Array


class Kinds(NamedTuple):
    """The cylinder functions of one argument."""

    regular: Cylindrical
    """J."""
    outgoing: Cylindrical
    """The Hankel function of the first kind, J + iY."""
    incoming: Cylindrical
    """That of the second kind."""


def kinds(x: Array, order: int) -> Kinds:
    """Return all cylinder functions of orders 0 to M.

    Parameters
    ----------
    x : ndarray, shape (...)
        Arguments: all positive, or some of them imaginary, of waves that decay.
    order : int
        M.
    """
    if np.isrealobj(x):
        outgoing = hankel(x, order)
        regular = Cylindrical(outgoing.value.real, outgoing.slope.real)
        return Kinds(regular, outgoing, second_hankel(outgoing))
    every = np.arange(order + 2)
    return Kinds(*(_with_slope(f(every, x[..., np.newaxis]), x) for f in (jv, hankel1, hankel2)))


def bessel_j(x: NDArray[np.float64], order: int) -> Cylindrical:
    """Return J_m and its derivative for m = 0 … M.

    By Miller's recurrence downwards, normalised by J₀ + 2 Σ J_2m = 1.

    Parameters
    ----------
    x : ndarray, shape (...)
        Positive arguments.
    order : int
        M.
    """
    largest = max(float(x.max()), order + 1.0)
    start = int(largest + 12 * largest ** (1 / 3)) + 16
    start += start % 2
    above, here = np.zeros_like(x), np.full_like(x, 1e-30)
    total = 2 * here
    kept = np.zeros((*x.shape, order + 2))
    for m in range(start, 0, -1):
        above, here = here, (2 * m / x) * here - above
        # a small argument's orders grow without bounds: all of them are scaled alike
        large = np.abs(here) > 1e200
        if large.any():
            scale = np.where(large, 1e-200, 1.0)
            above, here, total = above * scale, here * scale, total * scale
            kept *= scale[..., np.newaxis]
        if m - 1 <= order + 1:
            kept[..., m - 1] = here
        if (m - 1) % 2 == 0:
            total = total + (here if m == 1 else 2 * here)
    return _with_slope(kept / total[..., np.newaxis], x)


def hankel(x: NDArray[np.float64], order: int) -> Cylindrical:
    """Return the Hankel function of the first kind, J + iY, and its derivative, m = 0 … M.

    Y by its recurrence upwards. Parameters are those of `bessel_j`.
    """
    second = np.empty((*x.shape, order + 2))
    second[..., 0], second[..., 1] = y0(x), y1(x)
    for m in range(1, order + 1):
        second[..., m + 1] = (2 * m / x) * second[..., m] - second[..., m - 1]
    first, y = bessel_j(x, order), _with_slope(second, x)
    return Cylindrical(first.value + 1j * y.value, first.slope + 1j * y.slope)


def second_hankel(of: Cylindrical) -> Cylindrical:
    """Return the Hankel function of the second kind of the same real arguments as a first one."""
    return Cylindrical(of.value.conj(), of.slope.conj())


def _with_slope(values: Array, x: Array) -> Cylindrical:
    """Return functions of orders 0 … M from those up to M + 1: Z′_m = (m / x) Z_m − Z_{m+1}."""
    value = values[..., :-1]
    orders = np.arange(value.shape[-1])
    slope = orders / x[..., np.newaxis] * value - values[..., 1:]
    return Cylindrical(value, slope)
