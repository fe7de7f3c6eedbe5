"""The objective's pupil: the amplitude of the light over it, in and out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray


class Pupil(Protocol):
    """What weighs the directions of light; 1 on the axis."""

    @property
    def varies(self) -> bool:
        """Whether it depends on the wavenumber."""
        ...

    def amplitude(
        self,
        sine: NDArray[np.float64],
        aperture: float,
        wavenumber: float | NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Return the amplitudes of light at some directions.

        Parameters
        ----------
        sine : ndarray
            ρ = n sin θ of the light, n that of the objective's medium.
        aperture : float
            Numerical aperture: the largest ρ that passes.
        wavenumber : float or ndarray
            In vacuum, 1/µm; of a shape that the directions have room for.
        """
        ...


@dataclass(frozen=True)
class UniformPupil:
    """A pupil that is lit evenly."""

    varies: ClassVar[bool] = False

    def amplitude(
        self,
        sine: NDArray[np.float64],
        aperture: float,  # noqa: ARG002
        wavenumber: float | NDArray[np.float64],  # noqa: ARG002
    ) -> NDArray[np.float64]:
        """Return 1 at each direction."""
        return np.ones_like(sine)


@dataclass(frozen=True)
class GaussianPupil:
    r"""A pupil that a Gaussian beam fills: :math:`e^{-(\rho / (fill \cdot NA))^2}`."""

    varies: ClassVar[bool] = False
    fill: float
    """Radius at 1/e² of the beam's intensity over that of the pupil (Novotny & Hecht's f₀)."""

    def amplitude(
        self,
        sine: NDArray[np.float64],
        aperture: float,
        wavenumber: float | NDArray[np.float64],  # noqa: ARG002
    ) -> NDArray[np.float64]:
        """Return the Gaussian at each direction."""
        amplitude: NDArray[np.float64] = np.exp(-((sine / (self.fill * aperture)) ** 2))
        return amplitude


@dataclass(frozen=True)
class FibrePupil:
    r"""A pupil that a fibre's mode fills: :math:`e^{-(k w_0 \rho / (2 M))^2}`, w₀ its radius."""

    varies: ClassVar[bool] = True
    mode_field_diameter: float
    """At 1/e² of intensity, 2 w₀, µm."""
    magnification: float
    """M, from the object to the fibre."""

    def amplitude(
        self,
        sine: NDArray[np.float64],
        aperture: float,  # noqa: ARG002
        wavenumber: float | NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Return the mode's far field at each direction."""
        waist = self.mode_field_diameter / 2
        spread = wavenumber * waist / (2 * self.magnification)
        amplitude: NDArray[np.float64] = np.exp(-((spread * sine) ** 2))
        return amplitude
