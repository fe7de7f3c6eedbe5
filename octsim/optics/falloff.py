"""Falloff: how the detected amplitude goes down with the distance from the optical axis.

The distance is u = ρ/R_det: in the focal plane, over the radius of the fibre core's image.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from octsim.optics.fibre_mode import lp01

FAINT = 1e-13
"""Amplitude below which nothing is accepted, unless another is asked for."""


class Falloff(Protocol):
    """What weighs the places where light returns; 1 on the axis."""

    dispersive: ClassVar[bool]
    """Whether it depends on the wavenumber."""

    def reach(self, wavenumber: float, faint: float = FAINT) -> float:
        """Return the largest u that is accepted: more at a smaller wavenumber.

        Parameters
        ----------
        wavenumber : float
            In vacuum, 1/µm.
        faint : float
            Amplitude below which nothing is accepted of a falloff that has no edge.
        """
        ...

    def __hash__(self) -> int:
        """Return the same for the same falloff."""
        ...

    def amplitude(self, squared: NDArray[np.float64], wavenumber: float) -> NDArray[np.float64]:
        """Return the factors on the amplitudes, within the reach.

        Parameters
        ----------
        squared : ndarray
            u², of any shape.
        wavenumber : float
            In vacuum, 1/µm.
        """
        ...


@dataclass(frozen=True)
class _Edged:
    """A falloff that ends at the edge of the core's image, the same at each wavenumber."""

    dispersive: ClassVar[bool] = False

    def reach(self, wavenumber: float, faint: float = FAINT) -> float:  # noqa: ARG002
        """Return 1: the edge of the core's image."""
        return 1.0


@dataclass(frozen=True)
class Parabolic(_Edged):
    """1 − u² (thesis §4.4)."""

    def amplitude(
        self,
        squared: NDArray[np.float64],
        wavenumber: float,  # noqa: ARG002
    ) -> NDArray[np.float64]:
        """Return the parabola at each place."""
        from octsim.optics.detector import falloff  # here, as it brings numba along

        return falloff(squared)


@dataclass(frozen=True)
class TopHat(_Edged):
    """1 up to the edge."""

    def amplitude(
        self,
        squared: NDArray[np.float64],
        wavenumber: float,  # noqa: ARG002
    ) -> NDArray[np.float64]:
        """Return 1 at each place."""
        return np.ones_like(squared)


@dataclass(frozen=True)
class Cosine(_Edged):
    """cos(πu/2)."""

    def amplitude(
        self,
        squared: NDArray[np.float64],
        wavenumber: float,  # noqa: ARG002
    ) -> NDArray[np.float64]:
        """Return the cosine at each place."""
        return np.cos(pi / 2 * np.sqrt(squared))


@dataclass(frozen=True)
class GaussianFalloff:
    r""":math:`e^{-(u \cdot scale)^2}`, without an edge."""

    scale: float
    """R_det over the radius w at 1/e of amplitude: w is R_det, or MFD/(2M) of a fibre's mode."""
    dispersive: ClassVar[bool] = False

    def reach(self, wavenumber: float, faint: float = FAINT) -> float:  # noqa: ARG002
        """Return where the amplitude is that faint."""
        return sqrt(-log(faint)) / self.scale

    def amplitude(
        self,
        squared: NDArray[np.float64],
        wavenumber: float,  # noqa: ARG002
    ) -> NDArray[np.float64]:
        """Return the Gaussian at each place."""
        amplitude: NDArray[np.float64] = np.exp(-squared * self.scale**2)
        return amplitude


@dataclass(frozen=True)
class FibreFalloff:
    """The fibre's mode LP01 (`octsim.optics.fibre_mode`), seen at the focus, without an edge.

    The core's image has the radius R_det, so that u is also the distance in the fibre over the
    radius of its core.
    """

    core_radius: float
    """µm, in the fibre and not at the focus."""
    numerical_aperture: float
    """Of the fibre."""
    dispersive: ClassVar[bool] = True

    def reach(self, wavenumber: float, faint: float = FAINT) -> float:
        """Return where the amplitude is that faint."""
        return lp01(self.core_radius, self.numerical_aperture, wavenumber).reach(faint)

    def amplitude(self, squared: NDArray[np.float64], wavenumber: float) -> NDArray[np.float64]:
        """Return the mode's field at each place."""
        mode = lp01(self.core_radius, self.numerical_aperture, wavenumber)
        return mode.amplitude(np.sqrt(squared))
