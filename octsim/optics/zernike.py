"""Zernike polynomials: aberrations of a pupil, numbered after Noll."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from math import comb, cos, factorial, sin, sqrt
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    # numpy is imported where it is used, as reading a config needs the names alone
    import numpy as np
    from numpy.typing import NDArray

MOST = 66
"""The largest number that is accepted: all polynomials up to degree 10."""

NAMES: Mapping[str, int] = MappingProxyType(
    {
        "piston": 1,
        "tilt x": 2,
        "tilt y": 3,
        "defocus": 4,
        "astigmatism oblique": 5,
        "oblique astigmatism": 5,
        "astigmatism": 6,
        "vertical astigmatism": 6,
        "coma y": 7,
        "vertical coma": 7,
        "coma x": 8,
        "horizontal coma": 8,
        "trefoil y": 9,
        "vertical trefoil": 9,
        "trefoil x": 10,
        "oblique trefoil": 10,
        "spherical": 11,
        "primary spherical": 11,
        "secondary astigmatism": 12,
        "vertical secondary astigmatism": 12,
        "secondary astigmatism oblique": 13,
        "oblique secondary astigmatism": 13,
        "quadrafoil": 14,
        "tetrafoil": 14,
        "vertical quadrafoil": 14,
        "quadrafoil oblique": 15,
        "tetrafoil oblique": 15,
        "oblique quadrafoil": 15,
        "secondary coma x": 16,
        "horizontal secondary coma": 16,
        "secondary coma y": 17,
        "vertical secondary coma": 17,
        "secondary trefoil x": 18,
        "oblique secondary trefoil": 18,
        "secondary trefoil y": 19,
        "vertical secondary trefoil": 19,
        "pentafoil x": 20,
        "pentafoil y": 21,
        "secondary spherical": 22,
    }
)
"""Noll's numbers by the names that polynomials have, some of them several.

