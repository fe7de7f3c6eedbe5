"""The scene of the scheme fullwave: one cylinder among planes, in numbers."""

import math
from itertools import pairwise
from typing import NamedTuple

from octsim.base.errors import OctsimError
from octsim.optics.scene import Cylinder, Plane, Region, Scene


class Layer(NamedTuple):
    """Of a medium."""

    n: complex
    """n + iκ."""
    thickness: float
    """µm; without end for the last one above."""


class CylinderOnPlane(NamedTuple):
    """A cylinder of diameter d over planes, its axis at x = offset; lengths in µm.

    The thesis's has one plane, z = 0. Others have films between glass and water, planes above the
    water, or shells.
    """

    n_glass: float
    """Below all planes."""
    n_water: float
    """Around the cylinder."""
    n_neuron: float
    """Of the cylinder."""
    gap: float
    """Between the plane below the water and the cylinder."""
    diameter: float
    """Of the outermost surface."""
    offset: float = 0.0
    """Of the axis, across it, from the optical axis."""
    kappa: float = 0.0
    """Of the cylinder: κ of its index n + iκ."""
    shells: tuple[Layer, ...] = ()
    """Of the cylinder, outside in."""
    films: tuple[Layer, ...] = ()
    """Between glass and water, from below."""
    room: float = math.inf
    """Thickness of the water."""
    above: tuple[Layer, ...] = ()
    """Beyond it, from below."""

    @property
    def radius(self) -> float:
        """Half the diameter, µm."""
        return self.diameter / 2

    @property
    def height(self) -> float:
        """Height of the axis over the plane below the water, µm."""
        return self.gap + self.radius

    @property
    def largest_index(self) -> float:
        """Of the water, the cylinder and its shells."""
        return max(self.n_neuron, self.n_water, *(shell.n.real for shell in self.shells))

    @property
    def far_side(self) -> float:
        """Optical path from the lowest plane to the cylinder's far side, or the highest plane, µm.

        Light that returns from there is the last one, but for what goes to and fro.
        """
        films = _path(self.films)
        if self.above:
            return films + self.n_water * self.room + _path(self.above[:-1])
        shells = _path(self.shells)
        core = self.diameter - 2 * sum(shell.thickness for shell in self.shells)
        return self.n_neuron * core + self.n_water * self.gap + 2 * shells + films

    @property
    def depth(self) -> float:
        """From the lowest plane to the highest one, µm."""
        if not self.above:
            return sum(film.thickness for film in self.films)
        return self.room + sum(layer.thickness for layer in (*self.films, *self.above[:-1]))

    @property
    def absorbs(self) -> bool:
        """Whether light is lost anywhere."""
        layers = (*self.shells, *self.films, *self.above)
        return self.kappa > 0 or any(complex(layer.n).imag > 0 for layer in layers)

    @property
    def one_plane(self) -> bool:
        """Whether there is but the plane between glass and water."""
        return not self.films and not self.above


def _path(layers: tuple[Layer, ...]) -> float:
    return sum(layer.n.real * layer.thickness for layer in layers)


def azimuth_of(scene: Scene) -> float:
    """Return the angle from the y axis to that of the scene's cylinder, rad."""
    return next(one.azimuth for one in scene.surfaces if isinstance(one, Cylinder))


def cylinder_on_plane(scene: Scene, wavenumber: float = 1.0) -> CylinderOnPlane:
    """Return the cylinder of a scene that reaches farthest, as `cylinders_of` has it."""
    return cylinders_of(scene, wavenumber)[0]


