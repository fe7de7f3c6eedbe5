"""The scene: media, the surfaces between them, and the neuron over its glass slide."""

from dataclasses import dataclass
from enum import IntEnum

from octsim.config.models import SceneConfig


class Medium(IntEnum):
    """A region of one refractive index; the objective lies in the first."""

    GLASS = 0
    WATER = 1
    NEURON = 2


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


@dataclass(frozen=True)
class Scene:
    """Surfaces, and the refractive index of each medium between them."""

    refractive_index: tuple[float, ...]
    surfaces: tuple[Plane | Cylinder, ...]


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
