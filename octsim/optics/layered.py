"""Scenes of any layers and cylinders: which surfaces there are between them, and their names.

A medium on both sides, by its name, is no surface. Cylinders lie in one layer, their host, and
exist nowhere else: a lifted one ends at its host's planes, with a part of the plane of its own.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise

from octsim.optics.scene import (
    NEURON_ON_GLASS,
    Cylinder,
    Plane,
    PlanePart,
    Region,
    Scene,
    Surface,
)

NEURON_FOOT = "foot"
"""Name, in the thesis's scene with a lifted neuron, of the plane's part that the neuron ends at."""


@dataclass(frozen=True)
class Layer:
    """A layer: its medium, as a region of the medium's name, and its thickness (µm)."""

    medium: Region
    thickness: float = math.inf
    """Of the lowest and the highest it is not read."""


@dataclass(frozen=True)
class Body:
    """A cylinder with its shells; lengths in µm, of its outermost surface."""

    media: tuple[Region, ...]
    """From outside in, each as a region of the medium's name."""
    shells: tuple[float, ...]
    """Thickness of each but the last."""
    diameter: float
    gap: float
    x: float = 0.0
    azimuth: float = 0.0
    elevation: float = 0.0

    @property
    def radii(self) -> tuple[float, ...]:
        """Outer radius of each medium."""
        return tuple(accumulate((-one for one in self.shells), initial=self.diameter / 2))


def layered(layers: Sequence[Layer], host: int, bodies: Sequence[Body]) -> Scene:
    """Return a scene of horizontal layers with cylinders in one of them.

    Surfaces are planes from below, with the parts of them that cylinders end at, then cylinders,
    each from outside in. A plane has the name of what is below it, a cylinder of what is in it; a
    plain cylinder above one plane has the thesis's names.

    Parameters
    ----------
    layers : sequence of Layer
        From below; the first ends at z = 0.
    host : int
        Place of the layer that the cylinders are in.
    bodies : sequence of Body
    """
    named = _numbered()
    tops = tuple(accumulate((layer.thickness for layer in layers[1:-1]), initial=0.0))
    regions, heights, around = [named(layers[0].medium)], [], 0
    for place, (below, above) in enumerate(pairwise(layers), start=1):
        embedded = place == host and len(regions) == 1 and bool(bodies)
        if above.medium.name != below.medium.name or embedded:
            regions.append(named(above.medium))
            heights.append(tops[place - 1])
        if place == host:
            around = len(regions) - 1
    floor = tops[host - 1] if host > 0 else 0.0
    medium = layers[host].medium.name
    walls = [_walls(body, floor, medium, regions[around], named) for body in bodies]
    between = zip(heights, pairwise(regions), strict=True)
    planes = [Plane(one.name, z, one, other) for z, (one, other) in between]
    parts = [
        part
        for plane in planes
        for part in _parts(plane, regions[around], [chain for chain in walls if chain])
    ]
    surfaces: tuple[Surface, ...] = (*parts, *(wall for chain in walls for wall in chain))
    # cylinders in the objective's medium have a plane below them that is none, once in and once out
    unseen = 2 if host > 0 and around == 1 and _alike(layers[: host + 1]) else 0
    return Scene(regions[0], _with_thesis_names(surfaces), unseen)


def _alike(layers: Sequence[Layer]) -> bool:
    return len({layer.medium.name for layer in layers}) == 1


def _numbered() -> Callable[[Region], Region]:
    """Return a function that tells regions of one medium apart by their names."""
    seen: Counter[str] = Counter()

    def named(medium: Region) -> Region:
        seen[medium.name] += 1
        number = seen[medium.name]
        return medium if number == 1 else replace(medium, name=f"{medium.name} {number}")

    return named


def _walls(
    body: Body, floor: float, medium: str, host: Region, named: Callable[[Region], Region]
) -> tuple[Cylinder, ...]:
    """Return the surfaces of a cylinder in a region of some medium, from outside in."""
    walls: list[Cylinder] = []
    outside = host
    for inner, radius in zip(body.media, body.radii, strict=True):
        if inner.name != medium:
            medium, inside = inner.name, named(inner)
            z = floor + body.gap + body.diameter / 2
            walls.append(
                Cylinder(
                    inside.name, body.x, z, radius, inside, outside, body.azimuth, body.elevation
                )
            )
            outside = inside
    return tuple(walls)


def _parts(
    plane: Plane, host: Region, bodies: Sequence[tuple[Cylinder, ...]]
) -> Iterator[Plane | PlanePart]:
    """Return a plane, in parts where lifted cylinders end at it."""
    above = plane.above == host
    lifted = [walls for walls in bodies if walls[0].elevation]
    if not lifted or host not in plane.sides:
        yield plane
        return
    outermost = tuple(walls[0] for walls in lifted)
    yield PlanePart(plane.name, plane.height, plane.below, plane.above, above, None, outermost)
    for walls in lifted:
        for wall, deeper in zip(walls, [*((one,) for one in walls[1:]), ()], strict=True):
            below, over = (plane.below, wall.inside) if above else (wall.inside, plane.above)
            end = "foot" if above else "head"
            yield PlanePart(
                f"{wall.name} {end}", plane.height, below, over, above, wall, tuple(deeper)
            )


def _with_thesis_names(surfaces: tuple[Surface, ...]) -> tuple[Surface, ...]:
    flat = [surface for surface in surfaces if not isinstance(surface, Cylinder)]
    if len({surface.height for surface in flat}) > 1 or len(surfaces) > len(flat) + 1:
        return surfaces
    plane, cylinder = NEURON_ON_GLASS
    names = (plane, NEURON_FOOT, cylinder) if len(flat) > 1 else (plane, cylinder)
    return tuple(replace(one, name=name) for one, name in zip(surfaces, names, strict=False))
