"""A focus whose height depends on the wavelength."""

from dataclasses import dataclass
from math import pi


@dataclass(frozen=True)
class FocalShift:
    r"""By how much a focus is higher: :math:`a (λ - λ_0) + b (λ - λ_0)^2`."""

    reference: float
    """λ₀, µm, in vacuum as all wavelengths."""
    linear: float
    """a, µm/µm."""
    quadratic: float
    """b, 1/µm."""

    def at(self, wavenumber: float) -> float:
        """Return it at a wavenumber (1/µm), µm."""
        return self.at_wavelength(2 * pi / wavenumber)

    def at_wavelength(self, wavelength: float) -> float:
        """Return it at a wavelength, both µm."""
        off = wavelength - self.reference
        return (self.linear + self.quadratic * off) * off

    def highest(self, shortest: float, longest: float) -> float:
        """Return the most that it is between two wavelengths, all µm."""
        turn = self.reference - self.linear / (2 * self.quadratic) if self.quadratic else shortest
        tried = shortest, longest, min(max(turn, shortest), longest)
        return max(map(self.at_wavelength, tried))
