"""How well a lab must know a thing in a scene: what of it moves the slope by a fraction."""

from collections.abc import Sequence
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from octsim.studies.detector.over_diameter import mean_of_known, root_mean_square
from octsim.studies.scenes.cases import Case
from octsim.studies.validity.errors import ESTIMATORS, FOCUS_MODES

Array = NDArray[np.float64]
TOLERANCE = 0.01
"""Of the slope at a held focus, rms over the diameters."""
_HELD, _SINUSOID = FOCUS_MODES.index("held"), ESTIMATORS.index("sinusoid")


class ToleratedStatus(IntEnum):
    """Whether it is known how well a lab must know a thing."""

    KNOWN = 0
    NO_OTHER_CASE = 1
    """There is no other case of the quantity to compare with."""
    NO_SLOPE = 2
    """At no diameter both cases have a slope by the scheme."""
    NO_CHANGE = 3
    """The slope is the same in both."""


def tolerated_status(every: Sequence[Case], slope: Array) -> NDArray[np.int64]:
    """Return the `ToleratedStatus` of each case, (case, scheme), of slopes as `tolerated` takes."""
    held = slope[:, :, _HELD, _SINUSOID]
    found = np.full(held.shape[:2], ToleratedStatus.NO_OTHER_CASE)
    for row, case in enumerate(every):
        if other := _beside(every, row, case):
            off = held[other[0]] - held[row]
            found[row] = np.where(
                np.isfinite(off).any(axis=-1), ToleratedStatus.NO_CHANGE, ToleratedStatus.NO_SLOPE
            )
            found[row][root_mean_square(off) > 0] = ToleratedStatus.KNOWN
    return found


def _beside(every: Sequence[Case], row: int, case: Case) -> list[int]:
    """Return the rows of the next case of the same quantity, and of the one before."""
    return [
        other for other in (row + 1, row - 1)
        if 0 < other < len(every) and every[other].quantity == case.quantity
    ]  # fmt: skip


def tolerated(every: Sequence[Case], slope: Array) -> Array:
    """Return how much more or less of each case's quantity moves the held slope by `TOLERANCE`.

    By the difference to the next case of the same quantity, or to the one before.

    Parameters
    ----------
    every : sequence of Case
    slope : ndarray, shape (case, scheme, mode, estimator, D)
        Slopes, mrad/nm.

    Returns
    -------
    ndarray, shape (case, scheme)
        In the case's unit; NaN where `tolerated_status` says why.
    """
    held = slope[:, :, _HELD, _SINUSOID]
    found = np.full(held.shape[:2], np.nan)
    for row, case in enumerate(every):
        beside = _beside(every, row, case)
        if not beside:
            continue
        step = every[beside[0]].value - case.value
        rate = (held[beside[0]] - held[row]) / step
        rms = root_mean_square(rate)
        mean = np.abs(mean_of_known(np.where(np.isfinite(rate), held[row], np.nan)))
        found[row] = np.where(rms > 0, TOLERANCE * mean / np.where(rms > 0, rms, 1.0), np.nan)
    return found
