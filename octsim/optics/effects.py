"""What the thesis left out of the light's way, scenes apart: each is off unless asked for."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from octsim.optics.falloff import Falloff, Parabolic
from octsim.optics.focal_shift import FocalShift
from octsim.optics.rulings import diffraction_waist, rayleigh_range

if TYPE_CHECKING:
    from octsim.optics.materials import Material
    from octsim.optics.zernike import Aberration


@dataclass(frozen=True)
class Waist:
    """A focus of a width: rays as the rulings of a Gaussian beam's hyperboloid."""

    radius: float | None = None
    """At 1/e² of intensity, µm; None is λ/(π NA)."""
    wavenumber: float | None = None
    """Of the beam whose rulings serve all, 1/µm; None is each one's own."""

    def rayleigh_range(self, medium: Material, aperture: float, wavenumber: float) -> float:
        """Return z_R in a medium, for a numerical aperture and a wavenumber (1/µm), µm."""
        k = self.wavenumber or wavenumber
        radius = self.radius or diffraction_waist(k, aperture)
        return rayleigh_range(medium.index(k).real, radius, k)


@dataclass(frozen=True)
class ReferenceArm:
    r"""Light that comes back from a mirror: :math:`a\, e^{2ikL}` is added to the field."""

    amplitude: float
    length: float
    """L, one way, from where the focus's path is zero, µm."""


@dataclass(frozen=True)
class Effects:
    """What an instrument does to rays besides the thesis's objective and fibre."""

    aplanatic: bool = False
    """√cos θ in and 1/√cos θ out."""
    aberration: Aberration | None = None
    """In and out."""
    turned: bool = True
    """Whether the aberration turns rays, so that they stay normal to the wavefront."""
    focal_shift: FocalShift | None = None
    falloff: Falloff = field(default_factory=Parabolic)
    """Of what the fibre collects, over the distance from its axis."""
    waist: Waist | None = None
    vectorial: bool = False
    """Whether light has a direction of its field, and not the thesis's unpolarised split."""
    reference: ReferenceArm | None = None

    @property
    def displaces(self) -> bool:
        """Whether rays cross the focal plane beside the focus."""
        return self.waist is not None or (self.aberration is not None and self.turned)

    @property
    def way_varies(self) -> bool:
        """Whether a ray's way depends on the wavenumber by any of them."""
        each = self.waist is not None and self.waist.wavenumber is None
        return self.focal_shift is not None or each


NO_EFFECTS = Effects()
"""The thesis's instrument."""
