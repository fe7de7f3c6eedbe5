"""Chebyshev nodes of a band, and what turns values there into coefficients."""

from functools import cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray


def nodes_within(first: float, last: float, number: int) -> NDArray[np.float64]:
    """Return the Chebyshev nodes of the first kind between two wavenumbers, increasing, (M,)."""
    return (last + first) / 2 + (last - first) / 2 * chebyshev.chebpts1(number)


@cache
def to_coefficients(number: int) -> NDArray[np.float64]:
    """Return the matrix (M, M) that turns values at as many nodes into Chebyshev coefficients."""
    values = chebyshev.chebvander(chebyshev.chebpts1(number), number - 1)
    made = np.asarray(np.linalg.inv(values), np.float64)
    made.setflags(write=False)
    return made
