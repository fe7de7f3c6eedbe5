"""What light can meet next: the scene as tables, one row for each side of a surface.

A *face* is a surface as met from one region. Light that has been reflected at a face or transmitted
through it *departs* on one side of that surface, and from there only some faces can come next.
"""

from collections.abc import Mapping
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.optics.scene import Cylinder, Plane, PlanePart, Scene, Surface
from octsim.tracing.path_counts import MOST_PATHS, first_numbers, path_counts


class Kind(IntEnum):
    """Shape of a face."""

    PLANE_FROM_BELOW = 0
    PLANE_FROM_ABOVE = 1
    CYLINDER_FROM_OUTSIDE = 2
    CYLINDER_FROM_INSIDE = 3


KINDS: Mapping[type[Surface], tuple[Kind, Kind]] = {
    Plane: (Kind.PLANE_FROM_BELOW, Kind.PLANE_FROM_ABOVE),
    PlanePart: (Kind.PLANE_FROM_BELOW, Kind.PLANE_FROM_ABOVE),
    Cylinder: (Kind.CYLINDER_FROM_INSIDE, Kind.CYLINDER_FROM_OUTSIDE),
}
"""Kinds of the two faces of a surface, in the order of its `sides`."""
MET_AGAIN = (Kind.CYLINDER_FROM_INSIDE,)
"""Faces that what stands on them can meet again at once; what stands on others can't."""


class PlainFaces(NamedTuple):
    """Tables of F faces and D departures, for compiled code; departure 0 is the launch.

    They are those of the thesis's scene, or of plates.
    """

    kind: NDArray[np.int64]
    """`Kind` of each face, (F,)."""
    surface: NDArray[np.int64]
    """Number of the surface in the scene, (F,)."""
    shape: NDArray[np.float64]
    """Numbers that the kind needs, as the surface's `row` has them, (F, S)."""
    region: NDArray[np.int64]
    """Number of the region on the side of incidence, (F,); 0 is that of the objective."""
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
    """Refractive index of the region that the objective lies in."""
    to_objective: NDArray[np.bool_]
    """Whether light of a departure is back in the region of the objective, (D,)."""


class Meeting(IntEnum):
    """How a face of any scene is met: from what light can come to it, and with which formulas."""

    PLANE_FROM_BELOW = 0
    PLANE_FROM_ABOVE = 1
    PART_FROM_BELOW = 2
    """It is a part of a plane, and the light is on the side where that can't be told."""
    PART_FROM_ABOVE = 3
    ENTER = 4
    """A cylinder along y, from outside."""
    CROSS = 5
    """The same, from a point on its inside."""
    LEAVE = 6
    """The same, from elsewhere inside."""
    ENTER_TURNED = 7
    """A cylinder of another direction."""
    CROSS_TURNED = 8
    LEAVE_TURNED = 9


class AnyFaces(NamedTuple):
    """The tables of any scene: those of `PlainFaces`, and what a general one needs besides.

    Code is compiled anew for it, so that the thesis's scene has nothing of it.
    """

    kind: NDArray[np.int64]
    surface: NDArray[np.int64]
    shape: NDArray[np.float64]
    """Of a cylinder x, z, radius and axis (3); of a part of a plane its height, the number of
    cylinders that it is not in, whether it is in one, and then those cylinders, that one first."""
    region: NDArray[np.int64]
    n_i: NDArray[np.float64]
    n_t: NDArray[np.float64]
    after_reflection: NDArray[np.int64]
    after_transmission: NDArray[np.int64]
    next_face: NDArray[np.int64]
    first: NDArray[np.int64]
    n_objective: float
    to_objective: NDArray[np.bool_]
    meeting: NDArray[np.int64]
    """`Meeting` of each face in `next_face`."""
    counts: NDArray[np.int64]
    """Number of light paths of some more meetings from a departure to the objective, (L, D); of no
    L where the codes of paths are those of `PlainFaces`."""
    numbers: NDArray[np.int64]
    """Code of the first path of some meetings, (L,)."""


Faces = PlainFaces | AnyFaces


@register_jitable(forceinline=True)
def is_flat(kind: int) -> bool:
    """Return whether faces of a kind are planes."""
    return kind == Kind.PLANE_FROM_BELOW or kind == Kind.PLANE_FROM_ABOVE


def faces_at(scene: Scene, wavenumber: float) -> Faces:
    """Return the tables of a scene at a wavenumber, 1/µm; any, where all materials are constant."""
    index = [region.material.index(wavenumber).real for region in scene.regions]
    faces = _faces(scene, np.array(index))
    return faces if _is_plain(scene) else _any_faces(scene, faces)


