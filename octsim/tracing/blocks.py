"""A block of rays that have come the same way: one step of them all at a time, lane by lane.

Loops that choose lanes are apart from loops that compute, so that the compiler computes several
lanes with each instruction, and functions are inlined, as a block's step is short.
"""

import math
from collections.abc import Callable

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.optics.beam import crossing
from octsim.optics.interface import Vector, cos_transmitted_squared, reflect, refract, unit
from octsim.optics.intersection import plane_normal
from octsim.optics.turned_rays import AnyBeam
from octsim.tracing.faces import Faces, Kind, is_flat
from octsim.tracing.lanes import (
    CARRIED,
    LANES,
    PATH,
    RAY,
    VX,
    VY,
    VZ,
    Block,
    Lanes,
    X,
    Y,
    Z,
    direction,
    position,
    turn,
)
from octsim.tracing.meet import axis_of, meet, normal_from

NOWHERE = -1


@register_jitable(forceinline=True)
def meet_nearest(
    faces: Faces,
    departure: int,
    block: Block,
    n: int,
    face: NDArray[np.int64],
    distance: Lanes,
    cos_i: Lanes,
    to_face: Lanes,
    cos_there: Lanes,
) -> None:
    """Find for n lanes of a departure the face that each meets next, −1 if none, and how far.

    `to_face` and `cos_there` are room to work in.
    """
    begin, end = faces.first[departure], faces.first[departure + 1]
    if begin < end:
        f = faces.next_face[begin]
        meet(faces, begin, block, n, distance, cos_i)
        for i in range(n):
            face[i] = f if distance[i] < np.inf else NOWHERE
    else:
        for i in range(n):
            face[i] = NOWHERE
    for choice in range(begin + 1, end):
        f = faces.next_face[choice]
        meet(faces, choice, block, n, to_face, cos_there)
        for i in range(n):
            nearer = to_face[i] < distance[i]
            distance[i] = to_face[i] if nearer else distance[i]
            cos_i[i] = cos_there[i] if nearer else cos_i[i]
            face[i] = f if nearer else face[i]


@register_jitable(forceinline=True)
def choose(face: NDArray[np.int64], f: int, n: int, chosen: NDArray[np.uint32]) -> int:
    """List those of n lanes that meet face f; return how many."""
    count = 0
    for i in range(n):
        chosen[count] = i
        count += 1 if face[i] == f else 0
    return count


@register_jitable(forceinline=True)
def launch(
    beam: AnyBeam, first: int, n: int, focus: float, block: Block,
    launch_carried: Callable[[Block, int], None],
) -> None:  # fmt: skip
    """Fill n lanes with rays of a beam from the first given on, referred to the focal plane."""
    for i in range(n):
        x, y, path = crossing(beam, first + i)
        block[X + i], block[Y + i], block[Z + i] = x, y, focus
        block[VX + i], block[VY + i] = beam.vx[first + i], beam.vy[first + i]
        block[VZ + i] = beam.vz[first + i]
        block[PATH + i], block[RAY + i] = path, first + i
        launch_carried(block, i)


@register_jitable(forceinline=True)
def advance(block: Block, i: int, distance: float, n_i: float, to: Block, k: int) -> None:
    """Take lane i to the face that it meets, as lane k of another block."""
    to[X + k] = block[X + i] + distance * block[VX + i]
    to[Y + k] = block[Y + i] + distance * block[VY + i]
    to[Z + k] = block[Z + i] + distance * block[VZ + i]
    to[VX + k] = block[VX + i]
    to[VY + k] = block[VY + i]
    to[VZ + k] = block[VZ + i]
    to[PATH + k] = block[PATH + i] + distance * n_i
    to[RAY + k] = block[RAY + i]


@register_jitable(forceinline=True)
def advance_chosen(
    faces: Faces, f: int, block: Block, n: int, chosen: NDArray[np.uint32], count: int,
    distance: Lanes, cos_i: Lanes, to: Block, cos_met: Lanes, move: Callable[..., None],
) -> None:  # fmt: skip
    """Take the chosen ones of n lanes to the face that they meet, side by side in another block."""
    n_i, region = faces.n_i[f], faces.region[f]
    if count == n:
        for k in range(n):
            advance(block, k, distance[k], n_i, to, k)
            move(faces, region, block, k, distance[k], to, k)
            cos_met[k] = cos_i[k]
    else:
        for k in range(count):
            i = chosen[k]
            advance(block, i, distance[i], n_i, to, k)
            move(faces, region, block, i, distance[i], to, k)
            cos_met[k] = cos_i[i]


