"""Gauss–Legendre nodes, each number of them found once."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import roots_legendre


@lru_cache(1024)
def gauss_legendre(number: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return nodes in −1 … 1 and their weights, not to be written to."""
    nodes, weights = roots_legendre(number)
    nodes.flags.writeable = weights.flags.writeable = False
    return nodes, weights
