"""The phase slope at a point: how the phase of a spectrum's beat moves with the diameter there."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_RATIO = 4  # by which the error of a central difference falls when its step is halved


class Derivative(NamedTuple):
    """A derivative (D,) with an estimate of its error (D,)."""

    value: Array
    error: Array


def advance(before: NDArray[np.complex128], after: NDArray[np.complex128]) -> Array:
    """Give by how much the phase moves from one complex number to another, in (−π, π]."""
    return np.angle(after * before.conj())


def central_slope(
    phasor: Callable[[float], NDArray[np.complex128]], step: float
) -> NDArray[np.float64]:
    """Differentiate the phase of phasors by one central difference.

    Parameters
    ----------
    phasor : callable
        Phasors (D,) when the diameters are moved by some µm.
    step : float
        Half of the difference's width, µm; the phase moves by less than π over the whole.

    Returns
    -------
    ndarray, shape (D,)
        Phase slope, rad/µm = mrad/nm.
    """
    return advance(phasor(-step), phasor(step)) / (2 * step)


def slope_at_point(phasor: Callable[[float], NDArray[np.complex128]], step: float) -> Derivative:
    r"""Differentiate the phase of phasors at a point, by Richardson's extrapolation.

    .. math:: \varphi' \approx \frac{4 D(h/2) - D(h)}{3}, \quad
       \delta \approx \frac{|D(h/2) - D(h)|}{3}

    of central differences D, whose errors fall as h². The estimate is that of D(h/2), and so an
    upper one of the extrapolated.

    Parameters are those of `central_slope`.
    """
    whole, half = central_slope(phasor, step), central_slope(phasor, step / 2)
    off = (half - whole) / (_RATIO - 1)
    return Derivative(half + off, np.abs(off))
