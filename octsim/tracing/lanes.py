"""The layout of a block: a stretch of `LANES` numbers for each quantity of its rays.

Lane i's x is ``block[X + i]``. The stretches are constants for the compiler's sake: it then knows
that they do not overlap and computes several lanes with each instruction.
"""

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.optics.interface import Vector

Block = NDArray[np.float64]
Lanes = NDArray[np.float64]

LANES = 128
X, Y, Z = 0 * LANES, 1 * LANES, 2 * LANES
VX, VY, VZ = 3 * LANES, 4 * LANES, 5 * LANES
PATH = 6 * LANES
"""Optical path length, µm."""
RAY = 7 * LANES
"""Place of the launched ray in its beam."""
CARRIED = 8 * LANES
"""What the ray carries besides, one stretch for each number; see `octsim.tracing.carry`."""


@register_jitable(forceinline=True)
def position(block: Block, i: int) -> Vector:
    """Return where lane i is, µm."""
    return Vector(block[X + i], block[Y + i], block[Z + i])


@register_jitable(forceinline=True)
def direction(block: Block, i: int) -> Vector:
    """Return where lane i heads."""
    return Vector(block[VX + i], block[VY + i], block[VZ + i])


@register_jitable(forceinline=True)
def turn(block: Block, i: int, towards: Vector) -> None:
    """Have lane i head elsewhere."""
    block[VX + i] = towards.x
    block[VY + i] = towards.y
    block[VZ + i] = towards.z
