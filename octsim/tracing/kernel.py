"""The compiled ray tree, made for what its rays carry.

Rays that are neighbours in the aperture go through the tree together, as a block of lanes, along
one light path after the other, depth first.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.compiled import compiled
from octsim.optics.beam import Beam
from octsim.optics.detector import Acceptance, Detector, Outcome, at_plane, fate, to_fibre
from octsim.tracing.blocks import advance_chosen, choose, launch, meet_nearest, sift, split
from octsim.tracing.carry import AMPLITUDE, Carry
from octsim.tracing.faces import Faces
from octsim.tracing.lanes import (
    CARRIED,
    LANES,
    PATH,
    RAY,
    VX,
    VY,
    Block,
    Lanes,
    X,
    Y,
    direction,
    position,
)
from octsim.tracing.meet import reflects
from octsim.tracing.path_codes import code_behind, note_step, path_code

OUTCOMES = len(Outcome)
LENGTH, AT_X, AT_Y, AT_VX, AT_VY, FIRST_CARRIED = range(6)
"""Numbers of a ray that arrives, as a tree returns them; see `octsim.tracing.tree.Arrivals`."""


class _Arrived(NamedTuple):
    """Room for rays that arrive, one in a row."""

    labels: NDArray[np.int64]
    """Ray and path."""
    numbers: NDArray[np.float64]
    """Optical path, x, y, vx and vy, and what it carries."""


class _Waiting(NamedTuple):
    """Blocks that are still to be traced, the next one last."""

    blocks: NDArray[np.float64]
    lanes: NDArray[np.int64]
    departure: NDArray[np.int64]
    meetings: NDArray[np.int64]
    path: NDArray[np.int64]


@register_jitable(forceinline=True)
def _doubled(arrived: _Arrived) -> _Arrived:
    num, size = arrived.numbers.shape
    labels, numbers = np.empty((2 * num, 2), np.int64), np.empty((2 * num, size))
    for i in range(num):
        labels[i, 0], labels[i, 1] = arrived.labels[i, 0], arrived.labels[i, 1]
        for c in range(size):
            numbers[i, c] = arrived.numbers[i, c]
    return _Arrived(labels, numbers)


@register_jitable(forceinline=True)
def _room_for_waiting(num: int, size: int) -> _Waiting:
    return _Waiting(
        np.empty((num, size)), np.empty(num, np.int64), np.empty(num, np.int64),
        np.empty(num, np.int64), np.empty(num, np.int64),
    )  # fmt: skip


@register_jitable(forceinline=True)
def _wait(waiting: _Waiting, top: int, lanes: int, departure: int, meetings: int, path: int) -> int:
    """Have the block above `top` wait, as the next; return the new top."""
    waiting.lanes[top + 1] = lanes
    waiting.departure[top + 1] = departure
    waiting.meetings[top + 1] = meetings
    waiting.path[top + 1] = path
    return top + 1


@register_jitable(forceinline=True)
def _arrive(
    faces: Faces, detector: Detector, within: Acceptance, focus: float, block: Block, n: int,
    code: int, steps: NDArray[np.int64], meetings: int, arrived: _Arrived, count: int,
    outcomes: NDArray[np.int64], to_focus: Lanes, at_focus: Lanes, at_objective: Lanes,
    carried: int, move: Callable[..., None],
) -> tuple[_Arrived, int]:  # fmt: skip
    """Note which of n lanes on their way to the objective are accepted.

    The three `Lanes` are room to work in; the last two arguments are of the tree's `Carry`.
    """
    for i in range(n):
        here, along = position(block, i), direction(block, i)
        to_focus[i], at_focus[i] = at_plane(focus, here, along)
        _, at_objective[i] = at_plane(focus - detector.focus_distance, here, along)
    for i in range(n):
        outcome = fate(within, at_focus[i], at_objective[i])
        outcomes[outcome] += 1
        if outcome == Outcome.DETECTED:
            if count == arrived.labels.shape[0]:
                arrived = _doubled(arrived)
            rest = to_fibre(detector, faces.n_objective, to_focus[i], at_focus[i])
            move(faces, 0, block, i, to_focus[i], block, i)
            labels, numbers = arrived.labels[count], arrived.numbers[count]
            labels[0] = int(block[RAY + i])
            labels[1] = path_code(faces, steps, meetings, code)
            numbers[LENGTH] = block[PATH + i] + rest
            numbers[AT_X] = block[X + i] + to_focus[i] * block[VX + i]
            numbers[AT_Y] = block[Y + i] + to_focus[i] * block[VY + i]
            numbers[AT_VX], numbers[AT_VY] = block[VX + i], block[VY + i]
            for c in range(carried):
                numbers[FIRST_CARRIED + c] = block[CARRIED + c * LANES + i]
            count += 1
    return arrived, count


@cache
def make_tree(carry: Carry) -> Callable[..., tuple[Any, ...]]:
    """Return the compiled tree whose rays carry what is asked for.

    It takes what `octsim.tracing.tree.arrivals` takes, but the scene as `Faces`, and after the
    detector the radii within which rays are accepted. It returns the labels (2, D) of the rays that
    arrive (place in the beam, code of the path), their numbers (5 + C, D), segments and outcomes.

    Parameters
    ----------
    carry : Carry
        Its functions are part of the key under which the compiled code is kept.
    """
    carried, launch_carried, move, split_carried, strength = carry
    size = FIRST_CARRIED + carried

    @compiled(advance_chosen, split)
    def trace_tree(
        faces: Faces,
        beam: Beam,
        detector: Detector,
        within: Acceptance,
        focus: float,
        max_intersections: int,
        min_amplitude: float,
    ) -> tuple[Any, ...]:
        # a plain tuple: making a named one on the way out crashes when an interrupt is waiting
        rays = beam.vx.size
        arrived = _Arrived(np.empty((rays, 2), np.int64), np.empty((rays, size)))
        count_arrived, segments = 0, 0
        outcomes = np.zeros(OUTCOMES, np.int64)
        # depth first: above each block on the way wait two for each face that it can meet
        waiting = _room_for_waiting(
            (2 * faces.kind.size + 1) * (max_intersections + 1), CARRIED + carried * LANES
        )
        distance, cos_i, cos_t = np.empty(LANES), np.empty(LANES), np.empty(LANES)
        cos_met, wanted = np.empty(LANES), np.empty(LANES, np.bool_)
        face, chosen = np.empty(LANES, np.int64), np.empty(LANES, np.uint32)
        steps = np.empty(max_intersections + 1, np.int64)

        for first in range(0, rays, LANES):
            count = min(LANES, rays - first)
            launch(beam, first, count, focus, waiting.blocks[0], launch_carried)
            top = _wait(waiting, -1, count, 0, 0, 1)
            while top >= 0:
                n, d, m = waiting.lanes[top], waiting.departure[top], waiting.meetings[top]
                code, block = waiting.path[top], waiting.blocks[top]
                waiting.lanes[top] = 0  # done, but its children's blocks go above it
                if n == 0:
                    top -= 1
                    continue
                segments += n
                note_step(faces, steps, m, code)
                if faces.to_objective[d]:
                    arrived, count_arrived = _arrive(
                        faces, detector, within, focus, block, n, code, steps, m, arrived,
                        count_arrived, outcomes, distance, cos_i, cos_t, carried, move,
                    )  # fmt: skip
                    continue
                meet_nearest(faces, d, block, n, face, distance, cos_i, cos_met, cos_t)
                escaped = n
                for choice in range(faces.first[d], faces.first[d + 1]):
                    f = faces.next_face[choice]
                    count = choose(face, f, n, chosen)
                    escaped -= count
                    if m == max_intersections:
                        outcomes[Outcome.SPENT] += count
                        continue
                    met, beyond = waiting.blocks[top + 1], waiting.blocks[top + 2]
                    advance_chosen(
                        faces, f, block, n, chosen, count, distance, cos_i, met, cos_met, move
                    )
                    total = split(faces, f, met, count, cos_met, cos_t, beyond, split_carried)
                    returned, through = sift(
                        met, beyond, count, total, cos_t, min_amplitude, wanted, carried, strength
                    )
                    if not reflects(faces, f):
                        returned = 0
                    outcomes[Outcome.TOTALLY_REFLECTED] += total
                    outcomes[Outcome.FAINT] += 2 * count - total - through - returned
                    here = code_behind(faces, code, f)
                    top = _wait(waiting, top, returned, faces.after_reflection[f], m + 1, here)
                    top = _wait(waiting, top, through, faces.after_transmission[f], m + 1, here + 1)
                outcomes[Outcome.ESCAPED] += escaped
        return (
            arrived.labels[:count_arrived].T.copy(),
            arrived.numbers[:count_arrived].T.copy(),
            segments,
            outcomes,
        )

    return trace_tree


trace_amplitudes = make_tree(AMPLITUDE)
"""The tree of unpolarised light."""
