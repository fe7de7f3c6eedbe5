"""The source's spectrum: its power at each wavenumber, over its largest."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import log, pi
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from typing import TypeAlias

    import numpy as np
    from numpy.typing import NDArray

    Array: TypeAlias = "NDArray[np.float64]"

_ROUNDING = 1e-9
"""Of the ends of a table, by which a wavelength may be beyond them."""


class Source(Protocol):
    """A source that is not flat."""

    def power(self, wavenumber: "Array") -> "Array":
        """Return its power at wavenumbers (K,), 1/µm, over its largest; (K,)."""


@dataclass(frozen=True)
class GaussianSource:
    r"""A Gaussian over the wavelength, :math:`e^{-4 \ln 2\, (\lambda - \lambda_0)^2 / w^2}`."""

    centre: float
    """λ₀, µm."""
    fwhm: float
    """w, full width at half maximum, µm."""

    def power(self, wavenumber: "Array") -> "Array":
        """Return its power at wavenumbers (K,), 1/µm, over its largest; (K,)."""
        import numpy as np  # here, as reading a config takes half as long without

        away = (2 * pi / wavenumber - self.centre) / self.fwhm
        found: Array = np.exp(-4 * log(2) * away**2)
        return found


@dataclass(frozen=True)
class MeasuredSource:
    """A source that was measured at some wavelengths; between them piecewise cubic."""

    wavelength: tuple[float, ...]
    """Increasing, µm."""
    rows: tuple[float, ...]
    """Of any unit, none below 0."""

    def spans(self, shortest: float, longest: float) -> bool:
        """Return whether its rows reach from one wavelength to another, µm."""
        first, last = self.wavelength[0] * (1 - _ROUNDING), self.wavelength[-1] * (1 + _ROUNDING)
        return first <= shortest <= longest <= last

    def power(self, wavenumber: "Array") -> "Array":
        """Return its power at wavenumbers (K,), 1/µm, over its largest; (K,).

        Raises
        ------
        ValueError
            If the rows do not reach there.
        """
        import numpy as np

        wavelength, first, last = 2 * pi / wavenumber, self.wavelength[0], self.wavelength[-1]
        if not self.spans(wavelength.min(), wavelength.max()):
            raise ValueError(
                f"the source is known from {first:g} to {last:g} um, and {wavelength.min():g} to "
                f"{wavelength.max():g} um are asked for"
            )
        found: Array = _between_rows(self)(np.clip(wavelength, first, last)) / max(self.rows)
        return found


# scipy is imported where it is needed, as reading a config must be fast
@cache
def _between_rows(source: MeasuredSource) -> Callable[..., Any]:
    from scipy.interpolate import PchipInterpolator

    found: Callable[..., Any] = PchipInterpolator(source.wavelength, source.rows)
    return found
