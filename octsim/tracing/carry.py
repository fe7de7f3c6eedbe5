"""What a ray carries on its way: in isotropic media the way itself does not depend on it.

A block has some stretches of lanes for it, from `CARRIED` on. What they mean is chosen when a tree
is made: the functions of a `Carry` are constants of that tree, and cost nothing that they don't do.
"""

from collections.abc import Callable
from typing import NamedTuple

from numba.extending import register_jitable

from octsim.optics.interface import fresnel
from octsim.tracing.faces import Faces
from octsim.tracing.lanes import CARRIED, Block, Lanes


class Carry(NamedTuple):
    """What a ray carries, as functions for compiled code; each is one of a module."""

    size: int
    """Numbers that a ray carries."""
    launch: Callable[[Block, int], None]
    """Of a block and a lane: fill in what it has at launch, aimed at the focus."""
    move: Callable[[Faces, int, Block, int, float, Block, int], None]
    """Of the faces, a region, a block, a lane, a distance (µm), another block and its lane: take it
    along that distance in that region, to that lane of the other block. The distance is negative
    where a ray is referred back to its focus."""
    split: Callable[[Faces, int, Block, int, Lanes, Lanes, Block], None]
    """Of the faces, a face, a block of lanes that have met it and their number, the cosines of
    incidence and of refraction (−1 for a total reflection), and another block: make what the block
    carries that of the reflected light, and what the other carries that of the transmitted. The
    block has the directions of incidence still. A loop over the lanes."""
    strength: Callable[[Block, int], float]
    """Of a block and a lane: magnitude of what it carries, 1 at launch."""


@register_jitable(forceinline=True)
def _launch(block: Block, i: int) -> None:
    block[CARRIED + i] = 1.0


@register_jitable(forceinline=True)
def _move(
    _faces: Faces, _region: int, block: Block, i: int, _distance: float, to: Block, k: int
) -> None:
    to[CARRIED + k] = block[CARRIED + i]


@register_jitable(forceinline=True)
def _split(
    faces: Faces, f: int, met: Block, n: int, cos_i: Lanes, cos_t: Lanes, beyond: Block
) -> None:
    n_i, n_t = faces.n_i[f], faces.n_t[f]
    for i in range(n):
        r, t = fresnel(n_i, n_t, cos_i[i], max(cos_t[i], 0.0))
        beyond[CARRIED + i] = met[CARRIED + i] * t
        met[CARRIED + i] = met[CARRIED + i] * (r if cos_t[i] >= 0 else 1.0)


@register_jitable(forceinline=True)
def _strength(block: Block, i: int) -> float:
    return float(abs(block[CARRIED + i]))


AMPLITUDE = Carry(1, _launch, _move, _split, _strength)
"""The amplitude of unpolarised light, relative to that at launch (thesis §4.3.2)."""