def cylinders_of(scene: Scene, wavenumber: float = 1.0) -> tuple[CylinderOnPlane, ...]:
    """Return a scene in numbers, at a wavenumber (1/µm); any, where its indices are constant.

    Returns
    -------
    tuple of CylinderOnPlane
        Among the same planes; the one that light returns from last is the first.

    Raises
    ------
    OctsimError
        If there is no cylinder, one is not level, they are not parallel, or light is lost in what
        is below all planes or around the cylinders.
    """
    every = _cylinders(scene)
    for place, (cylinder, _) in enumerate(every):
        key = f"scene.cylinders.{place}"
        if cylinder.elevation:
            raise OctsimError(
                f"{key}.elevation: given, but scheme fullwave has cylinders level; "
                "give tracing.scheme: paths"
            )
        if math.remainder(cylinder.azimuth - every[0][0].azimuth, math.pi):
            raise OctsimError(
                f"{key}.azimuth: not that of the first one, but scheme fullwave has parallel "
                "cylinders; give tracing.scheme: paths"
            )
    if not every:
        raise OctsimError("scene.cylinders: none given, but scheme fullwave needs one here")
    for region in (scene.objective, every[0][0].outside):
        if region.attenuates:
            raise OctsimError(
                f"scene: {region.name} attenuates, but scheme fullwave has light that is lost in "
                "cylinders and films alone; give tracing.scheme: paths or vogel"
            )
    found = [_among_planes(scene, *one, wavenumber) for one in every]
    return tuple(sorted(found, key=lambda one: -one.far_side))


def _among_planes(
    scene: Scene, cylinder: Cylinder, shells: list[Cylinder], wavenumber: float
) -> CylinderOnPlane:
    """Return a cylinder, given by its surfaces, in numbers."""
    host, core = cylinder.outside, (shells[-1] if shells else cylinder).inside
    planes = [surface for surface in scene.surfaces if isinstance(surface, Plane)]
    # by the axis, as a plane that a cylinder touches can seem to cut it by the last digit
    below = [plane for plane in planes if plane.height < cylinder.z]
    above = planes[len(below) :]
    floor = below[-1].height if below else 0.0
    radii = [one.radius for one in (cylinder, *shells)]
    thicknesses = (outer - inner for outer, inner in pairwise(radii))
    films = zip((plane.above for plane in below[:-1]), _thickness(below), strict=True)
    ends = [*_thickness(above), math.inf][: len(above)]
    beyond = zip((plane.above for plane in above), ends, strict=True)
    glass, water, neuron = (
        region.material.index(wavenumber).real for region in (scene.objective, host, core)
    )
    return CylinderOnPlane(
        glass, water, neuron, cylinder.z - cylinder.radius - floor, 2 * cylinder.radius,
        # an axis turned about the vertical one through (x, 0) is closer
        cylinder.x * math.cos(azimuth_of(scene)),
        core.attenuation_at(wavenumber) / (2 * wavenumber),
        tuple(
            _layer(one.outside, thickness, wavenumber)
            for one, thickness in zip(shells, thicknesses, strict=True)
        ),
        tuple(_layer(*film, wavenumber) for film in films),
        above[0].height - floor if above else math.inf,
        tuple(_layer(*layer, wavenumber) for layer in beyond),
    )  # fmt: skip


def _cylinders(scene: Scene) -> list[tuple[Cylinder, list[Cylinder]]]:
    """Return the outermost surface of each cylinder, and those within it, outside in."""
    found: list[tuple[Cylinder, list[Cylinder]]] = []
    for surface in scene.surfaces:
        if not isinstance(surface, Cylinder):
            continue
        # within the one before, and in what that is around
        if found and surface.outside == [found[-1][0], *found[-1][1]][-1].inside:
            found[-1][1].append(surface)
        else:
            found.append((surface, []))
    return found


def _thickness(planes: list[Plane]) -> list[float]:
    return [upper.height - lower.height for lower, upper in pairwise(planes)]


def _layer(region: Region, thickness: float, wavenumber: float) -> Layer:
    index = region.material.index(wavenumber).real
    kappa = region.attenuation_at(wavenumber) / (2 * wavenumber)
    return Layer(complex(index, kappa) if kappa else index, thickness)
