"""Polynomials through values at a few nodes: Chebyshev's, on an interval scaled to 0 … 1."""

from functools import cache

import numpy as np
from numba.extending import register_jitable
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

HIGHEST = 24
"""Most nodes along one axis."""
_OFF = 1e-8


FIT, LOOK = 0, 1
"""Kinds of nodes: where polynomials fit best, and where a patch near an axis is seen best."""


@cache
def tables(symmetric: bool) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    r"""Return nodes of each kind and number n, and what turns values there into coefficients.

    To fit, they are those of Clenshaw and Curtis, :math:`(1 - \cos(\pi i / (n - 1))) / 2`; to look,
    along the square of a coordinate, they are the squares of evenly spaced numbers. The ends are a
    little off 0 and 1: functions are divided by what is zero there.

    Returns
    -------
    nodes : ndarray, shape (2, HIGHEST + 1, HIGHEST)
        ``nodes[kind, n, :n]`` are n nodes.
    transforms : ndarray, shape (2, HIGHEST + 1, HIGHEST, HIGHEST)
        ``transforms[kind, n, :n, :n] @ values`` are the coefficients of :math:`T_m(2c - 1)`.
    """
    nodes = np.zeros((2, HIGHEST + 1, HIGHEST))
    transforms = np.zeros((2, HIGHEST + 1, HIGHEST, HIGHEST))
    for n in range(2, HIGHEST + 1):
        even = np.arange(n) / (n - 1)
        for kind, c in (
            (FIT, (1 - np.cos(np.pi * even)) / 2),
            (LOOK, even * even if symmetric else even),
        ):
            c[0], c[-1] = _OFF, 1 - _OFF
            nodes[kind, n, :n] = c
            transforms[kind, n, :n, :n] = np.linalg.inv(chebyshev.chebvander(2 * c - 1, n - 1))
    return nodes, transforms


@register_jitable(forceinline=True)
def polynomials(c: float, n: int, values: NDArray[np.float64]) -> None:
    r"""Fill in the first n polynomials :math:`T_m(2c - 1)` at one place."""
    t = 2 * c - 1
    values[0] = 1.0
    values[1] = t
    for m in range(2, n):
        values[m] = 2 * t * values[m - 1] - values[m - 2]


@register_jitable(forceinline=True)
def transform(
    values: NDArray[np.float64],
    n: int,
    m: int,
    along_s: NDArray[np.float64],
    along_v: NDArray[np.float64],
    room: NDArray[np.float64],
    coefficients: NDArray[np.float64],
) -> None:
    """Turn values on n x m nodes into coefficients, by a transform along each axis."""
    for i in range(n):
        for b in range(m):
            total = 0.0
            for j in range(m):
                total += values[i, j] * along_v[b, j]
            room[i, b] = total
    for a in range(n):
        for b in range(m):
            total = 0.0
            for i in range(n):
                total += along_s[a, i] * room[i, b]
            coefficients[a, b] = total


@register_jitable(forceinline=True)
def trailing(coefficients: NDArray[np.float64], n: int, m: int) -> tuple[float, float]:
    """Return the summed magnitudes of the highest coefficients along each axis.

    That is what one order less would leave out.
    """
    along_s, along_v = 0.0, 0.0
    for b in range(m):
        along_s += abs(coefficients[n - 1, b])
    for a in range(n):
        along_v += abs(coefficients[a, m - 1])
    return along_s, along_v
