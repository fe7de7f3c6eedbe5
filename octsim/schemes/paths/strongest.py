"""In which order the paths of a point are integrated: the one of the largest field comes first."""

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray


@register_jitable
def strongest_first(
    wide: NDArray[np.float64], close: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the order of two surveys' paths, and the sums of what follows each, itself included.

    By insertion, as numpy's sorts take long to compile. Of equal ones the first comes first.
    """
    num = wide.size + close.size
    bounds, order, rest = np.empty(num), np.empty(num, np.int64), np.empty(num + 1)
    for p in range(num):
        bound, k = wide[p] if p < wide.size else close[p - wide.size], p
        while k > 0 and bounds[k - 1] < bound:
            bounds[k], order[k] = bounds[k - 1], order[k - 1]
            k -= 1
        bounds[k], order[k] = bound, p
    rest[num] = 0.0
    for k in range(num - 1, -1, -1):
        rest[k] = rest[k + 1] + bounds[k]
    return order, rest
