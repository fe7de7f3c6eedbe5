"""Integrals over the part of a tile of the aperture whose light is detected."""

import math

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.records import layout
from octsim.schemes.paths.aperture_tiles import across
from octsim.schemes.paths.chebyshev import HIGHEST
from octsim.schemes.paths.line_crossings import (
    MOST_CROSSINGS,
    Cut,
    TileLine,
    cross,
    cross_edge,
    crossing_kind,
    falloffs,
)
from octsim.schemes.paths.polynomial_roots import sort

_BETWEEN = 4  # parts between places where that is known to change
_PIECES = 64  # of a tile, at most


class Rules:
    """Quadrature rules: nodes and weights on 0 … 1."""

    gauss: NDArray[np.float64]
    """Of Gauss and Legendre, one number of nodes a row, (Q, Q)."""
    gauss_weight: NDArray[np.float64]
    kronrod: NDArray[np.float64]
    """Kronrod's 15 nodes, which hold 7 of Gauss, (15,)."""
    kronrod_weight: NDArray[np.float64]
    embedded_weight: NDArray[np.float64]
    """Gauss's weights of those, 0 for the other nodes, (15,)."""


_MOST = HIGHEST + 6  # nodes of a rule, and one more
RULES = layout(
    Rules, gauss=(_MOST, _MOST), gauss_weight=(_MOST, _MOST), kronrod=(15,), kronrod_weight=(15,),
    embedded_weight=(15,),
)  # fmt: skip


def fill_rules(rules: Rules) -> None:
    """Fill in the quadrature rules."""
    rules.gauss[:], rules.gauss_weight[:], rules.embedded_weight[:] = 0.0, 0.0, 0.0
    for q in range(1, _MOST):
        x, w = np.polynomial.legendre.leggauss(q)
        rules.gauss[q, :q], rules.gauss_weight[q, :q] = (x + 1) / 2, w / 2
    seven, seven_weight = np.polynomial.legendre.leggauss(7)
    fifteen, fifteen_weight = _kronrod(seven)
    rules.kronrod[:], rules.kronrod_weight[:] = (fifteen + 1) / 2, fifteen_weight / 2
    rules.embedded_weight[1::2] = seven_weight / 2


