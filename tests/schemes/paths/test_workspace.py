"""The tables that integrals read, beside numpy's polynomials."""

import numpy as np
import pytest
from numpy.polynomial import chebyshev

from octsim.schemes.paths.chebyshev import FIT, HIGHEST, LOOK
from octsim.schemes.paths.workspace import tables_of


@pytest.mark.parametrize("symmetric", [True, False])
def test_nodes_to_look_with_are_evenly_spaced_in_the_coordinate_that_is_squared(
    symmetric: bool,
) -> None:
    tables, n = tables_of(symmetric), 7
    even = np.arange(n) / (n - 1)
    along_x = np.sqrt(tables.nodes_s[LOOK, n, :n]) if symmetric else tables.nodes_s[LOOK, n, :n]
    assert along_x == pytest.approx(even, abs=2e-4)
    # v = y² in any scene
    assert np.sqrt(tables.nodes_v[LOOK, n, :n]) == pytest.approx(even, abs=2e-4)


@pytest.mark.parametrize("n", [2, 5, HIGHEST])
def test_transforms_turn_values_at_the_nodes_into_chebyshev_s_coefficients(n: int) -> None:
    tables = tables_of(True)
    coefficients = 0.5 ** np.arange(n)
    for nodes, transforms in (
        (tables.nodes_s, tables.transforms_s), (tables.nodes_v, tables.transforms_v)
    ):  # fmt: skip
        values = chebyshev.chebval(2 * nodes[FIT, n, :n] - 1, coefficients)
        assert transforms[FIT, n, :n, :n] @ values == pytest.approx(coefficients, abs=1e-12)
