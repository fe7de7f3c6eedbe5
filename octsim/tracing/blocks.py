"""A block of rays that have come the same way: one step of them all at a time, lane by lane.

A block is one array with a stretch of `LANES` numbers for each quantity, so that lane i's x is
``block[X + i]``. The stretches are constants for the compiler's sake: it then knows that they do
not overlap and computes several lanes with each instruction. Loops that choose lanes are apart from
loops that compute, for the same reason, and functions are inlined, as a block's step is short.
"""

import math

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.optics.beam import Beam
from octsim.optics.interface import Vector, cos_transmitted_squared, fresnel, reflect, refract, unit
from octsim.optics.intersection import cross_cylinder, enter_cylinder, meet_plane
from octsim.tracing.faces import Faces, Kind

Block = NDArray[np.float64]
Lanes = NDArray[np.float64]

LANES = 128
X, Y, Z = 0 * LANES, 1 * LANES, 2 * LANES
VX, VY, VZ = 3 * LANES, 4 * LANES, 5 * LANES
AMPLITUDE = 6 * LANES
"""Amplitude relative to that at launch."""
PATH = 7 * LANES
"""Optical path length, µm."""
RAY = 8 * LANES
"""Number of the launched ray."""
BLOCK = 9 * LANES
NOWHERE = -1


@register_jitable(forceinline=True)
def position(block: Block, i: int) -> Vector:
    """Where lane i is, µm."""
    return Vector(block[X + i], block[Y + i], block[Z + i])


@register_jitable(forceinline=True)
def direction(block: Block, i: int) -> Vector:
    """Where lane i heads."""
    return Vector(block[VX + i], block[VY + i], block[VZ + i])


@register_jitable(forceinline=True)
def turn(block: Block, i: int, towards: Vector) -> None:
    """Have lane i head elsewhere."""
    block[VX + i] = towards.x
    block[VY + i] = towards.y
    block[VZ + i] = towards.z


@register_jitable(forceinline=True)
def meet(faces: Faces, f: int, block: Block, n: int, distance: Lanes, cos_i: Lanes) -> None:
    """Find the distance of n lanes to a face, and the cosine of incidence there."""
    kind, x, z, radius = faces.kind[f], faces.x[f], faces.z[f], faces.radius[f]
    if kind == Kind.CYLINDER_FROM_OUTSIDE:
        for i in range(n):
            distance[i], cos_i[i] = enter_cylinder(
                x, z, radius, position(block, i), direction(block, i)
            )
    elif kind == Kind.CYLINDER_FROM_INSIDE:
        for i in range(n):
            distance[i], cos_i[i] = cross_cylinder(
                x, z, radius, position(block, i), direction(block, i)
            )
    else:
        above = kind == Kind.PLANE_FROM_ABOVE
        for i in range(n):
            distance[i] = meet_plane(z, above, position(block, i), direction(block, i))
            cos_i[i] = abs(block[VZ + i])


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
        meet(faces, f, block, n, distance, cos_i)
        for i in range(n):
            face[i] = f if distance[i] < np.inf else NOWHERE
    else:
        for i in range(n):
            face[i] = NOWHERE
    for choice in range(begin + 1, end):
        f = faces.next_face[choice]
        meet(faces, f, block, n, to_face, cos_there)
        for i in range(n):
            nearer = to_face[i] < distance[i]
            distance[i] = to_face[i] if nearer else distance[i]
            cos_i[i] = cos_there[i] if nearer else cos_i[i]
            face[i] = f if nearer else face[i]


@register_jitable(forceinline=True)
def choose(face: NDArray[np.int64], f: int, n: int, chosen: NDArray[np.uint32]) -> int:
    """List those of n lanes that meet face f; give their number."""
    count = 0
    for i in range(n):
        chosen[count] = i
        count += 1 if face[i] == f else 0
    return count


@register_jitable(forceinline=True)
def launch(beam: Beam, first: int, n: int, focus: float, block: Block) -> None:
    """Fill n lanes with rays of a beam from the first given on, referred to the focus."""
    for i in range(n):
        block[X + i], block[Y + i], block[Z + i] = 0.0, 0.0, focus
        block[VX + i], block[VY + i] = beam.vx[first + i], beam.vy[first + i]
        block[VZ + i] = beam.vz[first + i]
        block[AMPLITUDE + i], block[PATH + i], block[RAY + i] = 1.0, 0.0, first + i


