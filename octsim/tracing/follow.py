"""Following rays along one light path: those that take it, to where they would leave the focus."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.records import layout
from octsim.optics.beam import Beam
from octsim.optics.detector import Detector, at_plane, rim_margin, to_fibre
from octsim.optics.turned_rays import AnyBeam, Straight, Turning, path_by_lens, through_lens, turned
from octsim.tracing.blocks import advance_chosen, choose, keep, launch, meet_nearest, split
from octsim.tracing.carry import AMPLITUDE
from octsim.tracing.faces import Faces
from octsim.tracing.lanes import CARRIED, LANES, PATH, RAY, Block, direction, position

_CARRIED, _launch, _move, _split, _ = AMPLITUDE


class Bundle:
    """What becomes of N rays on one light path."""

    followed: NDArray[np.bool_]
    """Whether each takes that path to the objective's side, (N,)."""
    x: NDArray[np.float64]
    """X cos θ for the place X where it leaves the focal plane at an angle θ, (N,), µm."""
    y: NDArray[np.float64]
    """Y cos θ, (N,), µm."""
    cos: NDArray[np.float64]
    """cos θ, (N,)."""
    inside: NDArray[np.float64]
    """`octsim.optics.detector.rim_margin`, (N,)."""
    amplitude: NDArray[np.float64]
    """Product of the Fresnel coefficients, (N,)."""
    optical_path_length: NDArray[np.float64]
    """Path from the focus to the fibre, (N,), µm."""


class FollowRoom:
    """Room for a block of rays on its way."""

    blocks: NDArray[np.float64]
    distance: NDArray[np.float64]
    cos_i: NDArray[np.float64]
    cos_met: NDArray[np.float64]
    cos_t: NDArray[np.float64]
    wanted: NDArray[np.bool_]
    face: NDArray[np.int64]
    chosen: NDArray[np.uint32]


def follow_room(carried: int) -> "np.dtype[Any]":
    """Return the layout of room for rays that carry so many numbers."""
    each = (LANES,)
    return layout(
        FollowRoom, blocks=(3, CARRIED + carried * LANES), distance=each, cos_i=each, cos_met=each,
        cos_t=each, wanted=each, face=each, chosen=each,
    )  # fmt: skip


FOLLOW_ROOM = follow_room(_CARRIED)


def bundle_of(rays: int) -> "np.dtype[Any]":
    """Return the layout of a bundle with room for some rays."""
    each = (rays,)
    return layout(
        Bundle, followed=each, x=each, y=each, cos=each, inside=each, amplitude=each,
        optical_path_length=each,
    )  # fmt: skip


@register_jitable
def walk(
    faces: Faces,
    face: NDArray[np.int64],
    through: NDArray[np.bool_],
    meetings: int,
    beam: AnyBeam,
    first: int,
    n: int,
    focus: float,
    room: FollowRoom,
    carried: int,
    launch_carried: Callable[[Block, int], None],
    move: Callable[..., None],
    split_carried: Callable[..., None],
) -> tuple[Block, int, int]:
    """Take n rays of a beam along one light path, those that take it.

    Parameters
    ----------
    faces : Faces
        Tables of the scene.
    face, through : ndarray
        The path, from `steps_of`.
    meetings : int
        Its number of meetings.
    beam : Beam
        Rays.
    first, n : int
        The first of them, and how many: at most `LANES`.
    focus : float
        Height of the focus, µm.
    room : FollowRoom
        Room to work in.
    carried, launch_carried, move, split_carried
        What they carry: of a `octsim.tracing.carry.Carry`.

    Returns
    -------
    block : ndarray
        Of those that came through, on their way to the objective.
    count : int
        How many there are.
    segments : int
        Traced.
    """
    now, met, beyond = room.blocks[0], room.blocks[1], room.blocks[2]
    launch(beam, first, n, focus, now, launch_carried)
    # slices are arrays of the kind that a tree works in, so that what both call is compiled once
    distance, cos_i, cos_met = room.distance[:], room.cos_i[:], room.cos_met[:]
    cos_t, met_face, chosen = room.cos_t[:], room.face[:], room.chosen[:]
    count, departure, segments = n, 0, 0
    for m in range(meetings):
        segments += count
        f = face[m]
        meet_nearest(
            faces, departure, now, count, met_face, distance, cos_i, cos_met,
            cos_t,
        )  # fmt: skip
        kept = choose(met_face, f, count, chosen)
        advance_chosen(
            faces, f, now, count, chosen, kept, distance, cos_i, met, cos_met,
            move,
        )  # fmt: skip
        total = split(faces, f, met, kept, cos_met, cos_t, beyond, split_carried)
        if through[m] and total > 0:
            for i in range(kept):
                room.wanted[i] = cos_t[i] >= 0
            kept = keep(beyond, kept, room.wanted, carried)
        if through[m]:
            now, beyond = beyond, now
            departure = faces.after_transmission[f]
        else:
            now, met = met, now
            departure = faces.after_reflection[f]
        count = kept
    return now, count, segments + count


@register_jitable
def follow(
    faces: Faces,
    face: NDArray[np.int64],
    through: NDArray[np.bool_],
    meetings: int,
    beam: Beam,
    n: int,
    detector: Detector,
    focus: float,
    lens: Straight | Turning,
    room: FollowRoom,
    bundle: Bundle,
) -> int:
    """Follow n rays along one light path, those that take it; return the segments traced.

    Parameters
    ----------
    faces, face, through, meetings, beam, n, focus, room
        As `walk` takes them.
    detector : Detector
        What receives them; those beside it are followed too.
    lens : Straight or Turning
        Whether an aberration turns them, in and out.
    bundle : Bundle
        What became of the rays: filled in.
    """
    for i in range(n):
        bundle.followed[i] = False
    now, count, segments = walk(
        faces, face, through, meetings, through_lens(beam, lens), 0, n, focus, room,
        _CARRIED, _launch, _move, _split,
    )  # fmt: skip
    for i in range(count):
        here, along = position(now, i), direction(now, i)
        ray = int(now[RAY + i])
        to_focus, at_focus = at_plane(focus, here, along)
        rest = to_fibre(detector, faces.n_objective, to_focus, at_focus)
        bundle.amplitude[ray] = now[CARRIED + i]
        x, y = here.x + to_focus * along.x, here.y + to_focus * along.y
        turn = path_by_lens(lens, detector, x, y, along.x, along.y, at_focus)
        bundle.optical_path_length[ray] = now[PATH + i] + rest + turn
        note_return(bundle, ray, detector, lens, x, y, along.x, along.y)
    return segments


@register_jitable(forceinline=True)
def note_return(
    bundle: Bundle, ray: int, detector: Detector, lens: Straight | Turning, x: float, y: float,
    vx: float, vy: float,
) -> None:  # fmt: skip
    """Note the line along which a ray returns, by its place in the focal plane and direction.

    A turned one is taken for that of no aberration, to the fibre and to the rim.
    """
    cos = math.sqrt(max(1 - vx * vx - vy * vy, 0.0))
    across, along, _ = turned(lens, vx, vy, 1.0)
    bundle.followed[ray] = True
    bundle.x[ray], bundle.y[ray], bundle.cos[ray] = (x - across) * cos, (y - along) * cos, cos
    bundle.inside[ray] = rim_margin(detector, bundle.x[ray], bundle.y[ray], vx, vy, cos)
