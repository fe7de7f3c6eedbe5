"""Falloffs of the detected amplitude as compiled code takes them, each by its type.

The distance is that from the axis over the radius within which light is accepted.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload, register_jitable
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from octsim.optics.detector import falloff
from octsim.optics.falloff import Falloff, Parabolic
from octsim.schemes.band_nodes import to_coefficients

_MOST_COEFFICIENTS = 60
_LEFT_OUT = 1e-14


class Parabola(NamedTuple):
    """The thesis's."""

    edge: float = 0.0
    """Amplitude where it ends."""


class Series(NamedTuple):
    """A falloff as a series over the square of the distance."""

    coefficients: NDArray[np.float64]
    """Of Chebyshev's polynomials on 0 … 1, (C,)."""
    edge: float
    """Amplitude where it ends."""


@cache
def series_of(model: Falloff, reach: float, wavenumber: float) -> Parabola | Series:
    """Return a falloff for compiled code.

    Parameters
    ----------
    model : Falloff
    reach : float
        Radius within which light is accepted, over R_det.
    wavenumber : float
        1/µm.
    """
    if model == Parabolic():
        return Parabola()

    def over_square(place: NDArray[np.float64]) -> NDArray[np.float64]:
        return model.amplitude((place + 1) / 2 * reach**2, wavenumber)

    coefficients = to_coefficients(_MOST_COEFFICIENTS) @ over_square(
        chebyshev.chebpts1(_MOST_COEFFICIENTS)
    )
    there = np.flatnonzero(np.abs(coefficients) > _LEFT_OUT)
    edge = float(over_square(np.ones(1))[0])
    return Series(coefficients[: there.max(initial=0) + 1].copy(), edge)


def falloff_at(model: Parabola | Series, squared: float, and_squared: float) -> float:
    """Return a falloff at a distance whose square is given in two parts, those of x and y.

    Beyond the edge, where a rougher map may put light, a series is what it is there.
    """
    if isinstance(model, Series):
        return _sum(model.coefficients, min(squared + and_squared, 1.0))
    return falloff(squared, and_squared)


@register_jitable
def _sum(coefficients: NDArray[np.float64], squared: float) -> float:
    """Sum Chebyshev's polynomials on 0 … 1 (by Clenshaw)."""
    last, before = 0.0, 0.0
    twice = 4 * squared - 2
    for a in range(coefficients.size - 1, 0, -1):
        last, before = coefficients[a] + twice * last - before, last
    total: float = coefficients[0] + 0.5 * twice * last - before
    return total


# by the type of the model, when code is compiled: the thesis's is as if there were no other
@overload(falloff_at, strict=False)
def _compile_falloff_at(model: Any, squared: Any, and_squared: Any) -> Callable[..., Any]:  # noqa: ARG001
    if model.instance_class is Series:
        return lambda model, squared, and_squared: _sum(
            model.coefficients, min(squared + and_squared, 1.0)
        )
    return lambda model, squared, and_squared: falloff(squared, and_squared)  # noqa: ARG005
