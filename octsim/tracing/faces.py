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

from octsim.optics.scene import Cylinder, Plane, Scene, Surface


class Kind(IntEnum):
    """Shape of a face."""

    PLANE_FROM_BELOW = 0
    PLANE_FROM_ABOVE = 1
    CYLINDER_FROM_OUTSIDE = 2
    CYLINDER_FROM_INSIDE = 3


KINDS: Mapping[type[Surface], tuple[Kind, Kind]] = {
    Plane: (Kind.PLANE_FROM_BELOW, Kind.PLANE_FROM_ABOVE),
    Cylinder: (Kind.CYLINDER_FROM_INSIDE, Kind.CYLINDER_FROM_OUTSIDE),
}
"""Kinds of the two faces of a surface, in the order of its `sides`."""
MET_AGAIN = (Kind.CYLINDER_FROM_INSIDE,)
"""Faces that what stands on them can meet again at once; what stands on others can't."""


class Faces(NamedTuple):
    """Tables of F faces and D departures, for compiled code; departure 0 is the launch."""

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


@register_jitable(forceinline=True)
def is_flat(kind: int) -> bool:
    """Return whether faces of a kind are planes."""
    return kind == Kind.PLANE_FROM_BELOW or kind == Kind.PLANE_FROM_ABOVE


def faces_at(scene: Scene, wavenumber: float) -> Faces:
    """Return the tables of a scene at a wavenumber, 1/µm; any, where all materials are constant."""
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
    index = np.array([region.material.index(wavenumber).real for region in regions])
    face = np.arange(len(sides))
    region = np.array([region for _, region in sides], np.int64)
    rows = [surface.row for surface in surfaces for _ in surface.sides]
    width = max(map(len, rows), default=0)
    return Faces(
        kind=np.array(kinds, np.int64),
        surface=face // 2,
        shape=np.array([row + (width - len(row)) * (0.0,) for row in rows]),
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
