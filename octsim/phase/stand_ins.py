"""Numbers that stand for none, where a program had to write one."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
BEYOND = 1e20
"""Magnitude that nothing measured here reaches; fill values are 1e20, 9.97e36 and the like."""
_CODES = (
    999.0, 9999.0, 99999.0, 999999.0, 32767.0, 32768.0, 2147483647.0, 2147483648.0, 4294967295.0,
)  # fmt: skip
"""What instruments and other programs write, with either sign, for no value."""
_APART = 10.0
"""How many times farther from zero than all else such a code stands out."""
_GAP, _FEWEST = 2.0, 8
"""Or, beside at least so many others, how many of their spreads it is from the nearest of them."""


def stand_ins(values: Array) -> NDArray[np.bool_]:
    """Mark the numbers of columns that stand for none.

    These are numbers beyond `BEYOND`, and a usual code for no value, such as -999, where it stands
    out of its column: ten times farther from zero than everything else, two of the others' spreads
    or more from the nearest, or alone negative.

    Parameters
    ----------
    values : ndarray, shape (..., N)
        As they stand in the file, in its own unit; NaN and infinities are not marked.

    Returns
    -------
    ndarray of bool, shape (..., N)
    """
    finite = np.isfinite(values) & (np.abs(values) < BEYOND)
    marked: NDArray[np.bool_] = np.isfinite(values) & ~finite
    for code in _CODES:
        for value in (code, -code):
            here = values == value
            if here.any():
                marked |= here & _apart(values, value, finite & ~here)
    return marked


def _apart(values: Array, code: float, others: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Mark the columns out of whose other values a code stands, (..., 1)."""
    count = others.sum(axis=-1, keepdims=True)
    least = np.where(others, values, np.inf).min(axis=-1, keepdims=True, initial=np.inf)
    most = np.where(others, values, -np.inf).max(axis=-1, keepdims=True, initial=-np.inf)
    with np.errstate(invalid="ignore"):  # of columns without others, which count none
        farther = abs(code) > _APART * np.maximum(np.abs(least), np.abs(most))
        gap = np.maximum(least - code, code - most)
        distant = gap > _GAP * (most - least)
    alone = (code < 0) & (least >= 0)
    out: NDArray[np.bool_] = (count > 0) & farther | (count >= _FEWEST) & (distant | alone)
    return out