def most_meetings(scene: Scene) -> int:
    """Return the most meetings of which all light paths of a scene have a code."""
    if _is_plain(scene) or not _is_counted(scene):
        digits = max(2, 2 * len(scene.surfaces))
        return next(n for n in range(64) if digits ** (n + 1) >= MOST_PATHS)
    return len(_counts(_faces(scene, np.ones(len(scene.regions))))) - 1


def _is_plain(scene: Scene) -> bool:
    cylinders = [one for one in scene.surfaces if isinstance(one, Cylinder)]
    return not cylinders or (len(scene.surfaces) == 2 and cylinders[0].along_y)


def _is_counted(scene: Scene) -> bool:
    # a plane and a turned cylinder have the light paths of the thesis's, by the same codes
    return len(scene.surfaces) > 2


def _faces(scene: Scene, index: NDArray[np.float64]) -> PlainFaces:
    regions, surfaces = scene.regions, scene.surfaces
    # faces 2 s and 2 s + 1 are those of surface s
    sides = [(s, regions.index(r)) for s, surface in enumerate(surfaces) for r in surface.sides]
    kinds = [kind for surface in surfaces for kind in KINDS[type(surface)]]
    departures = [(-1, 0), *sides]
    following = [
        [
            f
            for f, (s, region) in enumerate(sides)
            if region == here and (s != standing_on or kinds[f] in MET_AGAIN)
        ]
        for standing_on, here in departures
    ]
    face = np.arange(len(sides))
    region = np.array([region for _, region in sides], np.int64)
    rows = [surface.row for surface in surfaces for _ in surface.sides]
    width = max(map(len, rows), default=1)
    return PlainFaces(
        kind=np.array(kinds, np.int64),
        surface=face // 2,
        shape=np.array([row + (width - len(row)) * (0.0,) for row in rows]).reshape(-1, width),
        region=region,
        n_i=index[region],
        n_t=index[region[face ^ 1]],
        after_reflection=face + 1,
        after_transmission=(face ^ 1) + 1,
        next_face=np.array([f for faces in following for f in faces], np.int64),
        first=np.cumsum([0, *map(len, following)]),
        n_objective=float(index[0]),
        to_objective=np.array([s >= 0 and region == 0 for s, region in departures]),
    )


def _any_faces(scene: Scene, faces: PlainFaces) -> AnyFaces:
    rows = [_shape(surface) for surface in scene.surfaces for _ in surface.sides]
    width = max(map(len, rows))
    standing = np.concatenate(([-1], faces.surface))
    departures = np.repeat(np.arange(standing.size), np.diff(faces.first))
    meeting = [
        _meeting(scene.surfaces[f // 2], faces.kind[f], again=standing[d] == f // 2)
        for d, f in zip(departures.tolist(), faces.next_face.tolist(), strict=True)
    ]
    none = np.empty((0, standing.size), np.int64)
    counts = _counts(faces) if _is_counted(scene) else none
    return AnyFaces(
        *faces._replace(shape=np.array([row + (width - len(row)) * (0.0,) for row in rows])),
        np.array(meeting, np.int64), counts, first_numbers(counts),
    )  # fmt: skip


def _counts(faces: PlainFaces) -> NDArray[np.int64]:
    return path_counts(
        faces.first, faces.next_face, faces.after_reflection, faces.after_transmission,
        faces.to_objective,
    )  # fmt: skip


def _shape(surface: Surface) -> tuple[float, ...]:
    match surface:
        case Cylinder():
            return (surface.x, surface.z, surface.radius, *surface.axis)
        case PlanePart():
            cylinders = (*((surface.within,) if surface.within else ()), *surface.without)
            rows = (number for one in cylinders for number in _shape(one))
            return (surface.height, len(surface.without), surface.within is not None, *rows)
        case Plane():
            return surface.row


def _meeting(surface: Surface, kind: Kind, *, again: bool) -> Meeting:
    """Return how a face is met, `again` by light that stands on its surface."""
    match surface:
        case Cylinder():
            from_outside = kind == Kind.CYLINDER_FROM_OUTSIDE
            inside = Meeting.CROSS if again else Meeting.LEAVE
            how = Meeting.ENTER if from_outside else inside
            return how if surface.along_y else Meeting(how + Meeting.ENTER_TURNED - Meeting.ENTER)
        case PlanePart() if surface.cylinders_above == (kind == Kind.PLANE_FROM_BELOW):
            from_below = kind == Kind.PLANE_FROM_BELOW
            return Meeting.PART_FROM_BELOW if from_below else Meeting.PART_FROM_ABOVE
        case _:
            # on the cylinders' side light is in one of them, or is not
            from_below = kind == Kind.PLANE_FROM_BELOW
            return Meeting.PLANE_FROM_BELOW if from_below else Meeting.PLANE_FROM_ABOVE