@register_jitable(forceinline=True)
def leave(
    met: Block,
    i: int,
    normal: Vector,
    n_i: float,
    n_t: float,
    cos_i: float,
    cos_t: float,
    beyond: Block,
) -> None:
    """Send lane i on, reflected where it is and transmitted as lane i of another block."""
    along = direction(met, i)
    beyond[X + i] = met[X + i]
    beyond[Y + i] = met[Y + i]
    beyond[Z + i] = met[Z + i]
    beyond[PATH + i] = met[PATH + i]
    beyond[RAY + i] = met[RAY + i]
    turn(beyond, i, refract(along, normal, n_i, n_t, cos_i, cos_t))
    turn(met, i, reflect(along, normal, cos_i))


@register_jitable(forceinline=True)
def split(
    faces: Faces, f: int, met: Block, n: int, cos_i: Lanes, cos_t: Lanes, beyond: Block,
    split_carried: Callable[..., None],
) -> int:  # fmt: skip
    """Split n lanes at the face that they have met; return how many are totally reflected.

    The block `met` becomes the reflected light, `beyond` the transmitted. `cos_t` is filled too; it
    is negative for a totally reflected lane, whose transmitted lane means nothing.
    """
    kind, shape = faces.kind[f], faces.shape[f]
    n_i, n_t = faces.n_i[f], faces.n_t[f]
    total = 0
    for i in range(n):
        squared = cos_transmitted_squared(n_i, n_t, cos_i[i])
        passes = squared >= 0
        root = math.sqrt(max(squared, 0.0))
        total += 0 if passes else 1
        cos_t[i] = root if passes else -1.0
    split_carried(faces, f, met, n, cos_i, cos_t, beyond)
    if is_flat(kind):
        normal = plane_normal(kind == Kind.PLANE_FROM_ABOVE)
        for i in range(n):
            leave(met, i, normal, n_i, n_t, cos_i[i], cos_t[i], beyond)
    else:
        axis = axis_of(faces, f)
        curvature = (1.0 if kind == Kind.CYLINDER_FROM_OUTSIDE else -1.0) / shape[2]
        for i in range(n):
            normal = normal_from(axis, curvature, position(met, i))
            leave(met, i, normal, n_i, n_t, cos_i[i], cos_t[i], beyond)
            # far from where z = 0 the normal of a thin cylinder is not quite a unit vector
            turn(met, i, unit(direction(met, i)))
            turn(beyond, i, unit(direction(beyond, i)))
    return total


@register_jitable(forceinline=True)
def keep(block: Block, n: int, wanted: NDArray[np.bool_], carried: int) -> int:
    """Move the wanted ones of n lanes, which carry so many numbers, together; return how many."""
    kept = 0
    for i in range(n):
        if wanted[i]:
            for field in range(0, CARRIED + carried * LANES, LANES):
                block[field + kept] = block[field + i]
            kept += 1
    return kept


@register_jitable(forceinline=True)
def sift(
    reflected: Block, transmitted: Block, n: int, total: int, cos_t: Lanes, min_amplitude: float,
    wanted: NDArray[np.bool_], carried: int, strength: Callable[[Block, int], float],
) -> tuple[int, int]:  # fmt: skip
    """Keep of n split lanes those that exist and are not faint; return how many of each.

    `total` lanes, those of negative `cos_t`, are totally reflected; `wanted` is room to work in.
    """
    returned, through = n, n
    if total > 0 or min_amplitude > 0:
        for i in range(n):
            wanted[i] = cos_t[i] >= 0 and strength(transmitted, i) >= min_amplitude
        through = keep(transmitted, n, wanted, carried)
    if min_amplitude > 0:
        for i in range(n):
            wanted[i] = strength(reflected, i) >= min_amplitude
        returned = keep(reflected, n, wanted, carried)
    return returned, through
