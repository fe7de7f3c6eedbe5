"""Matrices 2 × 2 of arrays: what E_y and H_y do to each other, element by element."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


def matrix(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Return [[a, b], [c, d]], (2, 2, ...)."""
    found = np.empty((2, 2, *a.shape), np.complex128)
    found[0, 0], found[0, 1], found[1, 0], found[1, 1] = a, b, c, d
    return found


def times(left: Array, right: Array) -> Array:
    """Return the product of 2 × 2 matrices, their first two axes."""
    (a, b), (c, d) = left
    (e, f), (g, h) = right
    return matrix(a * e + b * g, a * f + b * h, c * e + d * g, c * f + d * h)


def solved(of: Array, right: Array) -> Array:
    """Return of⁻¹ right, of 2 × 2 matrices."""
    (a, b), (c, d) = of
    found: Array = times(matrix(d, -b, -c, a), right) / (a * d - b * c)
    return found
