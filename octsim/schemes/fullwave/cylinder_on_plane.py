"""The scene of the scheme fullwave: one cylinder over one plane, in numbers."""

import math
from typing import NamedTuple

from octsim.base.errors import OctsimError
from octsim.optics.scene import Cylinder, Plane, Scene


class CylinderOnPlane(NamedTuple):
    """A cylinder of diameter d over the plane z = 0, its axis at x = offset; lengths in µm."""

    n_glass: float
    """Below the plane."""
    n_water: float
    """Around the cylinder."""
    n_neuron: float
    """Of the cylinder."""
    gap: float
    """Between plane and cylinder."""
    diameter: float
    offset: float = 0.0
    """Of the axis, across it, from the optical axis."""
    kappa: float = 0.0
    """Of the cylinder: κ of its index n + iκ."""

    @property
    def radius(self) -> float:
        """Half the diameter, µm."""
        return self.diameter / 2

    @property
    def height(self) -> float:
        """Height of the axis over the plane, µm."""
        return self.gap + self.radius

    @property
    def far_side(self) -> float:
        """Optical path from the plane to the cylinder's far side, µm."""
        return self.n_neuron * self.diameter + self.n_water * self.gap


def azimuth_of(scene: Scene) -> float:
    """Return the angle from the y axis to that of the scene's cylinder, rad."""
    return next(one.azimuth for one in scene.surfaces if isinstance(one, Cylinder))


def cylinder_on_plane(scene: Scene, wavenumber: float = 1.0) -> CylinderOnPlane:
    """Return a scene in numbers, at a wavenumber (1/µm); any, where its indices are constant.

    Raises
    ------
    OctsimError
        If it is another scene than one cylinder over one plane, or light is lost outside of the
        cylinder.
    """
    match scene.surfaces:
        case (Plane() as plane, Cylinder() as cylinder):
            pass
        case _:
            raise OctsimError(
                f"scene: {len(scene.surfaces)} surfaces given, but scheme fullwave solves for one "
                "cylinder over one plane; give tracing.scheme: paths"
            )
    regions = plane.below, plane.above, cylinder.inside
    glass, water, neuron = (region.material.index(wavenumber).real for region in regions)
    for region in regions[:2]:
        if region.attenuates:
            raise OctsimError(
                f"scene: {region.name} attenuates, but scheme fullwave has a cylinder alone that "
                "does; give tracing.scheme: paths or vogel"
            )
    return CylinderOnPlane(
        glass, water, neuron, cylinder.z - cylinder.radius - plane.height, 2 * cylinder.radius,
        # an axis turned about the vertical one through (x, 0) is closer
        cylinder.x * math.cos(cylinder.azimuth),
        cylinder.inside.attenuation_at(wavenumber) / (2 * wavenumber),
    )  # fmt: skip
