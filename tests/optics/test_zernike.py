"""Zernike polynomials beside Noll's table, and what they keep."""

from collections.abc import Callable
from math import sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial.polynomial import polyval2d
from numpy.typing import NDArray

from octsim.optics.zernike import MOST, NAMES, Aberration, cartesian, noll

Array = NDArray[np.float64]

# Noll, J. Opt. Soc. Am. 66, 207 (1976), Table I, and on to 22: n, m (of sines negative), polynomial
TABLE: list[tuple[int, int, Callable[[Array, Array], Array]]] = [
    (0, 0, lambda r, t: 0 * t + 1 + 0 * r),
    (1, 1, lambda r, t: 2 * r * np.cos(t)),
    (1, -1, lambda r, t: 2 * r * np.sin(t)),
    (2, 0, lambda r, t: sqrt(3) * (2 * r**2 - 1) + 0 * t),
    (2, -2, lambda r, t: sqrt(6) * r**2 * np.sin(2 * t)),
    (2, 2, lambda r, t: sqrt(6) * r**2 * np.cos(2 * t)),
    (3, -1, lambda r, t: sqrt(8) * (3 * r**3 - 2 * r) * np.sin(t)),
    (3, 1, lambda r, t: sqrt(8) * (3 * r**3 - 2 * r) * np.cos(t)),
    (3, -3, lambda r, t: sqrt(8) * r**3 * np.sin(3 * t)),
    (3, 3, lambda r, t: sqrt(8) * r**3 * np.cos(3 * t)),
    (4, 0, lambda r, t: sqrt(5) * (6 * r**4 - 6 * r**2 + 1) + 0 * t),
    (4, 2, lambda r, t: sqrt(10) * (4 * r**4 - 3 * r**2) * np.cos(2 * t)),
    (4, -2, lambda r, t: sqrt(10) * (4 * r**4 - 3 * r**2) * np.sin(2 * t)),
    (4, 4, lambda r, t: sqrt(10) * r**4 * np.cos(4 * t)),
    (4, -4, lambda r, t: sqrt(10) * r**4 * np.sin(4 * t)),
    (5, 1, lambda r, t: sqrt(12) * (10 * r**5 - 12 * r**3 + 3 * r) * np.cos(t)),
    (5, -1, lambda r, t: sqrt(12) * (10 * r**5 - 12 * r**3 + 3 * r) * np.sin(t)),
    (5, 3, lambda r, t: sqrt(12) * (5 * r**5 - 4 * r**3) * np.cos(3 * t)),
    (5, -3, lambda r, t: sqrt(12) * (5 * r**5 - 4 * r**3) * np.sin(3 * t)),
    (5, 5, lambda r, t: sqrt(12) * r**5 * np.cos(5 * t)),
    (5, -5, lambda r, t: sqrt(12) * r**5 * np.sin(5 * t)),
    (6, 0, lambda r, t: sqrt(7) * (20 * r**6 - 30 * r**4 + 12 * r**2 - 1) + 0 * t),
]


def disk() -> tuple[Array, Array, Array]:
    """Return points (r, θ) and weights that integrate degree 20 over the unit disk, as a mean."""
    node, weight = np.polynomial.legendre.leggauss(12)
    square = (node + 1) / 2  # r dr is d(r²) / 2
    turns = np.arange(24) / 24
    r, t = np.meshgrid(np.sqrt(square), 2 * np.pi * turns, indexing="ij")
    return r, t, np.broadcast_to(weight[:, np.newaxis] / (2 * turns.size), r.shape)


R, T, WEIGHT = disk()
X, Y = R * np.cos(T), R * np.sin(T)
COEFFICIENTS = st.lists(
    st.tuples(st.integers(1, MOST), st.floats(-1, 1)), min_size=1, max_size=6
).map(tuple)
POINT = st.tuples(st.floats(-1, 1), st.floats(-1, 1))


@pytest.mark.parametrize("j", range(1, 23))
def test_the_first_ones_are_those_of_nolls_table(j: int) -> None:
    n, m, polynomial = TABLE[j - 1]
    assert noll(j) == (n, m)
    assert np.allclose(
        Aberration(((j, 1.0),)).wavefront(X, Y), polynomial(R, T), rtol=0, atol=2e-14
    )


