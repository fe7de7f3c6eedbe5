"""Samples that stand alone: outliers of a measured series."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from octsim.phase.measured_series import Series
from octsim.phase.rest_error import smallest_step

NEIGHBOURS = 2
"""Samples to each side that one is compared with; what moves for longer is no outlier."""
THRESHOLD = 5.0
"""Distance from their median, in standard deviations, from which a sample is one."""
_NORMAL = 1.4826
"""Standard deviation of a normal law over the median of its absolute deviations."""


class Standing(IntEnum):
    """Whether a sample stands alone."""

    AMONG_OTHERS = 0
    ALONE = 1


def outliers(series: Series) -> NDArray[np.bool_]:
    """Mark the outliers of a series, by a Hampel filter.

    A sample is one if it is farther from the median of itself and its neighbours than
    `THRESHOLD` standard deviations: the largest of that which the neighbours' median deviation
    stands for, that of all steps from sample to sample, its own phase_error, and the rounding of
    the recorder. Edges and slopes, which move the median too, are none.

    Parameters
    ----------
    series : Series

    Returns
    -------
    ndarray of bool, shape (T,)
        False where a phase is missing, and for all of fewer than five.

    Notes
    -----
    R. K. Pearson, *IEEE Trans. Control Syst. Technol.* **10**, 55-63 (2002).
    """
    marked = np.zeros(series.phase.size, bool)
    there = np.flatnonzero(np.isfinite(series.phase))
    if there.size <= 2 * NEIGHBOURS:
        return marked
    phase = np.unwrap(series.phase[there])
    beside = np.lib.stride_tricks.sliding_window_view(
        np.pad(phase, NEIGHBOURS, mode="reflect"), 2 * NEIGHBOURS + 1
    )
    middle = np.median(beside, axis=1)
    local = np.median(np.abs(beside - middle[:, np.newaxis]), axis=1)
    steps = np.median(np.abs(np.diff(phase))) / np.sqrt(2)
    rounding = smallest_step(series.phase) / np.sqrt(12)
    spread = np.fmax(_NORMAL * np.maximum(local, steps), rounding)  # NaN if no step is seen
    if series.phase_error is not None:
        spread = np.maximum(spread, series.phase_error[there])
    marked[there] = np.abs(phase - middle) > THRESHOLD * spread
    return marked
