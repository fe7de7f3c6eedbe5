"""Light paths: which surfaces light meets, in order, and whether it is reflected at each.

A path's code is a number whose digits, in base 2 S for S surfaces, are its meetings: twice the
surface's number, plus one if the light goes through. A leading 1 keeps the zeros.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.optics.beam import Beam
from octsim.optics.detector import RIM, Detector, arrival, collect
from octsim.tracing.blocks import (
    AMPLITUDE,
    BLOCK,
    LANES,
    PATH,
    RAY,
    advance_chosen,
    choose,
    direction,
    keep,
    launch,
    meet_nearest,
    position,
    split,
)
from octsim.tracing.faces import Faces

LONGEST = 31
"""Most meetings that a code has room for."""


class Bundle(NamedTuple):
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
    """cos² θ (1 − (radius at the objective / that of its rim)²), (N,)."""
    amplitude: NDArray[np.float64]
    """Product of the Fresnel coefficients, (N,)."""
    optical_path_length: NDArray[np.float64]
    """Path from the focus to the fibre, (N,), µm."""


class Workspace(NamedTuple):
    """Room for a block of rays on its way."""

    blocks: NDArray[np.float64]
    distance: NDArray[np.float64]
    cos_i: NDArray[np.float64]
    cos_met: NDArray[np.float64]
    cos_t: NDArray[np.float64]
    wanted: NDArray[np.bool_]
    face: NDArray[np.int64]
    chosen: NDArray[np.uint32]


def path_name(code: int, surface_names: str = "PC") -> str:
    """Read the code of a light path: its surfaces in order, R reflected or T transmitted at each.

    Examples
    --------
    >>> path_name(0b1_01_11)
    'PT CT'
    """
    meetings = []
    while code > 1:
        code, digit = divmod(code, 2 * len(surface_names))
        meetings.append(surface_names[digit // 2] + "RT"[digit % 2])
    return " ".join(reversed(meetings))


@register_jitable
def steps_of(faces: Faces, code: int, face: NDArray[np.int64], through: NDArray[np.bool_]) -> int:
    """Read a path's code into the faces that it meets, and how it leaves each; give their number.

    `face` and `through` have room for `LONGEST` meetings.
    """
    base, num = faces.kind.size, 0
    rest = code
    while rest > 1:
        rest //= base
        num += 1
    departure = 0
    for m in range(num):
        digit = (code // base ** (num - 1 - m)) % base
        for choice in range(faces.first[departure], faces.first[departure + 1]):
            if faces.surface[faces.next_face[choice]] == digit // 2:
                face[m] = faces.next_face[choice]
        through[m] = digit % 2 == 1
        after = faces.after_transmission if through[m] else faces.after_reflection
        departure = after[face[m]]
    return num


@register_jitable
def room_for_following() -> Workspace:
    """Make the room that `follow` works in."""
    return Workspace(
        np.empty((3, BLOCK)), np.empty(LANES), np.empty(LANES), np.empty(LANES), np.empty(LANES),
        np.empty(LANES, np.bool_), np.empty(LANES, np.int64), np.empty(LANES, np.uint32),
    )  # fmt: skip


@register_jitable
def room_for_bundle() -> Bundle:
    """Make the room that `follow` fills."""
    return Bundle(
        np.empty(LANES, np.bool_), np.empty(LANES), np.empty(LANES), np.empty(LANES),
        np.empty(LANES), np.empty(LANES), np.empty(LANES),
    )  # fmt: skip


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
    room: Workspace,
    bundle: Bundle,
) -> int:
    """Follow n rays along one light path, those that take it, and give the segments traced.

    Parameters
    ----------
    faces : Faces
        Tables of the scene.
    face, through : ndarray
        The path, from `steps_of`.
    meetings : int
        Its number of meetings.
    beam : Beam
        Rays, at most `LANES` of them.
    n : int
        Number of rays.
    detector : Detector
        What receives them; one without bounds, so that those beside it are known too.
    focus : float
        Height of the focus, µm.
    room : Workspace
        Room to work in.
    bundle : Bundle
        What became of the rays: filled in.
    """
    now, met, beyond = room.blocks[0], room.blocks[1], room.blocks[2]
    launch(beam, 0, n, focus, now)
    count, departure, segments = n, 0, 0
    for i in range(n):
        bundle.followed[i] = False
    for m in range(meetings):
        segments += count
        f = face[m]
        meet_nearest(
            faces, departure, now, count, room.face, room.distance, room.cos_i, room.cos_met,
            room.cos_t,
        )  # fmt: skip
        kept = choose(room.face, f, count, room.chosen)
        advance_chosen(
            now, count, room.chosen, kept, room.distance, room.cos_i, faces.n_i[f], met,
            room.cos_met,
        )  # fmt: skip
        total = split(faces, f, met, kept, room.cos_met, room.cos_t, beyond)
        if through[m] and total > 0:
            for i in range(kept):
                room.wanted[i] = room.cos_t[i] >= 0
            kept = keep(beyond, kept, room.wanted)
        if through[m]:
            now, beyond = beyond, now
            departure = faces.after_transmission[f]
        else:
            now, met = met, now
            departure = faces.after_reflection[f]
        count = kept
    segments += count
    for i in range(count):
        here, along = position(now, i), direction(now, i)
        ray = int(now[RAY + i])
        to_focus, at_focus = arrival(focus, here, along)
        _, to_fibre = collect(detector, faces.n_objective, to_focus, at_focus)
        bundle.amplitude[ray] = now[AMPLITUDE + i]
        bundle.optical_path_length[ray] = now[PATH + i] + to_fibre
        x, y = here.x + to_focus * along.x, here.y + to_focus * along.y
        note_return(bundle, ray, detector, x, y, along.x, along.y)
    return segments


@register_jitable(forceinline=True)
def note_return(
    bundle: Bundle, ray: int, detector: Detector, x: float, y: float, vx: float, vy: float
) -> None:
    """Note the line along which a ray returns, by its place in the focal plane and direction."""
    cos = math.sqrt(max(1 - vx * vx - vy * vy, 0.0))
    at_x, at_y = x * cos + detector.focus_distance * vx, y * cos + detector.focus_distance * vy
    bundle.followed[ray] = True
    bundle.x[ray], bundle.y[ray], bundle.cos[ray] = x * cos, y * cos, cos
    rim = RIM * detector.objective_radius
    bundle.inside[ray] = cos * cos - (at_x * at_x + at_y * at_y) / (rim * rim)
