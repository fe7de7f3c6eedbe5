r"""What the cylinder among planes scatters: :math:`b = T (a + R b)` for each k and k_y."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.fullwave.illumination import Lit
from octsim.schemes.fullwave.operators import Operator
from octsim.schemes.fullwave.slab import at, returned, returned_matrices

Array = NDArray[Any]
Waves = tuple[Array, Array]
"""Of E_y and H_y, (K, Y, M + 1) each."""
_ITERATIONS = 40


class Incoming(NamedTuple):
    """All regular waves that reach the cylinder, of one mirror class, (K, Y, M + 1) each."""

    e: Array
    h: Array
    multiplications: float
    """Complex ones that they took, about: the same on all machines."""


def incoming(operator: Operator, lit: Lit, tolerance: float) -> Incoming:
    """Return the waves that reach the cylinder, a + R b, of one mirror class.

    By iteration, once through the plane each time; directly at those k and k_y where that does not
    converge, as for an index far from the water's or a large cylinder.

    Parameters
    ----------
    operator : Operator
        Of the scene.
    lit : Lit
        Its illumination.
    tolerance : float
        Largest change of outgoing waves in the last step, over the largest.
    """
    waves_of, whole = operator.mirrors[lit.mirror], operator.cylinder.whole
    e, h = lit.e, lit.h
    out = scattered(whole, e, h)
    before, once, done = np.inf, 4.0 * e.size * waves_of[0].shape[1], 0.0
    for _ in range(_ITERATIONS):
        done += once
        back_e, back_h = returned(operator.plane, *out, waves_of, lit.mirror)
        e, h = lit.e + back_e, lit.h + back_h
        # outgoing waves tell: regular ones of high orders are large, and scatter nothing
        following = scattered(whole, e, h)
        of_e, of_h = (np.abs(b - a).max(axis=-1) for a, b in zip(out, following, strict=True))
        changes = np.maximum(of_e, of_h)
        out = following
        change = float(changes.max())
        left = changes > tolerance * max(float(np.abs(b).max()) for b in out)
        if not left.any():
            return Incoming(e, h, done)
        if not change < before:
            break
        before = change
    for number in np.flatnonzero(left.any(axis=1)).tolist():
        one = number, left[number]
        e[one], h[one] = _direct(operator, lit, one)
    orders, nodes = waves_of[0].shape
    return Incoming(e, h, done + left.sum() * (4 * orders**2 * nodes + (2 * orders) ** 3 / 3))


def scattered(matrix: Array, e: Array, h: Array) -> Waves:
    """Return the outgoing waves of matrices (2, 2, K, Y, M + 1) and regular ones."""
    (ee, eh), (he, hh) = matrix
    return ee * e + eh * h, he * e + hh * h


def _direct(operator: Operator, lit: Lit, one: tuple[int, NDArray[np.bool_]]) -> Waves:
    """Solve (1 − T R) b = T a by elimination, for one k and some k_y, and return a + R b there."""
    waves_of, whole = operator.mirrors[lit.mirror], operator.cylinder.whole[:, :, *one]
    plane = at(operator.plane, one)
    e, h = lit.e[one], lit.h[one]
    orders = e.shape[-1]
    back = returned_matrices(plane, waves_of, lit.mirror)
    # T falls with the order as fast as R grows: unknowns are b over the root of T
    scale = np.sqrt(np.abs(whole).max(axis=(0, 1)))
    inverse = np.divide(1.0, scale, out=np.zeros_like(scale), where=scale > 0)
    balance = inverse[:, :, np.newaxis] * scale[:, np.newaxis]
    # T R, each order of T by itself
    both = np.block(
        [
            [
                balance * sum(whole[to, i][..., np.newaxis] * back[i][of] for i in (0, 1))
                for of in (0, 1)
            ]
            for to in (0, 1)
        ]
    )
    right = np.concatenate([part * inverse for part in scattered(whole, e, h)], axis=-1)
    found = np.linalg.solve(np.eye(2 * orders) - both, right[..., np.newaxis])[..., 0]
    out_e, out_h = found[:, :orders] * scale, found[:, orders:] * scale
    back_e, back_h = returned(plane, out_e, out_h, waves_of, lit.mirror)
    return e + back_e, h + back_h
