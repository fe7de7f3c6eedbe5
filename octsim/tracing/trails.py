"""The places that rays of a light path come by, for pictures: followed by code as it is."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from octsim.base.records import room
from octsim.optics.beam import Beam
from octsim.tracing.carry import AMPLITUDE, Carry
from octsim.tracing.faces import Faces
from octsim.tracing.follow import follow_room, walk
from octsim.tracing.lanes import CARRIED, LANES, RAY, Block, Lanes, X, direction, position
from octsim.tracing.light_paths import LONGEST, steps_of

Array = NDArray[np.float64]
_COUNT, _PLACES = 1, 2
"""Numbers behind the amplitude: how many places there are, and their coordinates."""


def trails(faces: Faces, code: int, beam: Beam, focus: float, height: float) -> Array:
    """Return the places (N, V, 3) of rays on a light path, from a height to that height, µm.

    Parameters
    ----------
    faces : Faces
        Tables of the scene.
    code : int
        Of the path.
    beam : Beam
        N rays, at most as many as a block has lanes.
    focus : float
        Height of the focus, µm.
    height : float
        Where rays begin and end, µm; below all surfaces.

    Returns
    -------
    ndarray, shape (N, V, 3)
        Begin, where each surface is met, and end; NaN of rays that do not take the path.
    """
    face, through = np.empty(LONGEST, np.int64), np.empty(LONGEST, np.bool_)
    meetings = steps_of(faces, code, face, through)
    carry = _with_places(meetings)
    block, count, _ = walk(
        faces, face, through, meetings, beam, 0, beam.vx.size, focus,
        room(follow_room(carry.size)), carry.size, carry.launch, carry.move, carry.split,
    )  # fmt: skip
    found = np.full((beam.vx.size, meetings + 2, 3), np.nan)
    for i in range(count):
        ray = int(block[RAY + i])
        launched = np.array([beam.vx[ray], beam.vy[ray], beam.vz[ray]])
        found[ray, 0] = _at(np.array([0.0, 0.0, focus]), launched, height)
        first = CARRIED + _PLACES * LANES
        places = block[first + i : first + 3 * meetings * LANES : LANES]
        found[ray, 1:-1] = places.reshape(meetings, 3)
        here, along = np.array(position(block, i)), np.array(direction(block, i))
        found[ray, -1] = _at(here, along, height)
    return found


def _at(here: Array, along: Array, height: float) -> Array:
    """Return where a line is at a height."""
    place: Array = here + (height - here[2]) / along[2] * along
    return place


@cache
def _with_places(meetings: int) -> Carry:
    """Return a carry with the places of so many meetings besides the amplitude."""
    _, launch_own, move_own, split_own, strength = AMPLITUDE
    size = _PLACES + 3 * meetings

    def launch(block: Block, i: int) -> None:
        launch_own(block, i)
        block[CARRIED + _COUNT * LANES + i] = 0.0

    def move(
        faces: Faces, region: int, block: Block, i: int, distance: float, to: Block, k: int
    ) -> None:
        move_own(faces, region, block, i, distance, to, k)
        for number in range(_COUNT, size):
            to[CARRIED + number * LANES + k] = block[CARRIED + number * LANES + i]
        number = int(to[CARRIED + _COUNT * LANES + k])
        for axis in range(3):
            place = CARRIED + (_PLACES + 3 * number + axis) * LANES + k
            to[place] = to[X + axis * LANES + k]
        to[CARRIED + _COUNT * LANES + k] = number + 1

    def split(
        faces: Faces, f: int, met: Block, n: int, cos_i: Lanes, cos_t: Lanes, beyond: Block
    ) -> None:
        split_own(faces, f, met, n, cos_i, cos_t, beyond)
        for number in range(_COUNT, size):
            for i in range(n):
                place = CARRIED + number * LANES + i
                beyond[place] = met[place]

    return Carry(size, launch, move, split, strength)
