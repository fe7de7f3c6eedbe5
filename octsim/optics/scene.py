"""The scene: regions, the surfaces between them, the neuron over its glass slide, and plates."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.materials import Material, intervals_within, rows_within


class Symmetry(NamedTuple):
    """In which planes through the optical axis something is its own mirror image."""

    x: bool
    """In the plane x = 0."""
    y: bool
    """In the plane y = 0."""


@dataclass(frozen=True)
class Region:
    """A part of space; two of one material are told apart by their names."""

    name: str
    material: Material
    attenuation: float = 0.0
    """Of intensity, base e, by absorption and scattering besides the material's κ, 1/µm."""

    @property
    def attenuates(self) -> bool:
        """Whether it takes light away."""
        return self.attenuation > 0 or self.material.absorbs

    def attenuation_at(self, wavenumber: float) -> float:
        """Return the attenuation of intensity at a wavenumber (1/µm), 1/µm: with 2 k κ."""
        return self.attenuation + 2 * wavenumber * self.material.index(wavenumber).imag


@dataclass(frozen=True)
class Plane:
    """A horizontal plane at a height (µm) between two regions."""

    name: str
    """Short, as it stands in the names of light paths."""
    height: float
    below: Region
    above: Region

    @property
    def sides(self) -> tuple[Region, Region]:
        """The regions below and above."""
        return self.below, self.above

    @property
    def row(self) -> tuple[float, ...]:
        """Its shape in numbers: height, µm."""
        return (self.height,)


@dataclass(frozen=True)
class Cylinder:
    """A cylinder with its axis through (x, 0, z), all in µm, between two regions."""

    name: str
    """Short, as it stands in the names of light paths."""
    x: float
    z: float
    radius: float
    inside: Region
    outside: Region
    azimuth: float = 0.0
    """Angle from the y axis to its axis, (−sin, cos, 0), rad."""
    elevation: float = 0.0
    """Angle by which its axis is lifted after that, (−sin cos, cos cos, sin), rad."""

    @property
    def sides(self) -> tuple[Region, Region]:
        """The regions inside and outside."""
        return self.inside, self.outside

    @property
    def along_y(self) -> bool:
        """Whether its axis is parallel to y."""
        return self.azimuth == 0 and self.elevation == 0

    @property
    def axis(self) -> tuple[float, float, float]:
        """Unit vector along its axis."""
        level = math.cos(self.elevation)
        return (
            -math.sin(self.azimuth) * level, math.cos(self.azimuth) * level,
            math.sin(self.elevation),
        )  # fmt: skip

    @property
    def row(self) -> tuple[float, ...]:
        """Its shape in numbers: axis x and z, and radius, µm; then its axis, if it is not y."""
        place = self.x, self.z, self.radius
        return place if self.along_y else (*place, *self.axis)

    def mirrored(self, *, x: bool) -> "Cylinder":
        """Return it as seen in the plane x = 0, or in y = 0."""
        if x:
            return replace(self, x=-self.x, azimuth=-self.azimuth)
        return replace(self, azimuth=-self.azimuth, elevation=-self.elevation)


@dataclass(frozen=True)
class PlanePart:
    """A part of a horizontal plane: where a lifted cylinder ends at it, or all but that."""

    name: str
    """Short, as it stands in the names of light paths."""
    height: float
    below: Region
    above: Region
    cylinders_above: bool
    """Whether the cylinders that end there lie above the plane."""
    within: Cylinder | None
    """It is in this one; without, anywhere."""
    without: tuple[Cylinder, ...]
    """It is in none of these."""

    @property
    def sides(self) -> tuple[Region, Region]:
        """The regions below and above."""
        return self.below, self.above

    @property
    def row(self) -> tuple[float, ...]:
        """Its shape in numbers: height, µm."""
        return (self.height,)


Surface = Plane | PlanePart | Cylinder


