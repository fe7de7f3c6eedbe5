"""The length of a ray's way in each region, carried besides what else it carries."""

from functools import cache

from numba.extending import register_jitable

from octsim.tracing.carry import Carry
from octsim.tracing.faces import Faces
from octsim.tracing.lanes import CARRIED, LANES, Block, Lanes


@cache
def with_lengths(carry: Carry, regions: int) -> Carry:
    """Return a carry with the lengths of the way in so many regions too, behind its own numbers.

    They are µm from the focal plane to the focal plane, as if all of the glass beyond it were not
    passed: a length in the region of the objective can be negative.
    """
    own, launch_own, move_own, split_own, strength_own = carry
    first = CARRIED + own * LANES

    @register_jitable(forceinline=True)
    def launch(block: Block, i: int) -> None:
        launch_own(block, i)
        for r in range(regions):
            block[first + r * LANES + i] = 0.0

    @register_jitable(forceinline=True)
    def move(
        faces: Faces, region: int, block: Block, i: int, distance: float, to: Block, k: int
    ) -> None:
        move_own(faces, region, block, i, distance, to, k)
        for r in range(regions):
            way = distance if r == region else 0.0
            to[first + r * LANES + k] = block[first + r * LANES + i] + way

    @register_jitable(forceinline=True)
    def split(
        faces: Faces, f: int, met: Block, n: int, cos_i: Lanes, cos_t: Lanes, beyond: Block
    ) -> None:
        split_own(faces, f, met, n, cos_i, cos_t, beyond)
        for r in range(regions):
            for i in range(n):
                beyond[first + r * LANES + i] = met[first + r * LANES + i]

    return Carry(own + regions, launch, move, split, strength_own)
