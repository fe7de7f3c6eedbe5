r"""The cylinder: which waves it scatters of those that reach it, order by order.

(J. R. Wait, Can. J. Phys. 33, 189 (1955)), for :math:`(E_y, Z_0 H_y)` at oblique incidence.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.fullwave.bessel import Cylindrical, bessel_j, hankel, second_hankel
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane

Array = NDArray[Any]


class Scattering(NamedTuple):
    """Matrices (..., M + 1, 2, 2) from regular to outgoing waves."""

    whole: Array
    """T."""
    near_side: Array
    """Its Debye term p = 0: reflection off the surface from outside, and diffraction, which goes
    forwards."""
    far_side: Array
    """Its Debye term p = 2: in, reflected once inside, and out."""


class _Side(NamedTuple):
    """What the boundary condition needs of one medium."""

    n: float
    kappa: NDArray[np.float64]
    """Over k."""
    skew: Array
    """α: i k_y m / (a κ²), over k."""


def scattering(
    scene: CylinderOnPlane, along: NDArray[np.float64], k: NDArray[np.float64], waves: int
) -> Scattering:
    r"""Return the matrices for components k_y / k (Y,) at wavenumbers (K,): (K, Y, M + 1, 2, 2).

    .. math::

        T_m = -N_H^{-1} N_J, \quad N_Z = \begin{pmatrix}
        \alpha Z J_3 & k (Z' J_3 / \kappa_2 - J_3' Z / \kappa_3) \\
        -k (\varepsilon_2 Z' J_3 / \kappa_2 - \varepsilon_3 J_3' Z / \kappa_3) & \alpha Z J_3
        \end{pmatrix}

    with Z of κ₂a, J₃ of κ₃a and :math:`\alpha = i k_y m / a\, (1/\kappa_2^2 - 1/\kappa_3^2)`.
    """
    outside, inside = (
        _side(index, along, k, waves, scene.radius) for index in (scene.n_water, scene.n_neuron)
    )
    size = scene.radius * k[:, np.newaxis]
    j2, h2 = (f(size * outside.kappa, waves) for f in (bessel_j, hankel))
    h3 = hankel(size * inside.kappa, waves)
    j3 = Cylindrical(h3.value.real, h3.slope.real)
    core = _scaled(j3)
    whole = -_solved(_boundary(h2, outside, core, inside), _boundary(j2, outside, core, inside))
    kept = _kept(size * np.maximum(outside.kappa, inside.kappa), waves)
    return Scattering(*(one * kept for one in (whole, *_debye(outside, inside, h2, h3))))


def _kept(size: NDArray[np.float64], waves: int) -> NDArray[np.float64]:
    """Return 1 for the waves that a size k a κ (K, Y) has, else 0, (K, Y, M + 1, 1, 1).

    Light along the cylinder has fewer. Those beyond scatter nothing but rounding, by which the
    coupling to the plane, which grows with the order, would be overwhelmed.
    """
    largest = size.max()
    most = size + (waves - largest) * np.cbrt(size / largest)
    found: NDArray[np.float64] = (np.arange(waves + 1) <= most[..., np.newaxis]).astype(float)
    return found[..., np.newaxis, np.newaxis]


def _side(
    index: float, along: NDArray[np.float64], k: NDArray[np.float64], waves: int, radius: float
) -> _Side:
    kappa = np.sqrt(index**2 - along**2)
    m = np.arange(waves + 1)
    skew = 1j * along[:, np.newaxis] * m / (radius * k[:, np.newaxis, np.newaxis])
    return _Side(index, kappa, skew / (kappa**2)[:, np.newaxis])


def _scaled(one: Cylindrical) -> Cylindrical:
    """Return a function divided by its size: the boundary condition is homogeneous in it."""
    size = np.hypot(np.abs(one.value), np.abs(one.slope))
    return Cylindrical(one.value / size, one.slope / size)


def _tangential(one: Cylindrical, side: _Side) -> Array:
    r"""Return the matrix from :math:`(E_y, H_y)` to what is continuous beside them."""
    kappa = side.kappa[:, np.newaxis]
    skew, turn = side.skew * one.value, one.slope / kappa
    return _matrix(skew, turn, -(side.n**2) * turn, skew)


def _boundary(outer: Cylindrical, outside: _Side, core: Cylindrical, inside: _Side) -> Array:
    """Return N."""
    j3, z = (one.value[..., np.newaxis, np.newaxis] for one in (core, outer))
    found: Array = j3 * _tangential(outer, outside) - z * _tangential(core, inside)
    return found


def _debye(outside: _Side, inside: _Side, h2: Cylindrical, h3: Cylindrical) -> tuple[Array, Array]:
    """Return the terms p = 0, with diffraction, and p = 2.

    With what goes out (H⁽¹⁾) and in (H⁽²⁾, its conjugate) on both sides of the surface: reflection
    from outside and from inside, and transmission, which is one more.
    (Hovenac & Lock, JOSA A 9, 781 (1992); Lock, JOSA A 14, 640 (1997).)
    """
    out_2, in_2 = _admittance(h2, outside), _admittance(second_hankel(h2), outside)
    out_3, in_3 = _admittance(h3, inside), _admittance(second_hankel(h3), inside)
    from_outside = _solved(in_3 - out_2, in_2 - in_3)
    from_inside = _solved(out_2 - in_3, out_3 - out_2)
    one = np.eye(2)
    into, out = one + from_outside, one + from_inside
    turn_2, turn_3 = ((h.value / np.conj(h.value))[..., np.newaxis, np.newaxis] for h in (h2, h3))
    near = (from_outside / turn_2 - one) / 2
    far = out @ from_inside @ into * turn_3**2 / turn_2 / 2
    return near, far


def _admittance(one: Cylindrical, side: _Side) -> Array:
    # relative to the function's own value, which never is 0
    return _tangential(Cylindrical(np.ones_like(one.value), one.slope / one.value), side)


def _matrix(a: Array, b: Array, c: Array, d: Array) -> Array:
    found = np.empty((*a.shape, 2, 2), np.complex128)
    found[..., 0, 0], found[..., 0, 1], found[..., 1, 0], found[..., 1, 1] = a, b, c, d
    return found


def _solved(matrix: Array, right: Array) -> Array:
    """Return matrix⁻¹ right, of 2 × 2 matrices."""
    a, b, c, d = (matrix[..., i, j] for i in (0, 1) for j in (0, 1))
    determinant = (a * d - b * c)[..., np.newaxis, np.newaxis]
    found: Array = _matrix(d, -b, -c, a) @ right / determinant
    return found
