"""Which errors of an intensity hide a fringe that is smaller than they are."""

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.light import AccuracyStatus

_NOTHING = 10.0
"""Error, over the largest intensity, of counted rays that are nothing but chance; a few hundred
rays with a fringe state errors of 3."""


def hiding_error(error: NDArray[np.float64], status: NDArray[np.integer]) -> NDArray[np.float64]:
    """Return the errors (D,) that a fringe has to be above, over the largest intensity.

    Counted rays are off by about the same at all wavenumbers, so that their fringe can be far
    smaller than the error that they state; but where that is far above all of the light, as behind
    crossed polarisers, there is nothing else.

    Parameters
    ----------
    error : ndarray, shape (D,)
        Estimated, over the largest intensity.
    status : ndarray, shape (D,)
        `AccuracyStatus` of each.
    """
    counted = (status == AccuracyStatus.NOT_CONTROLLED) & ~(error > _NOTHING)
    return np.where(counted, 0.0, error)
