"""Samples that stand alone in a spectrum: dead pixels, cosmic rays and the like."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LEAST = 0.1
"""Departure from a curve through the neighbours, over the spectrum's range, that is looked at."""
_FACTOR = 8.0
"""How many times what is usual beside it, and in the spectrum, that departure is."""
_USUAL = 0.75
"""Share of the samples that depart by no more than is usual in the spectrum."""
_NEAR, _FAR = 3, 10
"""Samples to a side between which that is taken: nearer ones feel the lone one themselves."""
_CURVE = np.array([1, -4, 6, -4, 1]) / 6
"""A value less that of the cubic through two neighbours to each side."""


def lone(spectrum: Array) -> NDArray[np.bool_]:
    """Mark the samples of a spectrum that stand alone, or at an end of a few that do.

    Noise, a fringe of few samples and the corners of one that is cut depart from the curve on at
    least one side as well, and are none.

    Parameters
    ----------
    spectrum : ndarray, shape (K,)
        As it was measured, sample by sample.

    Returns
    -------
    ndarray of bool, shape (K,)
        False for the two samples at each end, and for all of fewer than 30.

    Examples
    --------
    >>> import numpy as np
    >>> fringe = 2000 * (1 + np.cos(np.linspace(0, 9, 200)))
    >>> fringe[120] = 65535
    >>> np.flatnonzero(lone(fringe)).tolist()
    [120]
    """
    marked = np.zeros(spectrum.size, bool)
    if spectrum.size < 3 * _FAR:
        return marked
    away = np.abs(np.convolve(spectrum, _CURVE, mode="valid"))
    reach = _FAR - _NEAR + 1
    beside = np.lib.stride_tricks.sliding_window_view(
        np.pad(away, _FAR, constant_values=np.inf), reach
    ).max(axis=1)  # of the side that is usual; beyond the ends there is none
    usual = np.minimum(beside[: away.size], beside[_FAR + _NEAR : _FAR + _NEAR + away.size])
    largest = away >= np.maximum(np.append(0, away[:-1]), np.append(away[1:], 0))
    usual = np.maximum(usual, np.quantile(away, _USUAL))
    middle = away > np.maximum(_FACTOR * usual, LEAST * _range(spectrum))
    marked[2:-2] = middle & largest
    return marked


def _range(spectrum: Array) -> float:
    """Return the range of a spectrum but for its most extreme samples."""
    low, high = np.quantile(spectrum, [0.02, 0.98])
    return float(high - low)