With x in its name one has the cosine (m > 0), with y or "oblique" of an even order the sine.
"""

_ROUNDING = 1e-14  # of coefficients that are turned, over the largest

Pairs = Iterable[tuple[int, float]]


def noll(j: int) -> tuple[int, int]:
    """Return the degree n and the azimuthal order m of Noll's polynomial j.

    They are ordered by n, in it by abs(m); even numbers are cosines (m > 0), odd ones sines
    (m < 0) (Noll, J. Opt. Soc. Am. 66, 207 (1976), Table I).

    Parameters
    ----------
    j : int
        Noll's number, from 1 to `MOST`.
    """
    if not 1 <= j <= MOST:
        raise ValueError(f"Noll's number {j} is not from 1 to {MOST}")
    n, place = 0, j - 1
    while place > n:
        n += 1
        place -= n
    order = place + (n - place) % 2  # of the parity of n: 0, 2, 2, 4, 4 or 1, 1, 3, 3
    return n, -order if j % 2 else order


def cartesian(coefficients: Mapping[int, float] | Pairs) -> NDArray[np.float64]:
    r"""Return a sum of Zernike polynomials by the powers of x and y.

    .. math:: W = \sum_j a_j Z_j = \sum_{pq} c_{pq} x^p y^q, \quad
        Z_n^m = \sqrt{(n + 1) (2 - \delta_{m0})} R_n^{|m|}(r)
        \begin{cases} \cos m\theta & m \ge 0 \\ \sin |m|\theta & m < 0 \end{cases}

    with θ from +x to +y, orthonormal over the unit disk: a_j is what Z_j adds to the rms (Noll,
    J. Opt. Soc. Am. 66, 207 (1976), eqs. (1) and (2)). But for the root and the sum the powers'
    factors are integers, and exact: where symmetry says that one is zero, it is.

    Parameters
    ----------
    coefficients : mapping, or pairs
        The a_j by Noll's number j. Numbers that stand twice are added.

    Returns
    -------
    ndarray
        c, (N, N), N - 1 being the highest degree.
    """
    import numpy as np

    pairs = coefficients.items() if isinstance(coefficients, Mapping) else coefficients
    summands = [(noll(j), a) for j, a in pairs]
    size = 1 + max((n for (n, _), _ in summands), default=0)
    c = np.zeros((size, size))
    for (n, m), a in summands:
        norm = sqrt((n + 1) * (2 if m else 1))
        for (p, q), factor in _integers(n, m):
            c[p, q] += a * norm * factor
    return c


@cache
def _integers(n: int, m: int) -> tuple[tuple[tuple[int, int], int], ...]:
    """Return R(r) cos mθ, or R(r) sin abs(m)θ, as ((power of x, of y), factor).

    R has the powers r^(m + 2s): r^m e^(imθ) is (x + iy)^m, and r² is x² + y².
    """
    order, odd = abs(m), int(m < 0)
    most = (n - order) // 2
    sums: dict[tuple[int, int], int] = {}
    for s in range(most + 1):
        radial = (
            (-1) ** (most - s)
            * factorial((n + order) // 2 + s)
            // (factorial(most - s) * factorial(order + s) * factorial(s))
        )
        for q in range(odd, order + 1, 2):  # i^q is real for cosines, imaginary for sines
            turned = (-1) ** (q // 2) * comb(order, q)
            for t in range(s + 1):
                powers = order - q + 2 * (s - t), q + 2 * t
                sums[powers] = sums.get(powers, 0) + radial * turned * comb(s, t)
    return tuple((powers, factor) for powers, factor in sums.items() if factor)


@dataclass(frozen=True)
class Aberration:
    """An aberration of the pupil, as a length that it adds to the optical path."""

    coefficients: tuple[tuple[int, float], ...]
    """By Noll's number: the rms over the pupil, µm."""

    def wavefront(self, px: NDArray[np.float64], py: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return W, µm, at points of the pupil, of any shape; 1 is its rim."""
        return _evaluate(self._powers, px, py)

    def slopes(
        self, px: NDArray[np.float64], py: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return ∂W/∂px and ∂W/∂py, µm, at points of the pupil, of any shape; 1 is its rim."""
        along_x, along_y = self._derivatives
        return _evaluate(along_x, px, py), _evaluate(along_y, px, py)

    @cached_property
    def even(self) -> tuple[bool, bool]:
        """Whether W(−px, py) is W(px, py), and whether W(px, −py) is."""
        return not self._powers[1::2].any(), not self._powers[:, 1::2].any()

    def turned(self, angle: float) -> Aberration:
        """Return it as seen from axes that are turned from x to y by an angle, rad."""
        numbers = {noll(j): j for j in range(1, MOST + 1)}
        turned: dict[int, float] = {}
        for j, a in self.coefficients:
            n, m = noll(j)
            # a cosine becomes cos m(θ + angle), a sine the same
            own, other = a * cos(m * angle), -a * sin(m * angle)
            for number, value in ((j, own), (numbers[n, -m], other)):
                turned[number] = turned.get(number, 0.0) + value
        least = _ROUNDING * max(map(abs, turned.values()), default=0.0)
        return Aberration(tuple((j, a) for j, a in turned.items() if abs(a) > least))

    @property
    def powers(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """W, ∂W/∂px and ∂W/∂py by the powers of px and py, (N, N) each."""
        import numpy as np

        across, along = (np.zeros_like(self._powers) for _ in range(2))
        of_x, of_y = self._derivatives
        across[: len(of_x)], along[:, : of_y.shape[1]] = of_x, of_y
        return self._powers, across, along

    @cached_property
    def _powers(self) -> NDArray[np.float64]:
        return cartesian(self.coefficients)

    @cached_property
    def _derivatives(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        import numpy as np
        from numpy.polynomial.polynomial import polyder

        along_x, along_y = (polyder(self._powers, axis=axis) for axis in (0, 1))
        return np.asarray(along_x, np.float64), np.asarray(along_y, np.float64)


def _evaluate(
    powers: NDArray[np.float64], px: NDArray[np.float64], py: NDArray[np.float64]
) -> NDArray[np.float64]:
    import numpy as np
    from numpy.polynomial.polynomial import polyval2d

    return np.asarray(polyval2d(px, py, powers), np.float64)
