"""Where a scene is its own mirror image: the frame in which it is solved."""

import math
from collections.abc import Iterable, Iterator
from itertools import combinations_with_replacement

from octsim.optics.scene import Cylinder, Scene, Surface

_QUARTER = 0.5 * math.pi
_NEVER = 1e-9
"""Cosine of the angle from y to an axis beside the optical one that never meets the plane y = 0."""


def mirror_azimuth(scene: Scene) -> float | None:
    """Return by which angle axes are turned, from x to y, to have a scene mirrored in y = 0, rad.

    In most there is none. Where there are several, level cylinders come to lie along y, and of two
    opposite angles it is the one of the same numbers whichever way a cylinder is lifted.

    Returns
    -------
    float or None
        0 if all cylinders are along y already.
    """
    cylinders = [one for one in scene.surfaces if isinstance(one, Cylinder)]
    if all(one.along_y for one in cylinders):
        return 0.0
    return next(
        (
            angle
            for angle in _tried(cylinders)
            if all(_can_be_turned(one, angle) for one in cylinders)
            and Scene(scene.objective, _turned(cylinders, angle)).symmetry.y
        ),
        None,
    )


def _tried(cylinders: Iterable[Cylinder]) -> Iterator[float]:
    """Return the angles of planes halfway between two axes, or across or along one."""
    # the same azimuth for both ways that one line can be lifted
    azimuths = dict.fromkeys(
        one.azimuth + (math.pi if one.elevation < 0 else 0.0) for one in cylinders
    )
    for more in (0.0, _QUARTER):
        for one, other in combinations_with_replacement(azimuths, 2):
            yield 0.5 * (one + other) + more
    yield from (0.0, _QUARTER)


def _can_be_turned(cylinder: Cylinder, angle: float) -> bool:
    return cylinder.x == 0 or abs(math.cos(cylinder.azimuth - angle)) > _NEVER


def _turned(cylinders: Iterable[Cylinder], angle: float) -> tuple[Surface, ...]:
    return tuple(one.turned(angle) for one in cylinders)
