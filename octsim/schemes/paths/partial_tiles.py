"""Partially covered tiles: which of their parts are looked at next, as their cells tell.

Not all rays of such a tile take the path, so that nothing is fitted (`patch_by_corners`).
"""

import numpy as np
from numba.extending import register_jitable

from octsim.schemes.paths.aperture_tiles import area, between
from octsim.schemes.paths.chebyshev import FIT, LOOK
from octsim.schemes.paths.patch_by_corners import Cells, corner, reached
from octsim.schemes.paths.progress import PathGoal
from octsim.schemes.paths.waiting_tiles import OpenTile, push, push_halves
from octsim.schemes.paths.workspace import Point, Workspace

MOST_TO_LOOK = 9
"""Nodes along an axis that polynomials fit, of those to look with."""
_BLOCK = 4  # cells along an axis of those that go on as one
MIXED = 4
"""Nodes along each axis of a partially covered tile."""


@register_jitable
def look(
    point: Point, work: OpenTile, may_miss: float, extrapolation: float, space: Workspace
) -> tuple[float, OpenTile]:
    """Have the parts of a partially covered tile wait, or leave them out if they are faint.

    `may_miss` is the field that may still be left out.

    Returns
    -------
    missing : float
        Field that is left out.
    covered : OpenTile
        The corner next to the axes whose nodes all take the path; its n is 0 if there is none.
    """
    tile, n, m, kind, allotment, _, _ = work
    along_s, along_v = point.tables.nodes_s[kind, n], point.tables.nodes_v[kind, m]
    radius = point.detector.radius
    p, q = corner(space.bundle.followed, n, m) if kind == LOOK else (0, 0)
    missing = 0.0
    # all of the tile, or what lies to the right of the corner and above it
    parts = (
        Cells(max(p - 1, 0), n - 1, 0, m - 1),
        Cells(0, max(p - 1, 0), max(q - 1, 0), m - 1),
    )
    for cells in parts:
        bound, part = reached(
            space.bundle, n, m, along_s, along_v, tile, cells, point.symmetric, radius,
            extrapolation, space.checks,
        )  # fmt: skip
        rest = OpenTile(part, MIXED, MIXED, LOOK, allotment, bound, np.inf)
        if bound <= 0.25 * max(may_miss - missing, 0.0):
            missing += bound
        elif area(part, point.symmetric) < 0.6 * area(tile, point.symmetric):
            push(space.waiting, rest)
        else:
            push_halves(space.waiting, rest, point.symmetric)
    if p == 0:
        return missing, OpenTile(tile, 0, 0, kind, allotment, 0.0, np.inf)
    near = between(tile, n, m, along_s, along_v, 0, p - 1, 0, q - 1)
    return missing, OpenTile(near, p, q, kind, allotment, 0.0, np.inf)


@register_jitable
def look_closely(
    point: Point, work: OpenTile, may_miss: float, goal: PathGoal, covered: bool, space: Workspace
) -> float:
    """Have the parts of a tile with many nodes wait, as its cells tell; return what is left out.

    `covered` is one that all nodes take the path of. Others go on in blocks of a few cells, so that
    nothing of what their nodes tell is forgotten.
    """
    tile, n, m, kind, allotment, _, _ = work
    along_s, along_v = point.tables.nodes_s[kind, n], point.tables.nodes_v[kind, m]
    radius = point.detector.radius
    step_s, step_v = (n - 1, m - 1) if covered else (_BLOCK, _BLOCK)
    orders, next_kind = (goal.orders, FIT) if covered else ((MIXED, MIXED), LOOK)
    missing = 0.0
    for i in range(0, n - 1, step_s):
        for j in range(0, m - 1, step_v):
            cells = Cells(i, min(i + step_s, n - 1), j, min(j + step_v, m - 1))
            bound, part = reached(
                space.bundle, n, m, along_s, along_v, tile, cells, point.symmetric, radius,
                goal.extrapolation, space.checks,
            )  # fmt: skip
            if bound <= 0.25 * max(may_miss - missing, 0.0):
                missing += bound
            else:
                push(
                    space.waiting,
                    OpenTile(part, orders[0], orders[1], next_kind, allotment, bound, np.inf),
                )
    return missing
