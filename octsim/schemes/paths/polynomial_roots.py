"""All roots of a polynomial on an interval, in Bernstein's form.

A polynomial's Bernstein coefficients change their sign at least as often as it has roots, and by
halves of the interval no more often (Descartes' rule; Lane and Riesenfeld 1981). So a root is
found however close to another it lies, which no number of samples promises.

Coefficients are *scaled* where polynomials are multiplied: by binomials, so that those of a product
are a convolution.
"""

from math import comb

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.records import layout
from octsim.schemes.paths.chebyshev import HIGHEST

MOST_COEFFICIENTS = 2 * HIGHEST
_DEPTH = 40  # halves of halves; what is left there is one place
_ROUNDED = 1e-13  # of the largest coefficient: below that its parts' are rounding
_STEPS = 60
_CLOSE = 1e-10  # of the interval
HALVES = _DEPTH + 2, MOST_COEFFICIENTS
"""Shape of the room that `append_roots` works in."""


class BernsteinTables:
    """What turns polynomials into Bernstein's form; `fill_bernstein` fills it in."""

    from_chebyshev: NDArray[np.float64]
    """``coefficients @ from_chebyshev[n, :n, :n]`` are n scaled ones.

    Shape (HIGHEST + 1, HIGHEST, HIGHEST).
    """
    binomials: NDArray[np.float64]
    """``binomials[d, j]``, by which those of degree d are scaled, (2 HIGHEST, 2 HIGHEST)."""


BERNSTEIN_TABLES = layout(
    BernsteinTables, from_chebyshev=(HIGHEST + 1, HIGHEST, HIGHEST),
    binomials=(MOST_COEFFICIENTS, MOST_COEFFICIENTS),
)  # fmt: skip


def fill_bernstein(tables: BernsteinTables) -> None:
    r"""Fill in what turns Chebyshev's coefficients into Bernstein's, and the binomials.

    .. math:: T_m(2c - 1) = \sum_j (-1)^{m-j} \binom{2m}{2j} c^j (1-c)^{m-j}

    times :math:`(c + (1 - c))^{n-1-m}` to be of degree n − 1.
    """
    most = MOST_COEFFICIENTS
    tables.binomials[:] = [[comb(d, j) for j in range(most)] for d in range(most)]
    tables.from_chebyshev[:] = 0.0
    for n in range(1, HIGHEST + 1):
        for m in range(n):
            signed = [(-1.0) ** (m - j) * comb(2 * m, 2 * j) for j in range(m + 1)]
            raised = [float(comb(n - 1 - m, j)) for j in range(n - m)]
            tables.from_chebyshev[n, m, :n] = np.convolve(signed, raised)


@register_jitable
def to_bernstein(
    chebyshev: NDArray[np.float64], n: int, table: NDArray[np.float64], scaled: NDArray[np.float64]
) -> None:
    """Turn n Chebyshev coefficients into scaled Bernstein ones."""
    for j in range(n):
        scaled[j] = 0.0
    for m in range(n):
        for j in range(n):
            scaled[j] += chebyshev[m] * table[m, j]


@register_jitable
def add_square(
    factor: float, scaled: NDArray[np.float64], n: int, at_0: float, at_1: float,
    total: NDArray[np.float64],
) -> None:  # fmt: skip
    """Add a factor times the square of a polynomial times a line, from its values at both ends.

    `scaled` are n coefficients, `total` the 2 n of the sum.
    """
    for i in range(n):
        for j in range(n):
            product = factor * scaled[i] * scaled[j]
            total[i + j] += at_0 * product
            total[i + j + 1] += at_1 * product


@register_jitable
def unscale(coefficients: NDArray[np.float64], n: int, binomials: NDArray[np.float64]) -> None:
    """Divide n coefficients by the binomials that scale them."""
    for j in range(n):
        coefficients[j] /= binomials[n - 1, j]


@register_jitable
def value_at(
    coefficients: NDArray[np.float64], n: int, binomials: NDArray[np.float64], c: float
) -> float:
    """Return the value of a polynomial at c, from its n Bernstein coefficients."""
    rest, power = 1 - c, 1.0
    total: float = coefficients[0]
    for j in range(1, n):
        power *= c
        total = total * rest + binomials[n - 1, j] * power * coefficients[j]
    return total


