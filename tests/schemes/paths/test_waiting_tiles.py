"""Tiles that wait: the strongest comes first, and none is changed by waiting."""

import math

import pytest

from octsim.schemes.paths.aperture_tiles import Tile, area
from octsim.schemes.paths.chebyshev import FIT, LOOK
from octsim.schemes.paths.waiting_tiles import (
    OpenTile,
    pop_strongest,
    push,
    push_halves,
    room_for_waiting,
)

WIDE = OpenTile(Tile(0.0, 1.0, 0.0, 0.25), 5, 4, FIT, 0.7, 0.2, 1e-5)
FAINT = OpenTile(Tile(0.1, 0.2, 0.3, 0.4), 7, 3, LOOK, 0.343, 0.1, math.inf)
STRONG = OpenTile(Tile(0.5, 0.6, 0.7, 0.8), 9, 8, FIT, 0.49, 0.3, 1e-3)


def test_the_tile_of_the_largest_field_is_taken_first() -> None:
    waiting = room_for_waiting()
    for tile in (WIDE, STRONG, FAINT):
        push(waiting, tile)
    assert [pop_strongest(waiting) for _ in range(3)] == [STRONG, WIDE, FAINT]
    assert waiting.num[0] == 0


def test_of_equal_fields_the_tile_that_came_last_is_taken_first() -> None:
    waiting = room_for_waiting()
    equal = [one._replace(bound=0.2) for one in (STRONG, WIDE, FAINT)]
    for tile in equal:
        push(waiting, tile)
    assert pop_strongest(waiting) == equal[-1]


@pytest.mark.parametrize("symmetric", [True, False])
def test_halves_are_cut_across_the_longer_side_and_make_up_the_tile(symmetric: bool) -> None:
    waiting = room_for_waiting()
    push_halves(waiting, WIDE, symmetric)
    parts = [pop_strongest(waiting) for _ in range(2)]
    assert {(part.tile.v_min, part.tile.v_max) for part in parts} == {(0.0, 0.25)}
    whole = sum(area(part.tile, symmetric) for part in parts)
    assert whole == pytest.approx(area(WIDE.tile, symmetric), rel=1e-12)
    assert [(part.n, part.bound, part.coarser_error) for part in parts] == 2 * [(5, 0.1, math.inf)]
