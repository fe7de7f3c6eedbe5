"""Samples that a camera cut: several of one spectrum at its largest, or its least, value."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SEVERAL = 4
"""Samples of one extreme value that may be cut; three of whole numbers happen by chance."""
_STEPS = 4  # of the converter, below the largest value
_MORE = 2.0


def are_cut(intensity: Array) -> NDArray[np.bool_]:
    """Return which spectra have samples that are cut, at the top or at the bottom.

    They stand on the extreme value in a number, `SEVERAL` and twice that of the samples on the next
    four steps of the converter, or more: a smooth maximum that is only rounded has fewer there. The
    step is the least difference of two values. What is cut by less than some steps is not seen,
    nor what was changed sample by sample since.

    Parameters
    ----------
    intensity : ndarray, shape (D, K)
        Spectra as the camera gives them, not interpolated.

    Returns
    -------
    ndarray, shape (D,)

    Examples
    --------
    >>> import numpy as np
    >>> fringe = 2000 * (1 + np.cos(np.linspace(0, 9, 200)))
    >>> are_cut(np.stack([fringe, np.minimum(fringe, 3500)])).tolist()
    [False, True]
    """
    return np.array([_is_cut(one) or _is_cut(-one) for one in intensity], bool)


def _is_cut(spectrum: Array) -> bool:
    values, counts = np.unique(spectrum, return_counts=True)
    if counts[-1] < SEVERAL or values.size == 1:
        return False
    step = np.diff(values).min()
    below = counts[:-1][values[:-1] >= values[-1] - _STEPS * step].sum()
    return bool(counts[-1] >= SEVERAL + _MORE * below)
