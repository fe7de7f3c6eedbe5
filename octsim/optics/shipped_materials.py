"""Materials that octsim knows by their names, and where their numbers are from.

An index is one relative to vacuum, with wavenumbers in vacuum. One that its source gives relative
to air is kept as its source has it, and `ShippedMaterial.reference` says so: relative to vacuum it
would be 1.00027 times that, 4e-4 more in n.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from octsim.optics.materials import Cauchy, Material, Sellmeier


@dataclass(frozen=True)
class ShippedMaterial:
    """A material with its name and its source."""

    name: str
    material: Material
    source: str
    """Who measured or published it, or that nobody did."""
    reference: Literal["vacuum", "air"]
    """What its index and wavelengths are relative to."""
    wavelength: tuple[float, float]
    """Shortest and longest that the source vouches for, µm."""

    @property
    def origin(self) -> str:
        """Where its numbers are from, and what they are relative to, in words."""
        if self.reference == "vacuum":
            return f"{self.source}; relative to vacuum"
        return f"{self.source}; relative to air, in vacuum n is 4e-4 more"


_ROWS = (
    ShippedMaterial(
        "water",
        Sellmeier(
            (5.684027565e-1, 1.726177391e-1, 2.086189578e-2, 1.130748688e-1),
            (5.101829712e-3, 1.821153936e-2, 2.620722293e-2, 1.069792721e1),
        ),
        # refractiveindex.info says of it: absolute, relative to vacuum
        "Daimon and Masumura, Appl. Opt. 46, 3811 (2007), distilled, at 20.0 °C",
        "vacuum",
        (0.182, 1.129),
    ),
    ShippedMaterial(
        "N-BK7",
        Sellmeier((1.03961212, 0.231792344, 1.01046945), (0.00600069867, 0.0200179144, 103.560653)),
        "Schott's data sheet of N-BK7",
        "air",
        (0.3, 2.5),
    ),
    ShippedMaterial(
        "cytoplasm",
        Cauchy((1.3815, 0.0040, 0.00012)),
        "an illustration of a neuron that is dispersive, not measured",
        "vacuum",
        (0.4, 1.3),
    ),
)

SHIPPED: Mapping[str, ShippedMaterial] = MappingProxyType({row.name: row for row in _ROWS})
"""Materials by their names."""
