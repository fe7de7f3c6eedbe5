"""Rays of known light paths, with whatever they carry: the compiled code for each kind of that."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.compiled import compiled
from octsim.base.records import room
from octsim.optics.detector import Detector, at_plane, to_fibre
from octsim.optics.turned_rays import AnyBeam
from octsim.tracing.blocks import advance_chosen, split
from octsim.tracing.carry import Carry
from octsim.tracing.faces import Faces
from octsim.tracing.follow import FollowRoom, follow_room, walk
from octsim.tracing.kernel import AT_VX, AT_VY, AT_X, AT_Y, FIRST_CARRIED, LENGTH
from octsim.tracing.lanes import CARRIED, LANES, PATH, RAY, Block, direction, position
from octsim.tracing.light_paths import LONGEST, first_rays, steps_of

Integers = NDArray[np.int64]
PathTracer = Callable[[Faces, Integers, AnyBeam, Detector, float], NDArray[np.float64]]
"""Returns, of faces, the codes of the paths of N rays, those of one path side by side, a beam of
them, a detector and the height of the focus, the numbers (5 + C, N) of the rays on their paths, as
a tree has them; NaN for those that do not take theirs.
"""


@cache
def make_path_tracer(carry: Carry) -> PathTracer:
    """Return the function that takes rays along their light paths, with what they carry."""
    carried, launch_carried, move, split_carried, _ = carry
    size, space = FIRST_CARRIED + carried, follow_room(carried)

    @register_jitable
    def note(
        faces: Faces, detector: Detector, focus: float, block: Block, count: int,
        numbers: NDArray[np.float64],
    ) -> None:  # fmt: skip
        for i in range(count):
            here, along = position(block, i), direction(block, i)
            ray = int(block[RAY + i])
            to_focus, at_focus = at_plane(focus, here, along)
            rest = to_fibre(detector, faces.n_objective, to_focus, at_focus)
            move(faces, 0, block, i, to_focus, block, i)
            numbers[LENGTH, ray] = block[PATH + i] + rest
            numbers[AT_X, ray] = here.x + to_focus * along.x
            numbers[AT_Y, ray] = here.y + to_focus * along.y
            numbers[AT_VX, ray], numbers[AT_VY, ray] = along.x, along.y
            for c in range(carried):
                numbers[FIRST_CARRIED + c, ray] = block[CARRIED + c * LANES + i]

    @compiled(advance_chosen, split)
    def trace_paths(
        faces: Faces, codes: Integers, begin: Integers, beam: AnyBeam, detector: Detector,
        focus: float, room: FollowRoom,
    ) -> Any:  # fmt: skip
        face, through = np.empty(LONGEST, np.int64), np.empty(LONGEST, np.bool_)
        numbers = np.full((size, beam.vx.size), np.nan)
        for p in range(codes.size):
            meetings = steps_of(faces, codes[p], face, through)
            for first in range(begin[p], begin[p + 1], LANES):
                block, count, _ = walk(
                    faces, face, through, meetings, beam, first, min(LANES, begin[p + 1] - first),
                    focus, room, carried, launch_carried, move, split_carried,
                )  # fmt: skip
                note(faces, detector, focus, block, count, numbers)
        return numbers

    def numbers_of(
        faces: Faces, path: Integers, beam: AnyBeam, detector: Detector, focus: float
    ) -> NDArray[np.float64]:
        begin = np.append(first_rays(path), path.size)
        found: NDArray[np.float64] = trace_paths(
            faces, path[begin[:-1]], begin, beam, detector, focus, room(space)
        )
        return found

    return numbers_of
