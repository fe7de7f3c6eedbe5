r"""What the cylinder over the plane scatters: :math:`b = T (a + R b)` for each k and k_y."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.fullwave.coupling import both_signs, reflected
from octsim.schemes.fullwave.illumination import Lit
from octsim.schemes.fullwave.operators import Operator

Array = NDArray[Any]
Waves = tuple[Array, Array]
"""Of E_y and H_y, (K, Y, M + 1) each."""
_ITERATIONS = 40


def incoming(operator: Operator, lit: Lit, tolerance: float) -> Waves:
    """Return all regular waves that reach the cylinder, a + R b, of one mirror class.

    By iteration, once through the plane each time; directly where that does not converge, as for
    an index far from the water's.

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
    before = np.inf
    for _ in range(_ITERATIONS):
        back_e, back_h = reflected(operator.plane, *out, *waves_of)
        e, h = lit.e + back_e, lit.h + back_h
        # outgoing waves tell: regular ones of high orders are large, and scatter nothing
        following = scattered(whole, e, h)
        change = max(float(np.abs(b - a).max()) for a, b in zip(out, following, strict=True))
        out = following
        if change <= tolerance * max(float(np.abs(b).max()) for b in out):
            return e, h
        if not change < before:
            break
        before = change
    return _direct(operator, lit)


def scattered(matrix: Array, e: Array, h: Array) -> Waves:
    """Return the outgoing waves of matrices (K, Y, M + 1, 2, 2) and regular ones."""
    return (
        matrix[..., 0, 0] * e + matrix[..., 0, 1] * h,
        matrix[..., 1, 0] * e + matrix[..., 1, 1] * h,
    )


def _direct(operator: Operator, lit: Lit) -> Waves:
    """Solve (1 − T R) b = T a by elimination, for each k and k_y, and return a + R b."""
    waves_of, whole = operator.mirrors[lit.mirror], operator.cylinder.whole
    orders, plane = waves_of[0].shape[0], operator.plane
    signs = both_signs(orders)[:, np.newaxis]
    back = np.empty((*lit.e.shape[:2], 2, orders, 2, orders), np.complex128)
    parts = {(0, 0): plane.ee, (0, 1): plane.eh, (1, 0): plane.he, (1, 1): plane.hh}
    for (to, of), part in parts.items():
        back[:, :, to, :, of, :] = (waves_of[to] * part[..., np.newaxis, :]) @ (
            signs * waves_of[of]
        ).T
    # T R: each order of T by itself
    both = np.einsum("kymto,kyomin->kytmin", whole, back)
    size = 2 * orders
    matrix = np.eye(size) - both.reshape(*lit.e.shape[:2], size, size)
    right = np.concatenate(scattered(whole, lit.e, lit.h), axis=-1)[..., np.newaxis]
    found = np.linalg.solve(matrix, right)[..., 0]
    back_e, back_h = reflected(plane, found[..., :orders], found[..., orders:], *waves_of)
    return lit.e + back_e, lit.h + back_h
