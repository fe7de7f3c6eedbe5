"""Detected light: weighted rays whose fields sum to the detector's, and how sure that is."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class AccuracyStatus(IntEnum):
    """Whether the accuracy that was asked for is reached."""

    REACHED = 0
    """By the estimate of the error."""
    BUDGET_SPENT = 1
    """Stopped at the most segments that are traced for one point."""
    NOT_REACHED = 2
    """The estimate of the error stays above what was asked for."""
    NOT_CONTROLLED = 3
    """The scheme has a number of rays, and no accuracy to reach."""
    AT_AN_EDGE = 4
    """Reached by the estimate, but part of the light misses a cylinder, and what returns from near
    its edge can be missing from both."""
    NO_FOCUS = 5
    """Not traced: the focus law, which the focus was to follow, could not be fitted."""


class Light(NamedTuple):
    """Weighted rays that reach the detector, D of them, always in the same order."""

    path: NDArray[np.int64]
    """Code of the light path, (D,); `octsim.tracing.follow.path_name` reads it."""
    amplitude: NDArray[np.float64]
    """Amplitude times weight, (D,)."""
    rough_amplitude: NDArray[np.float64]
    """The same by a rougher rule, (D,): the difference of their sums estimates the error."""
    optical_path_length: NDArray[np.float64]
    """Path from the focus to the fibre, (D,), µm."""
    missing: float
    """Estimate of the field of what was left out."""
    segments: int
    """Straight pieces of ray that were traced."""
    status: AccuracyStatus
    outcomes: NDArray[np.int64] | None = None
    """How often each `octsim.optics.detector.Outcome` came about, (7,), where rays are counted."""
