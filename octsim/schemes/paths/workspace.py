"""What the integration of a point works with: the point, room for tiles, and for weighted rays."""

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.optics.beam import Beam
from octsim.optics.detector import Detector
from octsim.schemes.paths.aperture_tiles import Tile
from octsim.schemes.paths.chebyshev import HIGHEST
from octsim.schemes.paths.check_rays import CheckRays, room_for_checks
from octsim.schemes.paths.line_crossings import Map, TileLine, room_for_line
from octsim.schemes.paths.patch_by_fit import Search, room_for_search
from octsim.schemes.paths.patch_integrals import Rules
from octsim.schemes.paths.polynomial_roots import BernsteinTables
from octsim.schemes.paths.waiting_tiles import WaitingTiles, room_for_waiting
from octsim.tracing.faces import Faces
from octsim.tracing.follow import Bundle, FollowRoom, room_for_bundle, room_for_following
from octsim.tracing.lanes import LANES
from octsim.tracing.light_paths import LONGEST


MOST_RAYS = 2 * LANES
"""Rays of a survey: two blocks."""


class Point(NamedTuple):
    """What is integrated: the same for all paths and tiles."""

    faces: Faces
    symmetric: bool
    detector: Detector
    focus: float
    k_mid: float
    k_max: float
    nodes_s: NDArray[np.float64]
    """Of each kind and number along s, and their transforms, from `chebyshev.tables`."""
    transforms_s: NDArray[np.float64]
    nodes_v: NDArray[np.float64]
    """The same along v."""
    transforms_v: NDArray[np.float64]
    rules: Rules
    bernstein: BernsteinTables


class Survey(NamedTuple):
    """Rays over the whole aperture that returned, the paths' one after the other."""

    root: Tile
    orders: tuple[int, int]
    """Numbers of nodes along s and v."""
    code: NDArray[np.int64]
    """Each path's code, (P,)."""
    begin: NDArray[np.int64]
    """Where each path's rays begin, (P,)."""
    end: NDArray[np.int64]
    """Where they end, (P,)."""
    extrapolation: float
    """How far quantities may go on past known corners; see `patch_by_corners`."""
    bound: NDArray[np.float64]
    """An estimate of each path's field, (P,)."""
    strongest: NDArray[np.float64]
    """Largest amplitude of each path's rays, (P,)."""
    ray: NDArray[np.int64]
    """Place of each among the nodes, and behind them among the check rays."""
    amplitude: NDArray[np.float64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    vx: NDArray[np.float64]
    vy: NDArray[np.float64]
    check_s: NDArray[np.float64]
    """Places of its check rays, (CHECKS,)."""
    check_v: NDArray[np.float64]


class Workspace(NamedTuple):
    """Room to work on a tile in."""

    beam: Beam
    bundle: Bundle
    rays: FollowRoom
    line: TileLine
    search: Search
    returns: Map
    exact: NDArray[np.float64]
    rough: NDArray[np.float64]
    values: NDArray[np.float64]
    others: NDArray[np.float64]
    between: NDArray[np.float64]
    weight: NDArray[np.float64]
    rough_weight: NDArray[np.float64]
    face: NDArray[np.int64]
    through: NDArray[np.bool_]
    waiting: WaitingTiles
    checks: CheckRays
    """Of the path that is integrated."""


class WeightedRays(NamedTuple):
    """Room for weighted rays: nodes of the integral."""

    path: NDArray[np.int64]
    amplitude: NDArray[np.float64]
    rough_amplitude: NDArray[np.float64]
    optical_path_length: NDArray[np.float64]


@register_jitable
def room_for_point() -> Workspace:
    """Make the room that a point's tiles are worked on in."""
    square, most = (HIGHEST, HIGHEST), MOST_RAYS
    return Workspace(
        Beam(np.empty(most), np.empty(most), np.empty(most), np.ones(most), np.arange(most)),
        room_for_bundle(most), room_for_following(), room_for_line(), room_for_search(),
        Map(np.empty(square), np.empty(square), np.empty(square), np.empty(square)),
        np.empty(square), np.empty(square), np.empty(square), np.empty(square), np.empty(square),
        np.empty(square), np.empty(square),
        np.empty(LONGEST, np.int64), np.empty(LONGEST, np.bool_),
        room_for_waiting(), room_for_checks(),
    )  # fmt: skip


@register_jitable
def room_for_nodes(size: int) -> WeightedRays:
    """Make room for weighted rays; it grows as they come."""
    return WeightedRays(np.empty(size, np.int64), np.empty(size), np.empty(size), np.empty(size))
