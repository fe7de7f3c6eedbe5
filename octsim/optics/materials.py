"""Materials: what refracts and absorbs light, wherever in a scene it is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import inf, isfinite, nan, pi, sqrt
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

_ROUNDING = 1e-9
"""How far, relatively, a wavelength that was a wavenumber may be beyond a table's end."""


class Material(Protocol):
    """What has a complex refractive index at each wavenumber."""

    dispersive: ClassVar[bool]
    """Whether the index depends on the wavenumber."""

    @property
    def absorbs(self) -> bool:
        """Whether κ is above 0 anywhere."""
        ...

    def index(self, wavenumber: float) -> complex:
        """Return n + iκ at a wavenumber, 1/µm in vacuum; κ > 0 absorbs."""
        ...

    def slope(self, wavenumber: float) -> float:
        """Return dn/dk at a wavenumber, 1/µm in vacuum; µm."""
        ...

    def __hash__(self) -> int:
        """Return the same for the same material."""
        ...


@dataclass(frozen=True)
class Constant:
    """A material of one real refractive index at all wavenumbers."""

    dispersive: ClassVar[bool] = False
    absorbs: ClassVar[bool] = False

    n: float

    def index(self, wavenumber: float) -> complex:  # noqa: ARG002
        """Return n, whatever the wavenumber."""
        return complex(self.n)

    def slope(self, wavenumber: float) -> float:  # noqa: ARG002
        """Return 0, whatever the wavenumber."""
        return 0.0


@dataclass(frozen=True)
class Cauchy:
    r"""A material of Cauchy's formula, :math:`n = \sum_i A_i / λ^{2i}`."""

    dispersive: ClassVar[bool] = True
    absorbs: ClassVar[bool] = False

    coefficients: tuple[float, ...]
    """A₀, A₁, …, A_i in µm^2i."""

    def index(self, wavenumber: float) -> complex:
        """Return n at a wavenumber, 1/µm in vacuum."""
        return complex(sum(a * _squared(wavenumber) ** i for i, a in enumerate(self.coefficients)))

    def slope(self, wavenumber: float) -> float:
        """Return dn/dk at a wavenumber, 1/µm in vacuum; µm."""
        q = _squared(wavenumber)
        return sum(2 * i * a * q**i for i, a in enumerate(self.coefficients)) / wavenumber


@dataclass(frozen=True)
class Sellmeier:
    r"""A material of Sellmeier's formula, :math:`n^2 = 1 + \sum_i B_i λ^2 / (λ^2 - C_i)`.

    Where n² is not positive, or at a resonance, the index is NaN.
    """

    dispersive: ClassVar[bool] = True
    absorbs: ClassVar[bool] = False

    b: tuple[float, ...]
    c: tuple[float, ...]
    """µm², as in refractiveindex.info's formula 2; its formula 1 has their roots."""

    def index(self, wavenumber: float) -> complex:
        """Return n at a wavenumber, 1/µm in vacuum."""
        q = _squared(wavenumber)
        square = 1 + sum(_over(b, 1 - c * q) for b, c in zip(self.b, self.c, strict=True))
        return complex(sqrt(square) if 0 < square < inf else nan)

    def slope(self, wavenumber: float) -> float:
        """Return dn/dk at a wavenumber, 1/µm in vacuum; µm."""
        q = _squared(wavenumber)
        terms = (_over(b * c * q, (1 - c * q) ** 2) for b, c in zip(self.b, self.c, strict=True))
        # d(n²)/dk is 2 n dn/dk
        return sum(terms) / (wavenumber * self.index(wavenumber).real)


@dataclass(frozen=True)
class Table:
    """A material that was measured at some wavelengths.

    Between them n is a cubic spline in the wavelength, not-a-knot (of two rows a line, of three a
    parabola), and κ is piecewise cubic and goes no way that its rows do not.
    """

    dispersive: ClassVar[bool] = True

    wavelength: tuple[float, ...]
    """In vacuum, µm, increasing; two or more."""
    n: tuple[float, ...]
    kappa: tuple[float, ...] = ()
    """Nothing is 0 everywhere."""

    @property
    def absorbs(self) -> bool:
        """Whether κ is above 0 anywhere."""
        return any(self.kappa)

    def index(self, wavenumber: float) -> complex:
        """Return n + iκ at a wavenumber, 1/µm in vacuum.

        Raises
        ------
        ValueError
            If the table does not reach there.
        """
        wavelength = self._within(wavenumber)
        kappa = float(_between_kappas(self)(wavelength)) if self.kappa else 0.0
        return complex(float(_between_rows(self)(wavelength)), kappa)

    def slope(self, wavenumber: float) -> float:
        """Return dn/dk at a wavenumber, 1/µm in vacuum; µm.

        Raises
        ------
        ValueError
            If the table does not reach there.
        """
        wavelength = self._within(wavenumber)
        return float(_between_rows(self)(wavelength, 1)) * -wavelength / wavenumber

    def _within(self, wavenumber: float) -> float:
        """Return the wavelength of a wavenumber, at most rounding beyond the table's ends."""
        wavelength, first, last = 2 * pi / wavenumber, self.wavelength[0], self.wavelength[-1]
        if not first * (1 - _ROUNDING) <= wavelength <= last * (1 + _ROUNDING):
            raise ValueError(
                f"the table of indices has wavelengths from {first:g} to {last:g} um, and "
                f"{wavelength:g} um is asked for; give it more rows, or another band"
            )
        return min(max(wavelength, first), last)


def rows_within(material: Material, low: float, high: float) -> int:
    """Return how many rows of a table are between two wavenumbers, 1/µm; of a formula none.

    As many places are there where an index or an absorption may turn.
    """
    if not isinstance(material, Table):
        return 0
    return sum(low < 2 * pi / one < high for one in material.wavelength)


def group_index(material: Material, wavenumber: float) -> float:
    """Return d(nk)/dk = n + k dn/dk at a wavenumber, 1/µm in vacuum; of a constant exactly n."""
    n = material.index(wavenumber).real
    return n + wavenumber * material.slope(wavenumber) if material.dispersive else n


def _squared(wavenumber: float) -> float:
    """Return 1/λ², 1/µm²."""
    return (wavenumber / (2 * pi)) ** 2


def _over(value: float, divisor: float) -> float:
    """Return a quotient, NaN at a resonance."""
    quotient = value / divisor if divisor else nan
    return quotient if isfinite(quotient) else nan


# scipy is imported where a table is read between its rows, as reading a config must be fast
@cache
def _between_rows(table: Table) -> Callable[..., Any]:
    from scipy.interpolate import CubicSpline

    spline: Callable[..., Any] = CubicSpline(table.wavelength, table.n, bc_type="not-a-knot")
    return spline


@cache
def _between_kappas(table: Table) -> Callable[..., Any]:
    from scipy.interpolate import PchipInterpolator

    found: Callable[..., Any] = PchipInterpolator(table.wavelength, table.kappa)
    return found
