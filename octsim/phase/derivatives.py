"""Derivatives by finite differences that are checked: two steps have to agree."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FRACTIONS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
"""Where a function is known for its derivative, in steps; two steps are in it, one and a half."""


class Derivative(NamedTuple):
    """A derivative and an estimate of its error, of the same shape."""

    value: Array
    error: Array


def wrapped(angle: Array) -> Array:
    """Take whole turns off angles (rad): what is left is in [−π, π]."""
    nearest: Array = angle - 2 * np.pi * np.rint(angle / (2 * np.pi))
    return nearest


def phase_advance(before: NDArray[np.complex128], after: NDArray[np.complex128]) -> Array:
    """Return by how much the phase moves from one complex number to another, in (−π, π]."""
    return np.angle(after * before.conj())


def stencil(at: float, step: float, least: float = -np.inf, most: float = np.inf) -> Array:
    """Return five evenly spaced changes around 0, shape (5,), from −step to step.

    Where ``at`` plus a change would leave the range from `least` to `most` they are moved as a
    whole, by no more than it takes.
    """
    offsets = step * FRACTIONS
    moved: Array = offsets + max(0.0, least - (at + offsets[0])) + min(0.0, most - at - offsets[-1])
    return moved


def derivative(offsets: Array, values: Array) -> Derivative:
    r"""Differentiate at 0 what is known at five changes, (5,) and (5, ...), of shape (...).

    The value is that of the polynomial through all five, which for changes that are even about 0
    is Richardson's extrapolation of the central differences D over one and over half a step,

    .. math:: (4 D(h/2) - D(h)) / 3 = f'(0) + O(h^4),

    the error how far that through every second one is from it: D(h) itself, for even changes. That
    is of a coarser rule than the value, so it is on the safe side.
    """
    # a quarter of a second to import, which only those who need it should wait for
    from scipy.interpolate import KroghInterpolator

    fine = KroghInterpolator(offsets, values).derivative(0.0)
    coarse = KroghInterpolator(offsets[::2], values[::2]).derivative(0.0)
    return Derivative(np.asarray(fine), np.abs(fine - coarse))


def phase_derivative(phasor: Callable[[float], NDArray[np.complex128]], step: float) -> Derivative:
    """Differentiate the phase of phasors at a point, as `derivative` does.

    Parameters
    ----------
    phasor : callable
        Phasors, of any shape, when their parameter is moved by some amount.
    step : float
        Half of the differences' width; the phase moves by less than π over it.
    """
    offsets = step * FRACTIONS
    here = phasor(0.0)
    phases = [phase_advance(here, phasor(by) if by else here) for by in offsets.tolist()]
    return derivative(offsets, np.stack(phases))
