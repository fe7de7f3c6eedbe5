"""The trees of counted rays in a scene: how many rays are traced at once, and what is dropped."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.optics.detector import Outcome
from octsim.optics.scene import Cylinder, Scene, Surface
from octsim.schemes.cost import tree_pieces

_AT_ONCE = 1e7  # numbers of rays that come back
_COME_BACK = 0.15  # of the pieces of a tree
_THESIS = 75.0
"""Pieces of a tree that is no larger than the thesis's: all rays are traced at once."""
_TRACED_TO_END = [
    Outcome.DETECTED, Outcome.OFF_DETECTOR, Outcome.OFF_OBJECTIVE, Outcome.ESCAPED, Outcome.SPENT
]  # fmt: skip


def rays_at_once(
    scene: Scene, max_intersections: int, min_amplitude: float, numbers: int
) -> float:
    """Return how many rays go through a scene at once, so that what comes back can be held.

    Parameters
    ----------
    scene : Scene
    max_intersections : int
    min_amplitude : float
    numbers : int
        That are held of each ray that comes back.
    """
    pieces = tree_pieces(_more_surfaces(scene), max_intersections, min_amplitude)
    return np.inf if pieces <= _THESIS else max(1.0, _AT_ONCE / (_COME_BACK * pieces * numbers))


def _more_surfaces(scene: Scene) -> int:
    """Return how many planes and walls of a cylinder there are that the thesis's does not have."""
    split = [one for one in scene.surfaces if _contrasts(one)]
    walls = Counter(
        (one.x, one.z, one.azimuth, one.elevation) for one in split if isinstance(one, Cylinder)
    )
    heights = {one.row for one in split if not isinstance(one, Cylinder)}
    return max(0, len(heights) - 1 + max(walls.values(), default=1) - 1)


def _contrasts(surface: Surface) -> bool:
    one, other = surface.sides
    return one.material != other.material


def dropped_field(outcomes: NDArray[np.int64], options: Mapping[str, Any]) -> float:
    """Return about what field the rays below ``min_amplitude`` would have brought, at most.

    Each has just less than that; of them as many would be detected as of those that were traced.
    """
    ends = int(outcomes[_TRACED_TO_END].sum())
    if not options["min_amplitude"] or not ends:
        return 0.0
    detected = float(outcomes[Outcome.DETECTED]) / ends
    faint = float(outcomes[Outcome.FAINT])
    return faint * detected * float(options["min_amplitude"]) / float(options["rays"])
