"""Check rays: where they lie, what they weigh, and what they hold polynomials to."""

import numpy as np
import pytest

from octsim.base.records import room
from octsim.schemes.paths.aperture_tiles import Tile, fraction
from octsim.schemes.paths.check_rays import (
    CHECK_RAYS,
    CHECKS,
    CheckRays,
    field_seen,
    place_of,
    sees_beside,
    weight_error,
    weight_of,
)
from octsim.schemes.paths.falloffs import Parabola, Series
from octsim.schemes.paths.line_crossings import MAP, TILE_LINE, Cut
from octsim.schemes.paths.workspace import tables_of

RADIUS = 2.0
TILE = Tile(0.04, 0.36, 0.09, 0.49)
LESS = Series(np.array([0.75, -0.25]), 0.5)  # 1 − squared / 2, which ends at a half


def checks_of(*seen: tuple[float, float, float, float]) -> CheckRays:
    """Return check rays of which these are detected: s, v, weight and amplitude of each."""
    checks: CheckRays = room(CHECK_RAYS)
    checks.s[:], checks.v[:], checks.weight[:], checks.amplitude[:] = -9.0, -9.0, 0.0, 0.0
    for i, one in enumerate(seen):
        checks.s[i], checks.v[i], checks.weight[i], checks.amplitude[i] = one
    checks.detected[0] = len(seen)
    return checks


@pytest.mark.parametrize("symmetric", [True, False])
def test_they_are_evenly_spaced_along_the_edges_at_both_axes(symmetric: bool) -> None:
    tile = TILE if symmetric else TILE._replace(s_min=-0.5)
    places = np.array([place_of(tile, symmetric, i) for i in range(CHECKS)])
    along_x = 24 if symmetric else CHECKS
    across = np.sqrt(places[:along_x, 0]) if symmetric else places[:, 0]
    low, high = (0.2, 0.6) if symmetric else (-0.5, 0.36)
    step = (high - low) / along_x
    assert across == pytest.approx(low + step * (np.arange(along_x) + 0.5), rel=1e-12)
    assert places[:along_x, 1] == pytest.approx(0.09, abs=1e-8)
    up = np.sqrt(places[along_x:, 1])
    assert up == pytest.approx(0.3 + 0.4 / 16 * (np.arange(len(up)) + 0.5), rel=1e-12)
    assert places[along_x:, 0] == pytest.approx(0.04, abs=1e-8)


def test_a_ray_weighs_what_it_is_detected_with() -> None:
    cos = 0.8
    for place, expected in ((0.0, 1.0), (0.6, 0.64), (0.99, 1 - 0.99**2), (1.01, 0.0), (3.9, 0.0)):
        x, y = (part * place * RADIUS * cos for part in (0.6, -0.8))
        assert weight_of(x, y, cos, 0.1, RADIUS, Parabola()) == pytest.approx(expected, abs=1e-12)
        # past the objective's rim nothing is detected
        assert weight_of(x, y, cos, -0.1, RADIUS, Parabola()) == 0
    # far beside it says nothing of what polynomials should
    assert weight_of(4.1 * RADIUS * cos, 0.0, cos, 0.1, RADIUS, Parabola()) == -1
    assert weight_of(0.6 * RADIUS, 0.0, 1.0, 0.1, RADIUS, LESS) == pytest.approx(1 - 0.18)


def test_the_field_that_is_seen_is_that_of_the_strongest_in_the_tile() -> None:
    inside, weak, outside = (0.1, 0.2, 0.5, -0.3), (0.3, 0.4, 0.9, 0.1), (0.5, 0.2, 0.5, 7.0)
    checks = checks_of(inside, weak, outside)
    assert field_seen(checks, TILE, True) == pytest.approx(0.3 * fraction(TILE, True), rel=1e-14)
    assert field_seen(checks_of(outside), TILE, True) == 0
    assert field_seen(checks_of(), TILE, True) == 0


def test_what_is_seen_in_a_tile_beside_a_part_of_it_is_noticed() -> None:
    checks, part = checks_of((0.1, 0.2, 0.5, 0.3)), TILE._replace(s_min=0.2)
    assert sees_beside(checks, TILE, part)
    assert not sees_beside(checks, TILE, TILE._replace(s_max=0.2))
    assert not sees_beside(checks, part, part)


@pytest.mark.parametrize("falloff", [Parabola(), LESS])
@pytest.mark.parametrize("off", [0.0, 0.05])
def test_polynomials_are_off_by_a_tenth_of_what_they_put_a_falloff_wrong(
    falloff: Parabola | Series, off: float
) -> None:
    share = 0.5 if falloff is LESS else 1.0
    # X = 3 x + off and Y = 2 y, inside the rim where y² < 0.4
    returns = room(MAP)
    for name in ("x", "y", "cos", "inside"):
        getattr(returns, name)[:] = 0.0
    returns.x[0, 0], returns.x[1, 0] = 3 * 0.2 + off, 3 * 0.16
    returns.y[0, 0], returns.cos[0, 0] = 2.0, 1.0
    returns.inside[0, 0], returns.inside[0, 1] = 0.4 - 0.29, -0.2
    cut = Cut(returns, 3, 3, TILE, False, RADIUS, falloff, tables_of(False).bernstein)

    def exact(x: float, y: float) -> float:
        squared = ((3 * x) ** 2 + (2 * y) ** 2) / RADIUS**2
        passes = y * y < 0.4 and squared < 1
        return 1 - share * squared if passes else 0.0

    # two within the rim, one past it, and one out of the tile
    places = (0.3, 0.5), (0.35, 0.6), (0.3, 0.66), (0.9, 0.5)
    rays = [(x, y * y, exact(x, y), 1.0) for x, y in places]
    found = weight_error(checks_of(*rays), cut, room(TILE_LINE))
    expected = share * ((1.05 + off) ** 2 - 1.05**2) / RADIUS**2
    assert found == pytest.approx(0.1 * expected, abs=1e-12)


@pytest.mark.parametrize(
    ("steep", "there"), [(5.8, False), (5.45, False), (6.5, True), (4.0, True)]
)
def test_near_the_edge_of_a_falloff_that_jumps_there_polynomials_are_held_to_nothing(
    steep: float, there: bool
) -> None:
    # X = steep x and Y = 2 y: within a tenth of R_det² of the edge, or farther from it
    returns = room(MAP)
    for name in ("x", "y", "cos", "inside"):
        getattr(returns, name)[:] = 0.0
    returns.x[0, 0], returns.x[1, 0] = steep * 0.2, steep * 0.16
    returns.y[0, 0], returns.cos[0, 0], returns.inside[0, 0] = 2.0, 1.0, 0.5
    squared = ((steep * 0.3) ** 2 + 1) / RADIUS**2
    assert there == (abs(squared - 1) > 0.1)
    checks = checks_of((0.3, 0.25, 0.9, 1.0))
    for falloff, held, share in ((Parabola(), True, 1.0), (LESS, there, 0.5)):
        cut = Cut(returns, 3, 3, TILE, False, RADIUS, falloff, tables_of(False).bernstein)
        off = abs(0.9 - (1 - share * squared if squared < 1 else 0.0))
        found = weight_error(checks, cut, room(TILE_LINE))
        assert found == pytest.approx(0.1 * off if held else 0.0, abs=1e-12)
