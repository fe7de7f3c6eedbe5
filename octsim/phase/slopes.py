"""Phase slopes: how phases change with the diameter, by differences."""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from octsim.phase.derivatives import wrapped

_DEGREE = 4


class PhaseSlopes(NamedTuple):
    """Phase slopes of a sweep over D diameters with C components, in rad/µm = mrad/nm."""

    component: NDArray[np.int64]
    """Strongest component, (D,); never the constant one, which has no phase."""
    by_component: NDArray[np.float64]
    """Slope of each component, (D, C)."""
    strongest: NDArray[np.float64]
    """Slope of the strongest component, (D,)."""


def phase_steps(phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return by how much phases (D, ...) turn from one to the next, (D − 1, ...), in [−π, π].

    This is the step of the unwrapped phase, but as it adds nothing up it does not depend on where a
    sweep begins.
    """
    return wrapped(np.diff(phase, axis=0))


def gradient(step: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Differentiate by central differences, one-sided at both ends, as `numpy.gradient` does.

    Parameters
    ----------
    step : ndarray, shape (N − 1, ...)
        Steps of the function from each place to the next.
    x : ndarray, shape (N,)
        The places, increasing.
    """
    width = np.diff(x).reshape(-1, *(1,) * (step.ndim - 1))
    slope = step / width
    left, right = width[:-1], width[1:]
    inner = (right * slope[:-1] + left * slope[1:]) / (left + right)
    return np.concatenate((slope[:1], inner, slope[-1:]))


def phase_slopes(
    diameter: NDArray[np.float64], magnitude: NDArray[np.float64], phase: NDArray[np.float64]
) -> PhaseSlopes:
    """Differentiate phases over the diameter, by central differences of the unwrapped phase.

    Parameters
    ----------
    diameter : ndarray, shape (D,)
        Increasing diameters, µm.
    magnitude, phase : ndarray, shape (D, C)
        Magnitude and phase (rad) of each component.
    """
    component = 1 + magnitude[:, 1:].argmax(axis=1)
    by_component = gradient(phase_steps(phase), diameter)
    strongest = np.take_along_axis(by_component, component[:, np.newaxis], axis=1)[:, 0]
    return PhaseSlopes(component, by_component, strongest)


def slope_of(diameter: NDArray[np.float64], phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Differentiate phases (D,) over diameters (D,), µm, by central differences."""
    return gradient(phase_steps(phase), diameter)


def line_slope(diameter: NDArray[np.float64], phase: NDArray[np.float64]) -> float:
    """Return the slope of the line through phases (D,) by least squares; NaN ones are left out."""
    known = np.isfinite(phase)
    if known.sum() < 2:
        return np.nan
    return float(np.polyfit(diameter[known], phase[known], 1)[0])


def trend(diameter: NDArray[np.float64], slope: NDArray[np.float64]) -> NDArray[np.float64]:
    """Fit a polynomial of the fourth degree over the diameter to slopes by least squares, (D,)."""
    degree = min(_DEGREE, slope.size - 1)
    fitted: NDArray[np.float64] = Polynomial.fit(diameter, slope, degree)(diameter)
    return fitted
