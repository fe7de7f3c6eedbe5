"""Phases over the diameter: their local slope, the line through them, and how far they jump."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.phase.derivatives import wrapped
from octsim.phase.slopes import gradient, line_slope

Array = NDArray[np.float64]


class OverDiameter(NamedTuple):
    """What phases are over the diameter; leading axes are those of the phases."""

    slope: Array
    """Local, by central differences, (..., D), mrad/nm."""
    line: Array
    """Of the straight line through the phase, (...), mrad/nm."""
    scatter: Array
    """Root mean square of the local slope less that, (...), mrad/nm."""


def over_diameter(diameter: Array, phase: Array, predicted: float) -> OverDiameter:
    """Differentiate phases (..., D) over diameters (D,), µm; phases that are NaN are left out.

    Parameters
    ----------
    diameter, phase : ndarray
    predicted : float
        Slope that is about the phases', mrad/nm: what they turn by beyond it from one diameter to
        the next is less than half a turn.
    """
    turned = wrapped(phase - predicted * diameter)
    steps = wrapped(np.diff(turned, axis=-1))
    slope = predicted + np.moveaxis(gradient(np.moveaxis(steps, -1, 0), diameter), 0, -1)
    rows = turned.reshape(-1, diameter.size)
    line = np.array([predicted + _line(diameter, row) for row in rows]).reshape(phase.shape[:-1])
    return OverDiameter(slope, line, root_mean_square(slope - line[..., np.newaxis]))


def _line(diameter: Array, turned: Array) -> float:
    """Return the slope of the line through phases that turn slowly, by least squares."""
    known = np.isfinite(turned)
    return line_slope(diameter[known], np.unwrap(turned[known]))


def root_mean_square(values: Array) -> Array:
    """Return the root mean square over the last axis of what is known; NaN if nothing is."""
    return np.asarray(np.sqrt(mean_of_known(values**2)))


def mean_of_known(values: Array) -> Array:
    """Return the mean over the last axis of what is no NaN; NaN if nothing is."""
    known = np.isfinite(values)
    count = known.sum(axis=-1)
    total = np.where(known, values, 0.0).sum(axis=-1)
    return np.asarray(total / np.where(count > 0, count, np.nan))


def jumps(phase: Array, limit: Array) -> Array:
    """Return how far phases (..., D) jump beyond those of their limit, rms, (...), rad.

    It is the second difference of what they are apart: of evenly spaced diameters it leaves out
    what changes steadily, and so is of rays that come and go.
    """
    apart = wrapped(phase - limit)
    return root_mean_square(wrapped(np.diff(wrapped(np.diff(apart, axis=-1)), axis=-1)))
