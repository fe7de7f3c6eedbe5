"""Whether part of an aperture's light passes a cylinder by: light from its edge is hard to see."""

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.compiled import compiled
from octsim.base.records import room
from octsim.optics.beam import Beam, aim
from octsim.schemes.paths.workspace import Point
from octsim.tracing.blocks import NOWHERE, advance_chosen, choose, keep, launch, meet_nearest, split
from octsim.tracing.carry import AMPLITUDE
from octsim.tracing.faces import Faces, is_flat
from octsim.tracing.follow import FOLLOW_ROOM, FollowRoom
from octsim.tracing.light_paths import LONGEST

_CARRIED, _launch, _move, _split, _ = AMPLITUDE
_ALONG_X, _ALONG_Y = 21, 10


@register_jitable
def _parts(faces: Faces, face: NDArray[np.int64], n: int) -> tuple[bool, bool]:
    """Return whether not all of n lanes meet one face, and whether that is the edge of something.

    It is not where light ends in the open that else meets a plane.
    """
    parts, ends, bent = False, False, False
    for i in range(n):
        parts = parts or face[i] != face[0]
        ends = ends or face[i] == NOWHERE
        bent = bent or (face[i] != NOWHERE and not is_flat(faces.kind[face[i]]))
    return parts, parts and (bent or not ends)


@compiled(advance_chosen, split)
def _meets_an_edge(faces: Faces, beam: Beam, focus: float, space: FollowRoom) -> bool:
    """Return whether rays that go through all surfaces do not all go through the same."""
    now, met, beyond = space.blocks[0], space.blocks[1], space.blocks[2]
    distance, cos_i, cos_met = space.distance[:], space.cos_i[:], space.cos_met[:]
    cos_t, face, chosen = space.cos_t[:], space.face[:], space.chosen[:]
    count, departure = beam.vx.size, 0
    launch(beam, 0, count, focus, now, _launch)
    for _ in range(LONGEST):
        meet_nearest(faces, departure, now, count, face, distance, cos_i, cos_met, cos_t)
        parts, edge = _parts(faces, face, count)
        if parts or face[0] == NOWHERE:
            return edge
        f = face[0]
        choose(face, f, count, chosen)
        advance_chosen(
            faces, f, now, count, chosen, count, distance, cos_i, met, cos_met, _move
        )  # fmt: skip
        total = split(faces, f, met, count, cos_met, cos_t, beyond, _split)
        if total > 0:
            if is_flat(faces.kind[f]):
                return True
            for i in range(count):
                space.wanted[i] = cos_t[i] >= 0
            count = keep(beyond, count, space.wanted, _CARRIED)
        if count == 0:
            return False
        now, beyond, departure = beyond, now, faces.after_transmission[f]
    return False


def light_misses(faces: Faces, point: Point) -> bool:
    """Return whether light of the planes x = 0 and y = 0 goes different ways through the scene."""
    radius = point.detector.objective_radius
    x = np.concatenate((np.linspace(-radius, radius, _ALONG_X), np.zeros(_ALONG_Y)))
    y = np.concatenate((np.zeros(_ALONG_X), np.linspace(0, radius, _ALONG_Y)))
    beam = Beam(*aim(x, y, point.detector.focus_distance), np.ones(x.size), np.arange(x.size))
    return bool(_meets_an_edge(faces, beam, point.focus, room(FOLLOW_ROOM)))
