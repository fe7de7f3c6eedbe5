"""What polynomials leave out of tables of indices, beside scipy's through the same nodes."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.interpolate import BarycentricInterpolator

from octsim.optics.detector import Detector
from octsim.optics.materials import Constant, Material, Table
from octsim.optics.scene import Plane, Region, Scene
from octsim.schemes.tables_of_indices import phase_left_out

FIRST, LAST, FOCUS, HEIGHT = 7.0, 9.6, -0.7, 2.5
DETECTOR = Detector(400.0, 300.0, 1.0, 1.0, 300.0)
ROWS = (0.6, 0.65, 0.71, 0.74, 0.8, 0.85, 0.95)
N = (1.34, 1.35, 1.345, 1.36, 1.35, 1.34, 1.35)
KAPPA = (1e-5, 2e-5, 1e-5, 3e-5, 4e-5, 2e-5, 1e-5)


def left_out(objective: Material, other: Material, number: int) -> float:
    glass, water = Region("glass", objective), Region("water", other)
    scene = Scene(glass, (Plane("P", HEIGHT, glass, water),))
    return phase_left_out(scene, DETECTOR, FOCUS, FIRST, LAST, number)


def off(material: Material, number: int) -> tuple[float, float]:
    """Return how far n and kappa are from polynomials at most, looked at closely."""
    turn = (np.arange(number) + 0.5) / number * np.pi
    nodes = (FIRST + LAST) / 2 + (LAST - FIRST) / 2 * np.cos(turn)
    k = np.linspace(FIRST, LAST, 2000)

    def apart(part: Callable[[complex], float]) -> float:
        at_nodes, exact = (
            np.array([part(material.index(one)) for one in each.tolist()]) for each in (nodes, k)
        )
        return float(np.abs(BarycentricInterpolator(nodes, at_nodes)(k) - exact).max())

    return apart(lambda index: index.real), apart(lambda index: index.imag)


@pytest.mark.parametrize("number", [5, 9, 12])
def test_the_phase_is_that_of_the_longest_way_through_what_is_left_out(number: int) -> None:
    table, plain = Table(ROWS, N, KAPPA), Constant(1.33)
    of_n, of_kappa = off(table, number)
    there = 4 * (abs(FOCUS) + HEIGHT)
    from_objective = 2 * 500.0
    # some places between rows are looked at, which come near the largest
    for found, expected in (
        (left_out(plain, table, number), LAST * there * (of_n + of_kappa)),
        (left_out(table, plain, number), LAST * (there * of_n + from_objective * of_kappa)),
    ):
        assert 0.8 * expected <= found <= 1.001 * expected


def test_what_is_no_table_or_has_no_row_within_the_band_leaves_nothing_out() -> None:
    assert left_out(Constant(1.52), Constant(1.33), 5) == 0
    assert left_out(Constant(1.52), Table((0.6, 0.95), (1.34, 1.38)), 5) == 0
