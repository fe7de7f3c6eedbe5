"""Nodes of a tile: where they are aimed, and what they weigh, beside areas of the aperture."""

import math

import numpy as np
import pytest
from scipy import integrate

from octsim.optics.detector import fibre_detector
from octsim.optics.turned_rays import STRAIGHT
from octsim.schemes.paths.aperture_tiles import Tile
from octsim.schemes.paths.chebyshev import FIT, LOOK
from octsim.schemes.paths.falloffs import Parabola
from octsim.schemes.paths.tile_nodes import (
    CRUDE,
    aim_at_tile,
    field_errors,
    map_errors,
    map_tile,
    rim_errors,
    sum_tile,
    weigh,
    weigh_crudely,
)
from octsim.schemes.paths.workspace import Point, Workspace, room_for_point, tables_of

DETECTOR = fibre_detector(0.5, 1.52, 300.0, 20.0, 4.4)
TILE, N, M = Tile(0.2, 0.25, 0.1, 0.12), 5, 4


def point_of(symmetric: bool) -> Point:
    tables = tables_of(symmetric)
    return Point(symmetric, DETECTOR, 0.5, 8.3, 9.7, Parabola(), STRAIGHT, tables)


def returning(x: float, y: float, amplitude: float = 0.1, length: float = 1.0) -> Workspace:
    """Return a workspace whose N x M rays all return at a place (µm), straight down."""
    space = room_for_point()
    space.bundle.followed[:], space.bundle.cos[:], space.bundle.inside[:] = (True, 1.0, 0.5)
    space.bundle.x[:], space.bundle.y[:] = x, y
    space.bundle.amplitude[:], space.bundle.optical_path_length[:] = amplitude, length
    space.checks.weight[:] = -1.0
    return space


def share(tile: Tile, symmetric: bool) -> float:
    """Return the exact part of the aperture that a tile and its mirror images are."""
    low, high = (math.sqrt(s) if symmetric else s for s in (tile.s_min, tile.s_max))
    y = math.sqrt(tile.v_min), math.sqrt(tile.v_max)
    up = float(integrate.quad(lambda y: math.sqrt(1 - y * y), *y)[0])
    return (4 if symmetric else 2) / math.pi * (high - low) * up


@pytest.mark.parametrize("symmetric", [True, False])
def test_nodes_are_aimed_from_their_places_on_the_aperture(symmetric: bool) -> None:
    space = room_for_point()
    aim_at_tile(point_of(symmetric), TILE, N, M, LOOK, space.beam)
    vx, vy, vz = (np.array(one[: N * M]) for one in (space.beam.vx, space.beam.vy, space.beam.vz))
    y = vy / vz * DETECTOR.focus_distance / DETECTOR.objective_radius
    x = vx / vz * DETECTOR.focus_distance / DETECTOR.objective_radius
    v, xi = y * y, x / np.sqrt(1 - y * y)
    s = xi * xi if symmetric else xi
    # towards the focus, from where they are
    for found, low, high in ((s.reshape(N, M), 0.2, 0.25), (v.reshape(N, M), 0.1, 0.12)):
        assert np.abs(found).min() == pytest.approx(low, rel=1e-6)
        assert np.abs(found).max() == pytest.approx(high, rel=1e-6)
    assert (np.ptp(s.reshape(N, M), axis=1) < 1e-12).all()
    assert (np.ptp(v.reshape(N, M), axis=0) < 1e-12).all()


@pytest.mark.parametrize("symmetric", [True, False])
def test_trapezoids_weigh_a_tile_s_nodes_by_the_aperture_about_them(symmetric: bool) -> None:
    place = 0.6 * DETECTOR.radius
    space = returning(place, 0.0)
    size, error = weigh_crudely(point_of(symmetric), TILE, N, M, LOOK, space)
    expected = 0.1 * (1 - 0.36) * share(TILE, symmetric)
    assert size == pytest.approx(expected, rel=1e-4)
    assert error == CRUDE * size
    weights = np.array(space.weight[:N, :M])
    assert (1 - 0.36) * share(TILE, symmetric) == pytest.approx(weights.sum(), rel=1e-4)
    assert np.array(space.rough_weight[:N, :M]) == pytest.approx((1 - CRUDE) * weights)


def test_nodes_that_return_beside_the_detector_or_take_no_path_weigh_nothing() -> None:
    space = returning(0.0, 0.0)
    space.bundle.followed[1], space.bundle.inside[2] = False, -0.1
    space.bundle.x[4] = 1.01 * DETECTOR.radius
    weigh_crudely(point_of(True), TILE, N, M, LOOK, space)
    assert np.flatnonzero(np.array(space.weight[:N, :M]).ravel() == 0).tolist() == [1, 2, 4]
    assert space.bundle.amplitude[1] == space.bundle.amplitude[2] == 0


@pytest.mark.parametrize("symmetric", [True, False])
def test_a_fitted_tile_weighs_its_nodes_by_the_falloff_of_all_of_it(symmetric: bool) -> None:
    point, along = point_of(symmetric), 0.5 * DETECTOR.radius
    space = returning(0.0, along)
    tables = point.tables
    # Y = y R / 2 / √v_max
    v = 0.1 + 0.02 * np.array(tables.nodes_v[FIT, M, :M])
    space.bundle.y[: N * M] = np.tile(along * np.sqrt(v / 0.12), N)
    map_tile(point, TILE, N, M, M, FIT, space)
    total, off = weigh(point, TILE, N, M, 1e-9, space)
    low, high = math.sqrt(0.1), math.sqrt(0.12)
    up = integrate.quad(lambda y: (1 - 0.25 * y * y / 0.12) * math.sqrt(1 - y * y), low, high)[0]
    across = math.sqrt(0.25) - math.sqrt(0.2) if symmetric else 0.05
    assert total == pytest.approx(across * up, rel=1e-9)
    weights = np.array(space.weight[:N, :M])
    assert weights.sum() == pytest.approx((4 if symmetric else 2) / math.pi * total, rel=1e-9)
    assert off == 0
    assert max(map_errors(point, TILE, N, M, space)) < 1e-9
    assert rim_errors(N, M, space) == (0.0, 0.0)


def test_the_sum_of_nodes_is_that_of_their_waves_where_it_is_largest() -> None:
    point = point_of(True)
    space = returning(0.0, 0.0)
    lengths = np.linspace(0.0, 0.7, N * M)
    amplitude = np.linspace(0.1, 0.3, N * M)
    space.bundle.optical_path_length[: N * M] = lengths
    space.bundle.amplitude[: N * M] = amplitude
    weights = np.linspace(1.0, 2.0, N * M)
    space.weight[:N, :M] = weights.reshape(N, M)
    space.rough_weight[:N, :M] = 0.9 * weights.reshape(N, M)
    sizes = [abs((weights * amplitude * np.exp(1j * k * lengths)).sum()) for k in (8.3, 9.7)]
    size, error = sum_tile(point, N, M, space)
    assert size == pytest.approx(max(sizes), rel=1e-12)
    assert error == pytest.approx(0.1 * max(sizes), rel=1e-12)


def test_of_even_light_polynomials_put_no_field_off() -> None:
    assert max(field_errors(point_of(True), N, M, returning(0.0, 0.0))) < 1e-15
