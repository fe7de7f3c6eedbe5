"""Derivatives by finite differences that are checked: two steps have to agree."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import KroghInterpolator

Array = NDArray[np.float64]
FRACTIONS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
"""Where a function is known for its derivative, in steps; two steps are in it, one and a half."""


class Derivative(NamedTuple):
    """A derivative and an estimate of its error, of the same shape."""

    value: Array
    error: Array


def stencil(at: float, step: float, least: float = -np.inf, most: float = np.inf) -> Array:
    """Give five evenly spaced changes around 0, shape (5,), from −step to step.

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
    fine = KroghInterpolator(offsets, values).derivative(0.0)
    coarse = KroghInterpolator(offsets[::2], values[::2]).derivative(0.0)
    return Derivative(np.asarray(fine), np.abs(fine - coarse))
