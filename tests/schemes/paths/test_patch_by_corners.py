"""Cells between nodes, judged by hand from what their corners and check rays say."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.base.records import room
from octsim.schemes.paths.aperture_tiles import Tile, fraction
from octsim.schemes.paths.chebyshev import LOOK
from octsim.schemes.paths.check_rays import CHECK_RAYS
from octsim.schemes.paths.patch_by_corners import (
    NEAR_AN_EDGE,
    USUALLY,
    Cells,
    corner,
    reached,
)
from octsim.schemes.paths.workspace import tables_of
from octsim.tracing.follow import bundle_of

RADIUS = 2.0
OFF_AXES, WHOLE = Tile(0.1, 0.2, 0.1, 0.2), Tile(0.0, 1.0, 0.0, 1.0)
ONE_CELL = Cells(0, 1, 0, 1)


def field_of(
    x: Any, y: Any, tile: Tile = OFF_AXES, cells: Cells = ONE_CELL, symmetric: bool = False,
    extrapolation: float = USUALLY, amplitude: Any = 1.0, followed: Any = True,
    seen: tuple[float, float, float] | None = None, inside: float = 1.0,
) -> tuple[float, Tile]:  # fmt: skip
    """Return what `reached` says of nodes (n, m) that return at x and y, in R_det.

    `seen` is the place (s, v) and amplitude of a check ray that is detected.
    """
    n, m = np.shape(x)
    bundle, checks = room(bundle_of(n * m)), room(CHECK_RAYS)
    bundle.cos[:], bundle.inside[:] = 1.0, inside
    for values, given in ((bundle.x, RADIUS * np.array(x)), (bundle.y, RADIUS * np.array(y)),
                          (bundle.amplitude, amplitude), (bundle.followed, followed)):  # fmt: skip
        values[:] = np.broadcast_to(given, (n, m)).ravel()
    checks.weight[:], checks.detected[0] = 0.0, 0
    if seen:
        checks.s[0], checks.v[0], checks.amplitude[0] = seen
        checks.weight[0], checks.detected[0] = 0.5, 1
    tables = tables_of(symmetric)
    along_s: NDArray[np.float64] = tables.nodes_s[LOOK, n]
    return reached(
        bundle, n, m, along_s, tables.nodes_v[LOOK, m], tile, cells, symmetric, RADIUS,
        extrapolation, checks,
    )  # fmt: skip


def test_a_cell_with_a_detected_corner_has_all_of_its_light() -> None:
    far = [[0.5, 10.0], [10.0, 10.0]]
    amplitude = [[1.0, 2.0], [3.0, -4.0]]
    found, part = field_of(far, far, amplitude=amplitude)
    assert part == OFF_AXES
    assert found == pytest.approx(2.5 * fraction(OFF_AXES, False), rel=1e-12)


def test_between_known_corners_light_goes_on_by_half_of_what_they_vary() -> None:
    near = np.full((2, 2), 0.1)
    # from 1.2 − 0.15 on
    assert field_of([[1.2, 1.5], [1.5, 1.5]], near) == (0.0, OFF_AXES)
    assert field_of([[-1.2, -1.5], [-1.5, -1.5]], near) == (0.0, OFF_AXES)
    # from 0.2 to 4.2, of which a square is within 1 in √(2 / 4)
    found, _ = field_of([[1.2, 3.2], [2.0, 2.0]], near)
    assert found == pytest.approx(math.sqrt(0.5) * fraction(OFF_AXES, False), rel=1e-12)


def test_past_the_rim_of_the_objective_a_cell_has_nothing() -> None:
    near = np.full((2, 2), 0.1)
    assert field_of(near, near, inside=-0.1) == (0.0, OFF_AXES)


def test_towards_an_unknown_corner_light_goes_on_by_what_it_varies_elsewhere() -> None:
    followed = np.zeros((4, 3), bool)
    followed[0, 0] = followed[2:, 2] = followed[3, 1] = True
    x, near = np.zeros((4, 3)), np.full((4, 3), 0.1)
    # elsewhere 1.5 along s and 0.5 along v: twice the larger of them
    x[0, 0], x[2, 2], x[3, 2], x[3, 1] = 3.5, 2.0, 3.5, 3.0
    assert field_of(x, near, followed=followed) == (0.0, OFF_AXES)
    found, part = field_of(x, near, followed=followed, extrapolation=NEAR_AN_EDGE)
    assert (part.s_min, part.v_min) == (OFF_AXES.s_min, OFF_AXES.v_min)
    # from 0.5 to 6.5
    assert found == pytest.approx(math.sqrt(2 / 6) * fraction(part, False), rel=1e-12)


def test_a_cell_where_a_check_ray_is_detected_has_its_field() -> None:
    far, near = np.full((3, 3), 9.0), np.full((3, 3), 0.1)
    place = (0.19, 0.19, -0.3)
    found, part = field_of(far, near, cells=Cells(0, 2, 0, 2), seen=place)
    assert part.s_min <= 0.19 <= part.s_max == OFF_AXES.s_max
    assert part.v_min <= 0.19 <= part.v_max == OFF_AXES.v_max
    assert found == pytest.approx(0.3 * fraction(part, False), rel=1e-12)
    # and no less where its corners say less
    steep = np.array([[1.2, 9.0, 9.0], [9.0, 9.0, 9.0], [9.0, 9.0, 9.0]])
    corners, part = field_of(steep, near, amplitude=0.1)
    assert 0 < corners < 0.1 * fraction(part, False)
    found, part = field_of(steep, near, amplitude=0.1, seen=(0.101, 0.101, 0.3))
    assert found == pytest.approx(0.3 * fraction(part, False), rel=1e-12)


def test_about_both_axes_a_patch_has_the_size_that_its_slopes_say() -> None:
    n = 3
    nodes = np.asarray(tables_of(True).nodes_s[LOOK, n, :n])
    along = np.sqrt(nodes)
    # an ellipse with half axes 0.2 and 0.3 of the aperture
    x, y = np.meshgrid(along / 0.2, along / 0.3, indexing="ij")
    for seen in (None, (0.001, 0.001, 1.0)):
        found, part = field_of(x, y, WHOLE, symmetric=True, seen=seen)
        # the mean of the falloff over a cell, of that it is in: to 0.5, and not 0.5 π/4
        share = 0.5 * (0.2 / math.sqrt(part.s_max)) * (0.3 / math.sqrt(part.v_max))
        assert part.s_max == part.v_max == nodes[1]
        assert found == pytest.approx(share * fraction(part, True), rel=1e-9)
    # seen in the next cell it counts
    found, part = field_of(x, y, WHOLE, Cells(1, 2, 0, 1), symmetric=True, seen=(0.5, 0.001, 0.3))
    assert found == pytest.approx(0.3 * fraction(part, True), rel=1e-9)


def test_a_corner_at_the_axes_is_the_largest_that_all_take() -> None:
    followed = np.zeros((5, 6), bool)
    followed[:4, :3] = followed[:3, :5] = True
    assert corner(followed.ravel(), 5, 6) == (3, 5)
    followed[0, 2] = False
    assert corner(followed.ravel(), 5, 6) == (0, 0)