@dataclass(frozen=True)
class Scene:
    """Surfaces, and the region below all of them, in which the objective lies."""

    objective: Region
    surfaces: tuple[Surface, ...]
    unseen_meetings: int = 0
    """Meetings of each light path with a plane that is none; they do not count."""

    @property
    def regions(self) -> tuple[Region, ...]:
        """Every region once, that of the objective first."""
        sides = (region for surface in self.surfaces for region in surface.sides)
        return tuple(dict.fromkeys((self.objective, *sides)))

    def rows_within(self, low: float, high: float) -> int:
        """Return how many rows a table of any region has between two wavenumbers, 1/µm."""
        return max(rows_within(region.material, low, high) for region in self.regions)

    def intervals_within(self, low: float, high: float) -> float:
        """Return how often the least distance of a table's rows is in a band, 1/µm."""
        return max(intervals_within(region.material, low, high) for region in self.regions)

    @property
    def absorbs(self) -> bool:
        """Whether the index of any region is complex."""
        return any(region.material.absorbs for region in self.regions)

    @property
    def attenuates(self) -> bool:
        """Whether any region takes light away."""
        sides = (region for surface in self.surfaces for region in surface.sides)
        return self.objective.attenuates or any(region.attenuates for region in sides)

    def transmission(
        self, ways: NDArray[np.float64], wavenumber: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        r"""Return what is left of amplitudes that the regions take from, (K, D).

        .. math:: e^{-\frac12 \sum_r \mu_r L_r}

        (Beer and Lambert; attenuation is of intensity).

        Parameters
        ----------
        ways : ndarray, shape (R, K, D)
            Lengths in each region, µm; of one K that serves all wavenumbers, too.
        wavenumber : ndarray, shape (K,)
            1/µm.
        """
        k = wavenumber.tolist()
        taken = np.array([[region.attenuation_at(one) for one in k] for region in self.regions])
        left: NDArray[np.float64] = np.exp(-0.5 * (taken[..., np.newaxis] * ways).sum(axis=0))
        return left

    @property
    def surface_names(self) -> tuple[str, ...]:
        """The surfaces' short names, in their order."""
        return tuple(surface.name for surface in self.surfaces)

    @property
    def symmetry(self) -> Symmetry:
        """The symmetry of all surfaces together; of two cylinders one can be the other's image."""
        cylinders = [one for one in self.surfaces if isinstance(one, Cylinder)]
        there = Counter(map(_without_names, cylinders))
        in_x, in_y = (
            Counter(_without_names(one.mirrored(x=x)) for one in cylinders) for x in (True, False)
        )
        return Symmetry(x=in_x == there, y=in_y == there)


def _without_names(cylinder: Cylinder) -> Cylinder:
    inside, outside = (replace(region, name="") for region in cylinder.sides)
    return replace(cylinder, name="", inside=inside, outside=outside)


NEURON_ON_GLASS = ("P", "C")
"""Names of the surfaces of `neuron_on_glass`: plane and cylinder."""


def neuron_on_glass(
    glass: Material,
    water: Material,
    neuron: Material,
    gap: float,
    diameter: float,
    x: float = 0.0,
    azimuth: float = 0.0,
    attenuation: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Scene:
    """Return a neuron in water, a gap above the glass–water plane z = 0.

    Parameters
    ----------
    glass, water, neuron : Material
        What they are made of.
    gap, diameter : float
        Of the neuron, µm.
    x : float
        Where its axis meets the plane y = 0, µm.
    azimuth : float
        Angle from the y axis to its axis, rad.
    attenuation : tuple of float
        Of glass, water and neuron, 1/µm.
    """
    slide, bath, axon = map(
        Region, ("glass", "water", "neuron"), (glass, water, neuron), attenuation
    )
    plane, cylinder = NEURON_ON_GLASS
    radius = diameter / 2
    return Scene(
        objective=slide,
        surfaces=(
            Plane(name=plane, height=0.0, below=slide, above=bath),
            Cylinder(cylinder, x, gap + radius, radius, inside=axon, outside=bath, azimuth=azimuth),
        ),
    )


def plates(regions: Sequence[Region], heights: Sequence[float]) -> Scene:
    """Return horizontal planes, one above the other.

    Parameters
    ----------
    regions : sequence of Region
        From below, each another one; the lowest is the objective's.
    heights : sequence of float
        Of the planes between them, increasing, µm.
    """
    between = zip(_names_of_planes(len(heights)), heights, pairwise(regions), strict=True)
    return Scene(regions[0], tuple(Plane(name, height, *sides) for name, height, sides in between))


def _names_of_planes(number: int) -> list[str]:
    # without R and T, which say what light does there, and C, the cylinder's
    letters = "PQSUVWXYZ"
    return [*letters, *(f"P{n}" for n in range(len(letters) + 1, number + 1))][:number]