def test_they_are_orthonormal_over_the_disk() -> None:
    values = np.array([Aberration(((j, 1.0),)).wavefront(X, Y) for j in range(1, MOST + 1)])
    product = np.einsum("irt,jrt,rt->ij", values, values, WEIGHT)
    assert np.allclose(product, np.eye(MOST), rtol=0, atol=1e-12)


def test_numbers_go_through_all_polynomials_of_each_degree() -> None:
    found = [noll(j) for j in range(1, MOST + 1)]
    assert [n for n, _ in found] == sorted(n for n, _ in found)
    assert set(found) == {(n, m) for n in range(11) for m in range(-n, n + 1, 2)}
    assert all(m == 0 or (m > 0) == (j % 2 == 0) for j, (_, m) in enumerate(found, 1))


@pytest.mark.parametrize(
    ("j", "osa"), [(1, 0), (2, 2), (3, 1), (4, 4), (5, 3), (6, 5), (9, 6), (7, 7), (8, 8), (10, 9)]
)
def test_osa_numbers_follow_from_degree_and_order(j: int, osa: int) -> None:
    n, m = noll(j)
    assert (n * (n + 2) + m) // 2 == osa  # ANSI Z80.28


@pytest.mark.parametrize("j", [0, -1, MOST + 1])
def test_a_number_outside_is_refused(j: int) -> None:
    with pytest.raises(ValueError, match="Noll's number"):
        noll(j)


def test_names_cover_the_first_ones_and_tell_x_from_y() -> None:
    assert set(NAMES.values()) == set(range(1, 23))
    for name, j in NAMES.items():
        m = noll(j)[1]
        assert name == name.lower()
        if name.endswith(" x"):
            assert m > 0
        if name.endswith(" y"):
            assert m < 0
        if "spherical" in name or name in ("piston", "defocus"):
            assert m == 0
        if "astigmatism" in name or ("foil" in name and "tre" not in name):
            assert (m < 0) == ("oblique" in name or name.endswith(" y"))


def test_powers_are_exact_but_for_the_norm() -> None:
    assert np.array_equal(
        cartesian({11: 1.0}) / sqrt(5),
        [[1, 0, -6, 0, 6], [0] * 5, [-6, 0, 12, 0, 0], [0] * 5, [6, 0, 0, 0, 0]],
    )
    assert np.array_equal(cartesian({}), [[0]])
    assert np.array_equal(cartesian(((4, 0.25), (4, 0.5))), cartesian({4: 0.75}))


@given(COEFFICIENTS, POINT)
def test_slopes_are_those_of_a_complex_step(
    coefficients: tuple[tuple[int, float], ...], point: tuple[float, float]
) -> None:
    px, py = np.array(point[0]), np.array(point[1])
    slopes = Aberration(coefficients).slopes(px, py)
    powers, step = cartesian(coefficients), 1e-30
    by_x = polyval2d(px + 1j * step, py + 0j, powers).imag / step
    by_y = polyval2d(px + 0j, py + 1j * step, powers).imag / step
    # the powers' factors reach 1e4 and cancel, near a corner of the square 10 times so
    assert np.allclose(slopes, (by_x, by_y), rtol=1e-12, atol=1e-9)


@given(COEFFICIENTS)
def test_symmetry_is_kept_where_it_is_said_to_be(
    coefficients: tuple[tuple[int, float], ...],
) -> None:
    aberration = Aberration(coefficients)
    here = aberration.wavefront(X, Y)
    for even, mirrored in zip(
        aberration.even, (aberration.wavefront(-X, Y), aberration.wavefront(X, -Y)), strict=True
    ):
        if even:
            assert np.array_equal(here, mirrored)


@pytest.mark.parametrize(
    ("names", "even"),
    [
        (("spherical", "astigmatism", "quadrafoil"), (True, True)),
        (("coma x", "trefoil x"), (False, True)),
        (("coma y", "trefoil y"), (True, False)),
        (("oblique astigmatism",), (False, False)),
    ],
)
def test_symmetry_is_found(names: tuple[str, ...], even: tuple[bool, bool]) -> None:
    assert Aberration(tuple((NAMES[name], 0.01) for name in names)).even == even


def test_shapes_are_kept() -> None:
    aberration = Aberration(((8, 0.1), (4, 0.2)))
    assert aberration.wavefront(X, Y).shape == X.shape
    assert [slope.shape for slope in aberration.slopes(X, Y)] == [X.shape] * 2
    assert hash(aberration) == hash(Aberration(((8, 0.1), (4, 0.2))))
