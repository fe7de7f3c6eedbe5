"""What light can meet next: the scene as tables, one row for each side of a surface.

A *face* is a surface as met from one medium. Light that has been reflected at a face or transmitted
through it *departs* on one side of that surface, and from there only some faces can come next.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.scene import Cylinder, Medium, Plane, Scene


class Kind(IntEnum):
    """Shape of a face."""

    PLANE_FROM_BELOW = 0
    PLANE_FROM_ABOVE = 1
    CYLINDER_FROM_OUTSIDE = 2
    CYLINDER_FROM_INSIDE = 3


class Faces(NamedTuple):
    """Tables of F faces and D departures, for compiled code; departure 0 is the launch."""

    kind: NDArray[np.int64]
    """`Kind` of each face, (F,)."""
    surface: NDArray[np.int64]
    """Number of the surface in the scene, (F,)."""
    x: NDArray[np.float64]
    """Axis of a cylinder, (F,), µm."""
    z: NDArray[np.float64]
    """Height of a plane, or of a cylinder's axis, (F,), µm."""
    radius: NDArray[np.float64]
    """Radius of a cylinder, (F,), µm; 1 for a plane."""
    n_i: NDArray[np.float64]
    """Refractive index on the side of incidence, (F,)."""
    n_t: NDArray[np.float64]
    """Refractive index beyond, (F,)."""
    after_reflection: NDArray[np.int64]
    """Departure of the reflected light, (F,)."""
    after_transmission: NDArray[np.int64]
    """Departure of the transmitted light, (F,)."""
    next_face: NDArray[np.int64]
    """Faces that can come next, one departure's after the other's."""
    first: NDArray[np.int64]
    """Where each departure's faces begin in `next_face`, (D + 1,)."""
    n_objective: float
    """Refractive index of the medium that the objective lies in."""
    to_objective: NDArray[np.bool_]
    """Whether light of a departure is back in the medium of the objective, (D,)."""


Side = tuple[int, Medium]  # a surface and the medium on one side of it


def faces_of(scene: Scene) -> Faces:
    """Make the tables of a scene, whose objective lies in the first medium below everything."""
    sides: list[Side] = [(s, m) for s, surface in enumerate(scene.surfaces) for m in media(surface)]
    departures: list[Side] = [(-1, Medium.GLASS), *sides]
    following = [
        [f for f, side in enumerate(sides) if _can_follow(scene, d, side)] for d in departures
    ]
    others = [_other_side(scene, side) for side in sides]
    surfaces = [scene.surfaces[s] for s, _ in sides]
    index = scene.refractive_index
    return Faces(
        kind=np.array([_kind(surface, m) for surface, (_, m) in zip(surfaces, sides, strict=True)]),
        surface=np.array([s for s, _ in sides]),
        x=np.array([s.x if isinstance(s, Cylinder) else 0.0 for s in surfaces]),
        z=np.array([s.z if isinstance(s, Cylinder) else s.height for s in surfaces]),
        radius=np.array([s.radius if isinstance(s, Cylinder) else 1.0 for s in surfaces]),
        n_i=np.array([index[m] for _, m in sides]),
        n_t=np.array([index[m] for _, m in others]),
        after_reflection=np.array([departures.index(side) for side in sides]),
        after_transmission=np.array([departures.index(side) for side in others]),
        next_face=np.array([f for faces in following for f in faces]),
        first=np.cumsum([0, *map(len, following)]),
        n_objective=index[Medium.GLASS],
        to_objective=np.array([m == Medium.GLASS and s >= 0 for s, m in departures]),
    )


def media(surface: Plane | Cylinder) -> tuple[Medium, Medium]:
    """Give the media below and above a plane, or inside and outside a cylinder."""
    if isinstance(surface, Plane):
        return surface.below, surface.above
    return surface.inside, surface.outside


def _kind(surface: Plane | Cylinder, medium: Medium) -> Kind:
    if isinstance(surface, Plane):
        return Kind.PLANE_FROM_BELOW if medium == surface.below else Kind.PLANE_FROM_ABOVE
    inside = medium == surface.inside
    return Kind.CYLINDER_FROM_INSIDE if inside else Kind.CYLINDER_FROM_OUTSIDE


def _other_side(scene: Scene, side: Side) -> Side:
    s, medium = side
    inner, outer = media(scene.surfaces[s])
    return s, outer if medium == inner else inner


def _can_follow(scene: Scene, departure: Side, side: Side) -> bool:
    (standing_on, medium), (s, face_medium) = departure, side
    if medium != face_medium:
        return False
    # what stands on a plane or on the outside of a cylinder can't meet that again at once
    inside = _kind(scene.surfaces[s], medium) == Kind.CYLINDER_FROM_INSIDE
    return s != standing_on or inside
