"""The scene: media, the surfaces between them, and the neuron over its glass slide."""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config import SceneConfig


class Medium(IntEnum):
    """A region of one refractive index; the objective lies in the first."""

    GLASS = 0
    WATER = 1
    NEURON = 2


class Shape(IntEnum):
    """Shape of a surface."""

    PLANE = 0
    CYLINDER = 1


@dataclass(frozen=True)
class Plane:
    """A horizontal plane at a height (µm) between two media."""

    height: float
    below: Medium
    above: Medium


@dataclass(frozen=True)
class Cylinder:
    """A cylinder along y with its axis at (x, z), all in µm, between two media."""

    x: float
    z: float
    radius: float
    inside: Medium
    outside: Medium


class Surfaces(NamedTuple):
    """A scene as arrays, for compiled code; S surfaces, M media."""

    shape: NDArray[np.int64]
    """`Shape` of each surface, (S,)."""
    x: NDArray[np.float64]
    """Axis of a cylinder, (S,), µm."""
    z: NDArray[np.float64]
    """Height of a plane, or of a cylinder's axis, (S,), µm."""
    radius: NDArray[np.float64]
    """Radius of a cylinder, (S,), µm."""
    inner: NDArray[np.int64]
    """Medium below a plane or inside a cylinder, (S,)."""
    outer: NDArray[np.int64]
    """Medium above a plane or outside a cylinder, (S,)."""
    refractive_index: NDArray[np.float64]
    """Refractive index of each medium, (M,)."""


@dataclass(frozen=True)
class Scene:
    """Surfaces, and the refractive index of each medium between them."""

    refractive_index: tuple[float, ...]
    surfaces: tuple[Plane | Cylinder, ...]

    def arrays(self) -> Surfaces:
        """Give the scene as arrays."""
        rows = [
            (Shape.PLANE, 0.0, s.height, 0.0, s.below, s.above)
            if isinstance(s, Plane)
            else (Shape.CYLINDER, s.x, s.z, s.radius, s.inside, s.outside)
            for s in self.surfaces
        ]
        shape, x, z, radius, inner, outer = zip(*rows, strict=True)
        return Surfaces(
            np.array(shape, dtype=np.int64),
            np.array(x, dtype=np.float64),
            np.array(z, dtype=np.float64),
            np.array(radius, dtype=np.float64),
            np.array(inner, dtype=np.int64),
            np.array(outer, dtype=np.int64),
            np.array(self.refractive_index, dtype=np.float64),
        )


def neuron_on_glass(config: SceneConfig, diameter: float) -> Scene:
    """Lay a neuron of a diameter (µm) along y, a gap above the glass–water plane z = 0."""
    index = config.refractive_index
    radius = diameter / 2
    return Scene(
        refractive_index=(index.glass, index.water, index.neuron),
        surfaces=(
            Plane(height=0.0, below=Medium.GLASS, above=Medium.WATER),
            Cylinder(
                x=0.0,
                z=config.gap + radius,
                radius=radius,
                inside=Medium.NEURON,
                outside=Medium.WATER,
            ),
        ),
    )
