r"""What the plane sends back to the cylinder of the waves that it scatters.

An outgoing partial wave is a sum of plane waves over complex angles β, each reflected:

.. math::

    a_m = \sum_{m'} R_{mm'} b_{m'}, \quad
    R_{mm'} = \frac{(-1)^{m'}}{\pi} \int r(\beta)\, e^{2 i \kappa_2 h \cos\beta}
    e^{i (m + m') \beta}\, d\beta

(Cincotti et al., Opt. Commun. 95, 192 (1993); Borghi et al., JOSA A 13, 483 (1996)). R is never
built: the sum over m' is taken at the contour's nodes, reflected, and integrated.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.gauss_legendre import gauss_legendre
from octsim.schemes.fullwave.plane import reflection

Array = NDArray[Any]
_STEEPEST = 1 - 0.6 / np.pi
"""Of a right angle: how far the contour keeps from the branch points above it."""

_LARGEST = 600.0
"""Exponent of e^{imβ} on the contour."""
_FALL = 34.0
"""How far below its largest the integrand's exponent is where the contour ends."""
_FAR = np.geomspace(1e-3, 30, 400)
"""Ends τ to choose from."""


class Contour(NamedTuple):
    """The half of the contour with Re β > 0; the other is its mirror image."""

    angle: Array
    """β at B nodes."""
    weight: Array
    """dβ of each."""


def contour(nodes: int, waves: ArrayLike, height: ArrayLike) -> Contour:
    """Return the half contour β = c gd(2τ) − iτ, Gauss–Legendre in Re β + τ.

    Parameters
    ----------
    nodes : int
        B.
    waves, height : array_like
        Largest order M, and κ₂h, of each integral that it is for: the larger M is against κ₂h, the
        farther it reaches.
    """
    orders, heights = (np.atleast_1d(one)[:, np.newaxis] for one in (waves, height))
    exponent = 2 * orders * _FAR - 2 * heights * np.sin(_real(_FAR)) * np.sinh(_FAR)
    largest = np.maximum(exponent.max(axis=1, keepdims=True), 0.0)
    counts = (exponent > largest - _FALL).any(axis=0)
    last = min(np.append(0, np.flatnonzero(counts) + 1)[-1], len(_FAR) - 1)
    farthest = min(_FAR[last], _LARGEST / orders.max())
    scale = _STEEPEST
    end = float(_real(np.array(farthest)) + farthest)
    x, w = gauss_legendre(nodes)
    reach = end * (x + 1) / 2
    tau = reach / (1 + 2 * scale)
    for _ in range(60):
        slope = 1 + 2 * scale / np.cosh(2 * tau)
        tau = tau - (_real(tau) + tau - reach) / slope
    turn = 2 * scale / np.cosh(2 * tau)
    return Contour(_real(tau) - 1j * tau, end / 2 * w * (turn - 1j) / (turn + 1))


def _real(tau: NDArray[np.float64]) -> NDArray[np.float64]:
    found: NDArray[np.float64] = _STEEPEST * 2 * np.arctan(np.tanh(tau))  # c gd(2τ)
    return found


class Coupling(NamedTuple):
    """The reflected plane waves at the contour's nodes, times (2/π) dβ, (K, Y, B) each."""

    ee: Array
    eh: Array
    he: Array
    hh: Array


def coupling(
    scene: CylinderOnPlane, path: Contour, along: NDArray[np.float64], k: NDArray[np.float64]
) -> Coupling:
    """Return the coupling for components k_y / k (Y,) at wavenumbers (K,), 1/µm."""
    water, glass = scene.n_water, scene.n_glass
    kappa = np.sqrt(water**2 - along**2)[:, np.newaxis]
    across, here = kappa * np.sin(path.angle), kappa * np.cos(path.angle)
    sideways = along[:, np.newaxis] + 0j
    beyond = np.sqrt(glass**2 - sideways**2 - across**2)
    r = reflection(sideways, across, here, beyond, water, glass, upwards=False)
    travel = np.exp(2j * scene.height * k[:, np.newaxis, np.newaxis] * here)
    return Coupling(*(part * (2 / np.pi * path.weight) * travel for part in r))


def reflected(
    by: Coupling, b_e: Array, b_h: Array, e_waves: Array, h_waves: Array
) -> tuple[Array, Array]:
    """Return the regular waves (K, Y, M + 1) that the plane makes of outgoing ones.

    Parameters
    ----------
    by : Coupling
        What reflects.
    b_e, b_h : ndarray, shape (K, Y, M + 1)
        Of E_y and H_y, m ≥ 0, of one mirror class.
    e_waves, h_waves : ndarray, shape (M + 1, B)
        e^{imβ}, the part of it that has the class's parity, of E_y and H_y.
    """
    signs = both_signs(b_e.shape[-1])
    out_e, out_h = (signs * b_e) @ e_waves, (signs * b_h) @ h_waves
    back_e = by.ee * out_e + by.eh * out_h
    back_h = by.he * out_e + by.hh * out_h
    return back_e @ e_waves.T, back_h @ h_waves.T


def both_signs(orders: int) -> NDArray[np.float64]:
    """Return (−1)^m, twice for m > 0 as −m counts too, (M + 1,)."""
    signs = np.where(np.arange(orders) % 2 == 0, 2.0, -2.0)
    signs[0] = 1.0
    return signs
