"""The part of a tile that a patch can be in, as polynomials tell, beside cells counted by hand."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from octsim.base.records import room
from octsim.schemes.paths.aperture_tiles import Tile
from octsim.schemes.paths.line_crossings import MAP
from octsim.schemes.paths.patch_by_fit import SEARCH, holding

RADIUS = 2.0
N, M, CELLS = 3, 3, 16


def held(
    tile: Tile, symmetric: bool, x: list[float], y: list[float], inside: float = 1.0,
    highest: float = 0.0,
) -> tuple[float, Tile]:  # fmt: skip
    """Return what `holding` says of light that returns at polynomials in s, and in v.

    `x` and `y` are Chebyshev coefficients of them, in R_det; `highest` is that of x of the highest
    order along v.
    """
    returns = room(MAP)
    for name in ("x", "y", "cos", "inside"):
        getattr(returns, name)[:] = 0.0
    returns.x[: len(x), 0] = RADIUS * np.array(x)
    returns.x[0, M - 1] += RADIUS * highest
    returns.y[0, : len(y)] = RADIUS * np.array(y)
    returns.inside[0, 0] = inside
    return holding(returns, N, M, tile, symmetric, RADIUS, room(SEARCH))


def corners(low: float, high: float) -> NDArray[np.float64]:
    return np.linspace(low, high, CELLS + 1)


def test_a_patch_is_in_the_cells_that_reach_the_detector() -> None:
    # X = 3 R ξ and Y = 4 R y
    found, part = held(Tile(-1.0, 1.0, 0.0, 1.0), False, [0.0, 3.0], [4.0])
    low, high = 3 * corners(-1, 1)[:-1], 3 * corners(-1, 1)[1:]
    more = 0.25 * (high - low)
    across = np.flatnonzero((low - more < 1) & (high + more > -1))
    up = np.flatnonzero(4 * corners(0, 1)[:-1] - 0.25 * 4 / CELLS < 1)
    assert found == across.size * up.size / CELLS**2
    assert part.s_min == pytest.approx(corners(-1, 1)[across[0]], abs=1e-14)
    assert part.s_max == pytest.approx(corners(-1, 1)[across[-1] + 1], abs=1e-14)
    assert (part.v_min, math.sqrt(part.v_max)) == (0.0, corners(0, 1)[up[-1] + 1])


def test_about_an_axis_of_symmetry_places_are_times_their_coordinate() -> None:
    # X = 4 R x, where x = ξ √(1 − y²), and Y = 0
    tile = Tile(0.0, 0.81, 0.25, 0.36)
    found, part = held(tile, True, [4.0], [0.0])
    xi, half = corners(0, 0.9), np.sqrt(1 - corners(0.5, 0.6) ** 2)
    places = 4 * xi[:, None] * half
    low, high = places[:-1, 1:], places[1:, :-1]
    there = low - 0.25 * (high - low) < 1
    assert found == np.count_nonzero(there) / CELLS**2
    assert part.s_min == 0.0
    assert math.sqrt(part.s_max) == pytest.approx(xi[np.flatnonzero(there.any(axis=1))[-1] + 1])


@pytest.mark.parametrize(("beside", "there"), [(1.37, True), (1.43, False)])
def test_the_highest_order_is_taken_for_the_error_of_a_place(beside: float, there: bool) -> None:
    # at ξ = 0.5 X is R beside, less 0.2 R by an order that may be 0.2 R off
    tile = Tile(0.25, 0.25 + 1e-9, 0.0, 1e-12)
    found, _ = held(tile, True, [2 * beside], [0.0], highest=0.4)
    assert (found > 0) == there


def test_where_nothing_passes_the_rim_there_is_no_patch() -> None:
    tile = Tile(0.0, 1.0, 0.0, 1.0)
    assert held(tile, True, [0.0], [0.0], inside=-0.1) == (0.0, tile)
