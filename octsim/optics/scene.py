"""The scene: media, the surfaces between them, and the neuron over its glass slide."""

from dataclasses import dataclass
from enum import IntEnum


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


def neuron_on_glass(
    glass: float, water: float, neuron: float, gap: float, diameter: float
) -> Scene:
    """Return a neuron along y in water, a gap above the glass–water plane z = 0.

    Parameters
    ----------
    glass, water, neuron : float
        Refractive indices.
    gap, diameter : float
        Of the neuron, µm.
    """
    radius = diameter / 2
    return Scene(
        refractive_index=(glass, water, neuron),
        surfaces=(
            Plane(height=0.0, below=Medium.GLASS, above=Medium.WATER),
            Cylinder(
                x=0.0,
                z=gap + radius,
                radius=radius,
                inside=Medium.NEURON,
                outside=Medium.WATER,
            ),
        ),
    )
