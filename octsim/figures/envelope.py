"""Long series as a figure can show them: the extremes of each column of pixels, and no more."""

import numpy as np
import pandas as pd
from numpy.typing import NDArray

COLUMNS = 1000
"""More than the columns of pixels of any axes."""

Floats = NDArray[np.float64]


def columns(x: Floats) -> NDArray[np.int64]:
    """Return the column in which each place (N,) is drawn, from 0 to COLUMNS − 1.

    Where there are too few for two of them to share one, each has its own.
    """
    if x.size <= 2 * COLUMNS:
        return np.arange(x.size)
    column: NDArray[np.int64] = (COLUMNS / (float(np.ptp(x)) or 1.0) * (x - x[0])).astype(np.int64)
    return np.minimum(column, COLUMNS - 1)


def extremes(x: Floats, y: Floats) -> NDArray[np.int64]:
    """Return the numbers of the samples that a line through all would be seen by.

    Of each column, those of the least and of the largest value, and the first that is not known,
    as a line has a gap there; and both ends.

    Parameters
    ----------
    x, y : array of float, shape (N,)
        Places, increasing, and values.

    Returns
    -------
    array of int, shape (M,)
        In increasing order, at most three for each column.
    """
    values = pd.Series(y)
    column = pd.Series(columns(x))
    known = values.dropna().groupby(column)
    gaps = column[values.isna()].drop_duplicates()
    ends = [0, x.size - 1] if x.size else []
    kept = np.concatenate((known.idxmin(), known.idxmax(), gaps.index, ends))
    return np.unique(kept).astype(np.int64)


def band(x: Floats, low: Floats, high: Floats) -> tuple[Floats, Floats, Floats]:
    """Return places, and least and largest values there, between which a band of all is seen.

    Parameters
    ----------
    x, low, high : array of float, shape (N,)
        Places, increasing, and both edges of the band.

    Returns
    -------
    tuple of array
        The same for each column, (M,); of the samples themselves where they are few.
    """
    by = pd.DataFrame({"x": x, "low": low, "high": high}).groupby(columns(x))
    one = by.agg({"x": "mean", "low": "min", "high": "max"})
    return one["x"].to_numpy(), one["low"].to_numpy(), one["high"].to_numpy()
