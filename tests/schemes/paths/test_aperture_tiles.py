"""Tiles of the aperture beside the areas of a disk."""

import math

import numpy as np
import pytest
from scipy import integrate

from octsim.schemes.paths.aperture_tiles import Tile, area, between, fraction, halves

TILE = Tile(0.04, 0.25, 0.09, 0.36)


def exact(tile: Tile, symmetric: bool) -> float:
    """Return ∫∫ √(1 − y²) dξ dy over a tile."""
    xi = [math.sqrt(s) if symmetric else s for s in (tile.s_min, tile.s_max)]
    y = math.sqrt(tile.v_min), math.sqrt(tile.v_max)
    return float((xi[1] - xi[0]) * integrate.quad(lambda y: math.sqrt(1 - y * y), *y)[0])


@pytest.mark.parametrize("symmetric", [True, False])
def test_the_area_of_a_tile_is_nearly_that_of_the_disk_there(symmetric: bool) -> None:
    assert area(TILE, symmetric) == pytest.approx(exact(TILE, symmetric), rel=1e-4)
    # where the disk ends the rule is rougher
    top = Tile(0.0, 1.0, 0.5, 1.0)
    assert area(top, symmetric) == pytest.approx(exact(top, symmetric), rel=0.06)


def test_a_quarter_of_the_disk_and_its_mirror_images_are_all_of_it() -> None:
    assert fraction(Tile(0.0, 1.0, 0.0, 1.0), True) == pytest.approx(1, rel=0.06)
    assert fraction(Tile(-1.0, 1.0, 0.0, 1.0), False) == pytest.approx(1, rel=0.06)
    assert fraction(TILE, True) == pytest.approx(4 / math.pi * exact(TILE, True), rel=1e-4)


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("along_y", [True, False])
def test_halves_are_as_wide_as_each_other(symmetric: bool, along_y: bool) -> None:
    first, second = halves(TILE, symmetric, along_y)
    if along_y:
        assert first == pytest.approx(TILE._replace(v_max=0.45**2))
        assert second == TILE._replace(v_min=first.v_max)
    else:
        middle = 0.35**2 if symmetric else 0.145
        assert first == pytest.approx(TILE._replace(s_max=middle))
        assert second == TILE._replace(s_min=first.s_max)


def test_a_part_between_nodes_ends_at_them_and_the_outermost_stand_for_edges() -> None:
    along_s, along_v = np.array([0.01, 0.2, 0.6, 0.99]), np.array([0.02, 0.3, 0.98])
    assert between(TILE, 4, 3, along_s, along_v, 0, 3, 0, 2) == TILE
    inner = between(TILE, 4, 3, along_s, along_v, 1, 2, 1, 1)
    expected = (
        0.04 + 0.21 * 0.2,
        0.04 + 0.21 * 0.6,
        0.09 + 0.27 * 0.3,
        0.09 + 0.27 * 0.3,
    )
    assert inner == pytest.approx(expected, rel=1e-14)
