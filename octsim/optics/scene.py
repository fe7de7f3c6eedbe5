"""The scene: regions, the surfaces between them, and the neuron over its glass slide."""

import math
from collections import Counter
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.materials import Material, rows_within


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

    def turned(self, angle: float) -> "Plane":  # noqa: ARG002
        """Return it as seen from axes that are turned about the optical axis."""
        return self


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

    def turned(self, angle: float) -> "Cylinder":
        """Return it as seen from axes that are turned from x to y by an angle, rad.

        One that never meets the plane y = 0 there can't be said.
        """
        azimuth, elevation = self.azimuth - angle, abs(self.elevation)
        # a line has two directions: that which is lifted, or of two level ones that closer to y
        azimuth += math.pi if self.elevation < 0 else 0.0
        azimuth = math.remainder(azimuth, 2 * math.pi if elevation else math.pi)
        if self.x == 0:
            return replace(self, azimuth=azimuth, elevation=elevation)
        along = self.x * math.sin(angle) / math.cos(self.azimuth - angle)
        return replace(
            self, x=self.x * math.cos(self.azimuth) / math.cos(self.azimuth - angle),
            z=self.z + along * math.tan(self.elevation), azimuth=azimuth, elevation=elevation,
        )  # fmt: skip


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

    def turned(self, angle: float) -> "PlanePart":
        """Return it as seen from axes that are turned from x to y by an angle, rad."""
        within = self.within and self.within.turned(angle)
        return replace(
            self, within=within, without=tuple(one.turned(angle) for one in self.without)
        )


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
        there, in_x, in_y = (
            Counter(_seen(one, *signs) for one in cylinders) for signs in ((1, 1), (-1, 1), (1, -1))
        )
        return Symmetry(x=in_x == there, y=in_y == there)

    def turned(self, angle: float) -> "Scene":
        """Return it as seen from axes that are turned from x to y by an angle, rad."""
        if angle == 0:
            return self
        return replace(self, surfaces=tuple(surface.turned(angle) for surface in self.surfaces))


_SAME = 12  # decimals in which numbers of mirror images agree, whose axes are turned


def _seen(cylinder: Cylinder, x: int, y: int) -> tuple[object, ...]:
    """Return all of a cylinder but its names, with the signs of x and y changed as asked for."""
    across, along, up = cylinder.axis
    axis = [round(one, _SAME) for one in (up, y * along, x * across)]
    sign = next(math.copysign(1.0, one) for one in axis if one)
    # any place is on an axis along x
    place = 0.0 if axis[:2] == [0, 0] else round(x * cylinder.x, _SAME)
    sides = ((one.material, one.attenuation) for one in cylinder.sides)
    return (place, cylinder.z, cylinder.radius, *(sign * one for one in axis), *sides)


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