@register_jitable(forceinline=True)
def _sign_changes(coefficients: NDArray[np.float64], n: int) -> int:
    """Return how often the coefficients change their sign; zero counts as negative."""
    changes = 0
    for j in range(1, n):
        changes += 1 if (coefficients[j] > 0) != (coefficients[j - 1] > 0) else 0
    return changes


@register_jitable
def _largest(coefficients: NDArray[np.float64], n: int) -> float:
    """Return the largest magnitude of the coefficients."""
    largest = 0.0
    for j in range(n):
        largest = max(largest, abs(coefficients[j]))
    return largest


@register_jitable(forceinline=True)
def _halve(whole: NDArray[np.float64], n: int, left: NDArray[np.float64]) -> None:
    """Put the coefficients of the left half into `left`, and of the right one in their place."""
    for depth in range(n):
        left[depth] = whole[0]
        for j in range(n - 1 - depth):
            whole[j] = 0.5 * (whole[j] + whole[j + 1])


@register_jitable(forceinline=True)
def _only_root(coefficients: NDArray[np.float64], n: int, binomials: NDArray[np.float64]) -> float:
    """Return the one root between 0 and 1 of a polynomial whose ends differ in sign (Illinois)."""
    low, high, at_low, at_high, side = 0.0, 1.0, coefficients[0], coefficients[n - 1], 0
    c = 0.5
    for _ in range(_STEPS):
        c = (low * at_high - high * at_low) / (at_high - at_low)
        if not low < c < high:
            c = 0.5 * (low + high)
        here = value_at(coefficients, n, binomials, c)
        if here == 0 or high - low < _CLOSE:
            break
        if (here > 0) == (at_high > 0):
            at_low = 0.5 * at_low if side == 1 else at_low
            step, high, at_high, side = high - c, c, here, 1
        else:
            at_high = 0.5 * at_high if side == -1 else at_high
            step, low, at_low, side = c - low, c, here, -1
        if step < _CLOSE:
            break
    return c


@register_jitable(forceinline=True)
def append_roots(
    coefficients: NDArray[np.float64], n: int, binomials: NDArray[np.float64],
    room: NDArray[np.float64], roots: NDArray[np.float64], count: int,
) -> int:  # fmt: skip
    """Append the places between 0 and 1 where a polynomial changes its sign, in order.

    Parameters
    ----------
    coefficients : ndarray
        Its n Bernstein coefficients.
    n : int
        How many there are.
    binomials : ndarray
        Those of `BernsteinTables`.
    room : ndarray, shape `HALVES`
        Room to work in.
    roots : ndarray
        Where they are put; room for n − 1 more.
    count : int
        How many are there already.

    Returns
    -------
    int
        How many are there now.
    """
    for j in range(n):
        room[0, j] = coefficients[j]
    if _sign_changes(room[0], n) == 0:
        return count
    rounding = _ROUNDED * _largest(room[0], n)
    starts, depths = np.empty(_DEPTH + 2), np.empty(_DEPTH + 2, np.int64)
    starts[0], depths[0], top = 0.0, 0, 0
    while top >= 0 and count < roots.size:
        start, depth = starts[top], depths[top]
        width = 0.5**depth
        changes = _sign_changes(room[top], n)
        if changes == 1:
            roots[count] = start + width * _only_root(room[top], n, binomials)
            count += 1
        elif changes > 1 and (depth == _DEPTH or _largest(room[top], n) <= rounding):
            # as good as zero: one place, whatever the rounding there
            if (room[top, 0] > 0) != (room[top, n - 1] > 0):
                roots[count] = start + 0.5 * width
                count += 1
        elif changes > 1:
            # the left half next: the right one waits below it
            _halve(room[top], n, room[top + 1])
            starts[top], depths[top] = start + 0.5 * width, depth + 1
            starts[top + 1], depths[top + 1] = start, depth + 1
            top += 1
            continue
        top -= 1
    return count


@register_jitable
def sort(values: NDArray[np.float64], num: int) -> None:
    """Sort the first few of some values; numpy's sort takes two seconds to compile."""
    for i in range(1, num):
        value, k = values[i], i
        while k > 0 and values[k - 1] > value:
            values[k] = values[k - 1]
            k -= 1
        values[k] = value
