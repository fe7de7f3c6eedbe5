"""Rays that carry, besides their amplitude, the length of their way in each of three regions."""

from numba.extending import register_jitable

from octsim.tracing.carry import AMPLITUDE, Carry
from octsim.tracing.faces import Faces
from octsim.tracing.lanes import CARRIED, LANES, Block, Lanes

REGIONS = 3
LENGTHS = CARRIED + LANES
_, _launch, _move, _split, _strength = AMPLITUDE


@register_jitable(forceinline=True)
def launch(block: Block, i: int) -> None:
    _launch(block, i)
    for r in range(REGIONS):
        block[LENGTHS + r * LANES + i] = 0.0


@register_jitable(forceinline=True)
def move(
    faces: Faces, region: int, block: Block, i: int, distance: float, to: Block, k: int
) -> None:
    _move(faces, region, block, i, distance, to, k)
    for r in range(REGIONS):
        way = distance if r == region else 0.0
        to[LENGTHS + r * LANES + k] = block[LENGTHS + r * LANES + i] + way


@register_jitable(forceinline=True)
def split(
    faces: Faces, f: int, met: Block, n: int, cos_i: Lanes, cos_t: Lanes, beyond: Block
) -> None:
    _split(faces, f, met, n, cos_i, cos_t, beyond)
    for r in range(REGIONS):
        for i in range(n):
            beyond[LENGTHS + r * LANES + i] = met[LENGTHS + r * LANES + i]


LENGTHS_TOO = Carry(1 + REGIONS, launch, move, split, _strength)
