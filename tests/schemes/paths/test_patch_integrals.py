"""Integrals over a patch beside closed forms, of lines that return as polynomials say."""

import math
from typing import NamedTuple

import numpy as np
import pytest
from numpy.polynomial import chebyshev
from numpy.typing import NDArray
from scipy import integrate

from octsim.base.records import room
from octsim.schemes.paths.aperture_tiles import Tile
from octsim.schemes.paths.falloffs import Parabola
from octsim.schemes.paths.line_crossings import (
    MAP,
    TILE_LINE,
    Cut,
    cross,
    cross_edge,
    crossing_kind,
)
from octsim.schemes.paths.patch_integrals import moments
from octsim.schemes.paths.workspace import tables_of

Array = NDArray[np.float64]
RADIUS = 2.2
ALWAYS, WHOLE = math.inf, Tile(0.0, 1.0, 0.0, 1.0)


class Found(NamedTuple):
    """The integral of the falloff, and those of its products with the polynomials."""

    total: float
    exact: Array


def cut_of(
    tile: Tile,
    symmetric: bool,
    n: int,
    m: int,
    x: Array,
    y: Array,
    inside: Array | None = None,
) -> Cut:
    """Return a cut of coefficients of where light returns to; well within the rim, unless given."""
    returns = room(MAP)
    for name in ("x", "y", "cos", "inside"):
        getattr(returns, name)[:] = 0.0
    returns.x[: x.shape[0], : x.shape[1]] = x
    returns.y[: y.shape[0], : y.shape[1]] = y
    returns.cos[0, 0] = 1.0
    within = np.array([[0.5]]) if inside is None else inside
    returns.inside[: within.shape[0], : within.shape[1]] = within
    bernstein = tables_of(symmetric).bernstein
    return Cut(returns, n, m, tile, symmetric, RADIUS, Parabola(), bernstein)


def integrals(cut: Cut, tolerance: float) -> Found:
    exact, rough = np.empty((cut.n, cut.m)), np.empty((cut.n, cut.m))
    line, rules = room(TILE_LINE), tables_of(cut.symmetric).rules
    return Found(moments(cut, tolerance, rules, line, exact, rough), exact)


@pytest.mark.parametrize(("part", "v_max"), [(0.7, 1.0), (0.7, 0.25)])
def test_a_disk_about_the_axis_has_half_of_its_area(part: float, v_max: float) -> None:
    # X = R/part x and Y = R/part y: light of a disk of that radius, a quarter of it
    steep = np.array([[RADIUS / part]])
    tile = WHOLE._replace(v_max=v_max)
    found = integrals(cut_of(tile, True, 4, 3, steep, steep), ALWAYS)

    def along_x(y: float) -> float:
        return 2 / 3 * math.pow(part**2 - y**2, 1.5) / part**2

    expected = integrate.quad(along_x, 0, min(part, math.sqrt(v_max)), epsabs=1e-12)[0]
    assert found.total == pytest.approx(expected, rel=1e-6)
    if v_max == 1:
        assert expected == pytest.approx(math.pi * part**2 / 8, rel=1e-9)


def test_where_all_of_a_tile_is_detected_its_integrals_are_those_of_the_polynomials() -> None:
    # X = R (0.5 + 0.4 T_11(s)): nowhere zero, and never at the detector's edge
    n, m = 12, 3
    x = np.zeros((n, 1))
    x[0], x[-1] = 0.5 * RADIUS, 0.4 * RADIUS
    tile = Tile(-1.0, 1.0, 0.0, 0.5)
    found = integrals(cut_of(tile, False, n, m, x, np.zeros((1, 1))), 1e-9)
    xi, w = np.polynomial.legendre.leggauss(60)
    t = chebyshev.chebvander(xi, n - 1)
    along_s = (w * (1 - (0.5 + 0.4 * t[:, -1]) ** 2)) @ t
    # y = sin θ, from 0 to √0.5
    angle, w = (xi + 1) * math.pi / 8, w * math.pi / 8
    along_v = (w * np.cos(angle) ** 2) @ chebyshev.chebvander(4 * np.sin(angle) ** 2 - 1, m - 1)
    # as near as m + 3 nodes along y come
    np.testing.assert_allclose(found.exact, np.outer(along_s, along_v), atol=1e-7)
    assert found.total == pytest.approx(along_s[0] * along_v[0], rel=1e-8)