def _kronrod(gauss: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Extend Gauss's nodes on −1 … 1 to Kronrod's, with their weights.

    The new ones are the zeros of Stieltjes' polynomial, which is orthogonal to all of lower degree
    with Legendre's as its weight (Kronrod 1965).
    """
    legendre = np.polynomial.legendre
    n = gauss.size
    x, w = legendre.leggauss(2 * n + 2)
    values = legendre.legvander(x, n + 1)
    products = values[:, : n + 1].T @ (values * (w * values[:, n])[:, None])
    coefficients = np.append(np.linalg.lstsq(products[:, :-1], -products[:, -1], rcond=None)[0], 1)
    nodes: NDArray[np.float64] = np.sort(
        np.concatenate((gauss, legendre.legroots(coefficients).real.astype(float)))
    )
    exact = np.zeros(nodes.size)
    exact[0] = 2.0
    weights: NDArray[np.float64] = np.linalg.solve(
        legendre.legvander(nodes, nodes.size - 1).T, exact
    ).astype(float)
    return nodes, weights


@register_jitable
def _breaks(cut: Cut, line: TileLine, breaks: NDArray[np.float64]) -> int:
    """List the ξ at which the way that lines cross the patch changes, both ends included."""
    tile, num = cut.tile, 2
    breaks[0], breaks[1] = across(tile.s_min, cut.symmetric), across(tile.s_max, cut.symmetric)
    for v in (tile.v_min, tile.v_max):
        for root in line.roots[: cross_edge(cut, v, line)]:
            breaks[num] = across(tile.s_min + (tile.s_max - tile.s_min) * root, cut.symmetric)
            num += 1
    sort(breaks, num)
    # between those, a line may still begin or cease to cross the patch within the tile
    known = num
    for i in range(1, known):
        width = (breaks[i] - breaks[i - 1]) / _BETWEEN
        low = breaks[i - 1] + 1e-9 * width
        before = crossing_kind(cut, low, line)
        for part in range(1, _BETWEEN + 1):
            high = breaks[i - 1] + width * (part - 1e-9)
            after = crossing_kind(cut, high, line)
            if after != before and num < breaks.size:
                inner, outer = low, high
                for _ in range(28):
                    half = 0.5 * (inner + outer)
                    if crossing_kind(cut, half, line) == before:
                        inner = half
                    else:
                        outer = half
                breaks[num] = 0.5 * (inner + outer)
                num += 1
            low, before = high, after
    sort(breaks, num)
    return num


@register_jitable(forceinline=True)
def _along(cut: Cut, xi: float, rules: Rules, line: TileLine) -> None:
    """Integrate the falloff times each polynomial in v along a line."""
    m = cut.m
    q = m + 3
    for b in range(m):
        line.exact[b], line.rough[b] = 0.0, 0.0
    cuts = cross(cut, xi, line)
    for c in range(0, cuts - 1, 2):
        # y = sin θ takes the root out of √(1 − y²), where the aperture ends
        low, width = math.asin(line.cuts[c]), math.asin(line.cuts[c + 1]) - math.asin(line.cuts[c])
        for p in range(q):
            angle = low + width * rules.gauss[q, p]
            y, cos = math.sin(angle), math.cos(angle)
            weight = rules.gauss_weight[q, p] * width * cos * cos
            falloff, less = falloffs(cut, xi, line, y)
            for b in range(m):
                line.exact[b] += weight * falloff * line.u[b]
                line.rough[b] += weight * less * line.u[b]


@register_jitable
def moments(
    cut: Cut,
    tolerance: float,
    rules: Rules,
    line: TileLine,
    exact: NDArray[np.float64],
    rough: NDArray[np.float64],
) -> float:
    r"""Integrate the falloff times each Chebyshev polynomial over the patch in a tile.

    .. math:: W_{ab} = \iint_{\mathrm{patch}} \left(1 - \frac{\rho^2}{R_{det}^2}\right)
              T_a(s)\, T_b(v)\, dx\, dy

    by Gauss–Legendre rules between the edges of the patch along lines of constant ξ, and over ξ by
    Gauss's and Kronrod's, in halves until they agree; between where the way that lines cross the
    patch changes, and as ξ = ξ_0 + h sin φ, which takes the root out of a rounded end.

    Parameters
    ----------
    cut : Cut
        What is integrated over.
    tolerance : float
        Error allowed of the falloff's integral.
    rules : Rules
        Quadrature rules.
    line : Line
        Room to work in.
    exact, rough : ndarray, shape (n, m)
        The integrals, and those with the falloff of a rougher map: filled in.

    Returns
    -------
    float
        Integral of the falloff.
    """
    n, m = cut.n, cut.m
    for a in range(n):
        for b in range(m):
            exact[a, b], rough[a, b] = 0.0, 0.0
    breaks = np.empty(2 + 8 * MOST_CROSSINGS)
    num = _breaks(cut, line, breaks)
    below, above = np.empty(_PIECES), np.empty(_PIECES)
    here, here_rough = np.empty((n, m)), np.empty((n, m))
    total = 0.0
    for i in range(num - 1):
        low, high = breaks[i], breaks[i + 1]
        if high - low <= 1e-12 or crossing_kind(cut, 0.5 * (low + high), line) == (0, False, False):
            continue
        # from the axis of symmetry on, half of the arc will do
        folded = low == 0 and cut.symmetric
        centre, reach = (0.0, high) if folded else (0.5 * (low + high), 0.5 * (high - low))
        below[0], above[0], top = 0.0 if folded else -0.5 * math.pi, 0.5 * math.pi, 0
        while top >= 0:
            begin, width = below[top], above[top] - below[top]
            top -= 1
            for a in range(n):
                for b in range(m):
                    here[a, b], here_rough[a, b] = 0.0, 0.0
            value, embedded = 0.0, 0.0
            for j in range(15):
                angle = begin + width * rules.kronrod[j]
                scale = width * reach * math.cos(angle)
                _along(cut, centre + reach * math.sin(angle), rules, line)
                weight = scale * rules.kronrod_weight[j]
                value += weight * line.exact[0]
                embedded += scale * rules.embedded_weight[j] * line.exact[0]
                for a in range(n):
                    for b in range(m):
                        here[a, b] += weight * line.t[a] * line.exact[b]
                        here_rough[a, b] += weight * line.t[a] * line.rough[b]
            if abs(value - embedded) > tolerance and top + 2 < _PIECES and width > 1e-3:
                below[top + 1], above[top + 1] = begin, begin + 0.5 * width
                below[top + 2], above[top + 2] = begin + 0.5 * width, begin + width
                top += 2
                continue
            total += value
            for a in range(n):
                for b in range(m):
                    exact[a, b] += here[a, b]
                    rough[a, b] += here_rough[a, b]
    return total