@register_jitable(forceinline=True)
def advance(block: Block, i: int, distance: float, n_i: float, to: Block, k: int) -> None:
    """Take lane i to the face that it meets, as lane k of another block."""
    to[X + k] = block[X + i] + distance * block[VX + i]
    to[Y + k] = block[Y + i] + distance * block[VY + i]
    to[Z + k] = block[Z + i] + distance * block[VZ + i]
    to[VX + k] = block[VX + i]
    to[VY + k] = block[VY + i]
    to[VZ + k] = block[VZ + i]
    to[AMPLITUDE + k] = block[AMPLITUDE + i]
    to[PATH + k] = block[PATH + i] + distance * n_i
    to[RAY + k] = block[RAY + i]


@register_jitable(forceinline=True)
def advance_chosen(
    block: Block,
    n: int,
    chosen: NDArray[np.uint32],
    count: int,
    distance: Lanes,
    cos_i: Lanes,
    n_i: float,
    to: Block,
    cos_met: Lanes,
) -> None:
    """Take the chosen ones of n lanes to the face that they meet, side by side in another block."""
    if count == n:
        for k in range(n):
            advance(block, k, distance[k], n_i, to, k)
            cos_met[k] = cos_i[k]
    else:
        for k in range(count):
            i = chosen[k]
            advance(block, i, distance[i], n_i, to, k)
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
    faces: Faces, f: int, met: Block, n: int, cos_i: Lanes, cos_t: Lanes, beyond: Block
) -> int:
    """Split n lanes at the face that they have met; give how many are totally reflected.

    The block `met` becomes the reflected light, `beyond` the transmitted. `cos_t` is filled too; it
    is negative for a totally reflected lane, whose transmitted lane means nothing.
    """
    kind, x, z, radius = faces.kind[f], faces.x[f], faces.z[f], faces.radius[f]
    n_i, n_t = faces.n_i[f], faces.n_t[f]
    total = 0
    for i in range(n):
        squared = cos_transmitted_squared(n_i, n_t, cos_i[i])
        passes = squared >= 0
        root = math.sqrt(max(squared, 0.0))
        r, t = fresnel(n_i, n_t, cos_i[i], root)
        total += 0 if passes else 1
        cos_t[i] = root if passes else -1.0
        beyond[AMPLITUDE + i] = met[AMPLITUDE + i] * t
        met[AMPLITUDE + i] = met[AMPLITUDE + i] * (r if passes else 1.0)
    if kind == Kind.PLANE_FROM_BELOW or kind == Kind.PLANE_FROM_ABOVE:
        normal = Vector(0.0, 0.0, 1.0 if kind == Kind.PLANE_FROM_ABOVE else -1.0)
        for i in range(n):
            leave(met, i, normal, n_i, n_t, cos_i[i], cos_t[i], beyond)
    else:
        scale = (1.0 if kind == Kind.CYLINDER_FROM_OUTSIDE else -1.0) / radius
        for i in range(n):
            normal = Vector((met[X + i] - x) * scale, 0.0, (met[Z + i] - z) * scale)
            leave(met, i, normal, n_i, n_t, cos_i[i], cos_t[i], beyond)
            # far from where z = 0 the normal of a thin cylinder is not quite a unit vector
            turn(met, i, unit(direction(met, i)))
            turn(beyond, i, unit(direction(beyond, i)))
    return total


@register_jitable(forceinline=True)
def keep(block: Block, n: int, wanted: NDArray[np.bool_]) -> int:
    """Move the wanted ones of n lanes together; give their number."""
    kept = 0
    for i in range(n):
        if wanted[i]:
            for field in range(0, BLOCK, LANES):
                block[field + kept] = block[field + i]
            kept += 1
    return kept


@register_jitable(forceinline=True)
def sift(
    reflected: Block,
    transmitted: Block,
    n: int,
    total: int,
    cos_t: Lanes,
    min_amplitude: float,
    wanted: NDArray[np.bool_],
) -> tuple[int, int]:
    """Keep of n split lanes those that exist and are not faint; give how many of each.

    `total` lanes, those of negative `cos_t`, are totally reflected; `wanted` is room to work in.
    """
    returned, through = n, n
    if total > 0 or min_amplitude > 0:
        for i in range(n):
            wanted[i] = cos_t[i] >= 0 and abs(transmitted[AMPLITUDE + i]) >= min_amplitude
        through = keep(transmitted, n, wanted)
    if min_amplitude > 0:
        for i in range(n):
            wanted[i] = abs(reflected[AMPLITUDE + i]) >= min_amplitude
        returned = keep(reflected, n, wanted)
    return returned, through