def test_a_patch_within_a_tile_is_found_between_its_ends_without_any_halves() -> None:
    # X = a (ξ − 0.2), Y = b y (y² − 0.3): light of a ring about (0.2, √0.3)
    tile, a, b = Tile(-0.6, 0.8, 0.16, 0.49), 8.0, 40.0
    x = np.array([[a * (0.1 - 0.2)], [a * 0.7]])
    y = np.array([[b * (0.325 - 0.3), b * 0.165]])
    found = integrals(cut_of(tile, False, 4, 4, x, y), ALWAYS)

    def along_x(y: float) -> float:
        left = RADIUS**2 - (b * y * (y**2 - 0.3)) ** 2
        return 4 / 3 * math.pow(max(left, 0.0), 1.5) / (a * RADIUS**2) * math.sqrt(1 - y**2)

    expected = integrate.quad(along_x, 0.4, 0.7, limit=500, epsabs=1e-12)[0]
    assert found.total == pytest.approx(expected, rel=1e-5)


def test_past_the_rim_of_the_objective_nothing_is_integrated() -> None:
    # light of y < 0.5 alone passes; all of it returns to the axis
    inside = np.array([[0.25 - 0.5, -0.5]])
    none = np.zeros((1, 1))
    found = integrals(cut_of(WHOLE, False, 4, 3, none, none, inside), 1e-9)
    half = math.asin(0.5)
    assert found.total == pytest.approx(0.5 * (half + math.sin(half) * math.cos(half)), rel=1e-8)


@pytest.mark.parametrize("v_max", [1.0, 0.36])
def test_a_line_crosses_a_disk_where_pythagoras_has_it(v_max: float) -> None:
    steep = np.array([[RADIUS / 0.7]])
    line = room(TILE_LINE)
    cut = cut_of(WHOLE._replace(v_max=v_max), True, 4, 3, steep, steep)
    for xi in (0.0, 0.3, 0.5, 0.6):
        # x² + y² = part², where x = ξ √(1 − y²)
        y = math.sqrt((0.49 - xi**2) / (1 - xi**2))
        assert cross(cut, xi, line) == 2
        assert line.cuts[:2] == pytest.approx([0.0, min(y, math.sqrt(v_max))], abs=1e-8)
    assert cross(cut, 0.75, line) == 0


@pytest.mark.parametrize(
    ("v_min", "v_max", "kind"),
    [(0.0, 1.0, (2, True, False)), (0.04, 0.25, (2, True, True)), (0.5, 0.9, (0, False, False))],
)
def test_a_line_is_known_by_how_often_it_crosses_a_patch_and_whether_at_its_ends(
    v_min: float, v_max: float, kind: tuple[int, bool, bool]
) -> None:
    steep = np.array([[RADIUS / 0.7]])
    cut = cut_of(Tile(0.0, 1.0, v_min, v_max), True, 4, 3, steep, steep)
    line = room(TILE_LINE)
    assert crossing_kind(cut, 0.3, line) == kind
    # whatever the line before it did
    assert crossing_kind(cut, 0.8, line) == (0, False, False)


def test_the_edge_of_a_patch_along_a_side_of_a_tile_is_where_its_disk_ends() -> None:
    steep = np.array([[RADIUS / 0.7]])
    line = room(TILE_LINE)
    for v in (0.0, 0.09, 0.25):
        assert cross_edge(cut_of(WHOLE, True, 4, 3, steep, steep), v, line) == 1
        assert line.roots[0] == pytest.approx((0.49 - v) / (1 - v), abs=1e-8)
