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


def stand_ins(values: Array) -> NDArray[np.bool_]:
    """Mark the numbers of columns that stand for none.

    These are numbers beyond `BEYOND`, and a usual code for no value, such as -999, where it is
    ten times farther from zero than everything else in its column.

    Parameters
    ----------
    values : ndarray, shape (..., N)
        As they stand in the file, in its own unit; NaN and infinities are not marked.

    Returns
    -------
    ndarray of bool, shape (..., N)
    """
    finite = np.isfinite(values)
    size = np.where(finite, np.abs(values), 0.0)
    beyond = size >= BEYOND
    size[beyond] = 0.0
    largest = size.max(axis=-1, keepdims=True, initial=0.0)
    others = finite & ~beyond & (size < largest)
    most = np.where(others, size, 0.0).max(axis=-1, keepdims=True, initial=0.0)
    coded = (
        np.isin(largest, _CODES) & others.any(axis=-1, keepdims=True) & (_APART * most < largest)
    )
    marked: NDArray[np.bool_] = beyond | (coded & (size == largest))
    return marked
