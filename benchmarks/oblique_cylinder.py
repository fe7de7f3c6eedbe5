"""A cylinder in light that comes at an angle to its axis: Wait's coefficients, read literally.

Wait, Can. J. Phys. 33, 189 (1955). Partial waves J_m(κ₂ρ) e^{imφ} e^{ik_y y} of F = (E_y, Z₀H_y)
come to H_m of it. φ goes from +x to +z, which is left-handed about +y and decides the sign of what
light along the cylinder comes to across it. Time goes as exp(−iωt).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import h1vp, hankel1, jv, jvp


def wait(
    k: float, ky: float, order: int, radius: float, outside: float, inside: float
) -> NDArray[np.complex128]:
    """Return the 2 × 2 matrix from the incident to the outgoing partial wave of an order."""
    # imaginary beyond a medium's index, where light decays
    k2, k3 = (np.emath.sqrt((n * k) ** 2 - ky**2) for n in (outside, inside))
    alpha = 1j * ky * order / radius * (1 / k2**2 - 1 / k3**2)
    within, within_slope = jv(order, k3 * radius), jvp(order, k3 * radius)

    def at_surface(wave: complex, slope: complex) -> NDArray[np.complex128]:
        of_h = k * (slope * within / k2 - within_slope * wave / k3)
        of_e = k * (outside**2 * slope * within / k2 - inside**2 * within_slope * wave / k3)
        return np.array([[alpha * wave * within, of_h], [-of_e, alpha * wave * within]])

    outgoing = at_surface(hankel1(order, k2 * radius), h1vp(order, k2 * radius))
    regular = at_surface(jv(order, k2 * radius), jvp(order, k2 * radius))
    return np.asarray(-np.linalg.solve(outgoing, regular))
