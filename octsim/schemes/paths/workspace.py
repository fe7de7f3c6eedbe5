"""What the integration of a point works with: the point, room for tiles, and for weighted rays."""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.records import layout, room
from octsim.optics.beam import Beam
from octsim.optics.detector import Detector
from octsim.optics.turned_rays import Straight, Turning
from octsim.schemes.paths.aperture_tiles import Tile
from octsim.schemes.paths.chebyshev import HIGHEST, tables
from octsim.schemes.paths.check_rays import CHECK_RAYS, CheckRays
from octsim.schemes.paths.falloffs import Parabola, Series
from octsim.schemes.paths.line_crossings import MAP, TILE_LINE, Map, TileLine
from octsim.schemes.paths.patch_by_fit import SEARCH, Search
from octsim.schemes.paths.patch_integrals import RULES, Rules, fill_rules
from octsim.schemes.paths.polynomial_roots import BERNSTEIN_TABLES, BernsteinTables, fill_bernstein
from octsim.schemes.paths.waiting_tiles import WAITING_TILES, WaitingTiles
from octsim.tracing.follow import FOLLOW_ROOM, Bundle, FollowRoom, bundle_of
from octsim.tracing.lanes import LANES
from octsim.tracing.light_paths import LONGEST

MOST_RAYS = 2 * LANES
"""Rays of a survey: two blocks."""


class Tables:
    """Numbers that are the same for all points."""

    nodes_s: NDArray[np.float64]
    """Of each kind and number along s, and their transforms, from `chebyshev.tables`."""
    transforms_s: NDArray[np.float64]
    nodes_v: NDArray[np.float64]
    """The same along v."""
    transforms_v: NDArray[np.float64]
    rules: Rules
    bernstein: BernsteinTables


_nodes, _transforms = (2, HIGHEST + 1, HIGHEST), (2, HIGHEST + 1, HIGHEST, HIGHEST)
TABLES = layout(
    Tables, nodes_s=_nodes, transforms_s=_transforms, nodes_v=_nodes, transforms_v=_transforms,
    rules=RULES, bernstein=BERNSTEIN_TABLES,
)  # fmt: skip


@cache
def tables_of(symmetric: bool) -> Tables:
    """Return the tables of scenes that are symmetric in x, or are not."""
    made: Tables = room(TABLES)
    made.nodes_s[:], made.transforms_s[:] = tables(symmetric)
    made.nodes_v[:], made.transforms_v[:] = tables(True)
    fill_rules(made.rules)
    fill_bernstein(made.bernstein)
    return made


class Point(NamedTuple):
    """What is integrated, in a scene of some faces: the same for all paths and tiles."""

    symmetric: bool
    detector: Detector
    """Its radius is that within which light is accepted."""
    focus: float
    k_mid: float
    k_max: float
    falloff: Parabola | Series
    lens: Straight | Turning
    tables: Tables


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


class Workspace:
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


_rays, _square, _steps = (MOST_RAYS,), (HIGHEST, HIGHEST), (LONGEST,)
WORKSPACE = layout(
    Workspace, beam=layout(Beam, vx=_rays, vy=_rays, vz=_rays, amplitude=_rays, number=_rays),
    bundle=bundle_of(MOST_RAYS), rays=FOLLOW_ROOM, line=TILE_LINE, search=SEARCH, returns=MAP,
    exact=_square, rough=_square, values=_square, others=_square, between=_square, weight=_square,
    rough_weight=_square, face=_steps, through=_steps, waiting=WAITING_TILES, checks=CHECK_RAYS,
)  # fmt: skip


def room_for_point() -> Workspace:
    """Make the room that a point's tiles are worked on in."""
    made: Workspace = room(WORKSPACE)
    made.beam.amplitude[:], made.beam.number[:] = 1.0, np.arange(MOST_RAYS)
    return made
