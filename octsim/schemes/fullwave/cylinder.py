r"""The cylinder: which waves it scatters of those that reach it, order by order.

(J. R. Wait, Can. J. Phys. 33, 189 (1955)), for :math:`(E_y, Z_0 H_y)` at oblique incidence.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.fullwave.bessel import Cylindrical, Kinds, kinds
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.orders import waves_along
from octsim.schemes.fullwave.two_by_two import matrix, solved, times

Array = NDArray[Any]
UNIT = np.eye(2).reshape(2, 2, 1, 1, 1)


class Scattering(NamedTuple):
    """Matrices (2, 2, K, Y, M + 1) from regular to outgoing waves."""

    whole: Array
    """T."""
    near_side: Array
    """Its Debye term p = 0: reflection off the surface from outside, and diffraction, which goes
    forwards."""
    far_side: Array
    """Its Debye term p = 2: in, reflected once inside, and out."""


class Interface(NamedTuple):
    """What a surface does to waves that go out (H⁽¹⁾) and in (H⁽²⁾), relative to their values."""

    from_outside: Array
    """What it reflects."""
    from_inside: Array
    into: Array
    """What it transmits."""
    out: Array


class Side(NamedTuple):
    """What the boundary condition needs of one medium."""

    n: complex
    kappa: Array
    """Over k; imaginary where light decays."""
    skew: Array
    """α: i k_y m / (a κ²), over k."""


def scattering(
    scene: CylinderOnPlane, along: NDArray[np.float64], k: NDArray[np.float64], waves: int
) -> Scattering:
    r"""Return the matrices for components k_y / k (Y,) at wavenumbers (K,): (2, 2, K, Y, M + 1).

    .. math::

        T_m = -N_H^{-1} N_J, \quad N_Z = \begin{pmatrix}
        \alpha Z J_3 & k (Z' J_3 / \kappa_2 - J_3' Z / \kappa_3) \\
        -k (\varepsilon_2 Z' J_3 / \kappa_2 - \varepsilon_3 J_3' Z / \kappa_3) & \alpha Z J_3
        \end{pmatrix}

    with Z of κ₂a, J₃ of κ₃a and :math:`\alpha = i k_y m / a\, (1/\kappa_2^2 - 1/\kappa_3^2)`.
    """
    neuron = complex(scene.n_neuron, scene.kappa) if scene.kappa else scene.n_neuron
    outside, inside = (
        side_of(index, along, k, waves, scene.radius) for index in (scene.n_water, neuron)
    )
    size = scene.radius * k[:, np.newaxis]
    in_water, within = (kinds(size * side.kappa, waves) for side in (outside, inside))
    core = _scaled(within.regular)
    at_boundary = (
        _boundary(one, outside, core, inside) for one in (in_water.outgoing, in_water.regular)
    )
    whole = -solved(*at_boundary)
    # those beyond scatter nothing but rounding, by which the coupling, which grows with the order,
    # would be overwhelmed
    kept = np.arange(waves + 1) <= waves_along(scene, along, k, waves)[..., np.newaxis]
    surface = interface(outside, inside, in_water, within)
    debye = debye_terms(surface, in_water, within)
    return Scattering(*(one * kept for one in (whole, *debye)))


def side_of(
    index: complex, along: NDArray[np.float64], k: NDArray[np.float64], waves: int, radius: float
) -> Side:
    """Return what the boundary condition needs of a medium at a radius (µm)."""
    # beyond the medium's index light decays in it
    kappa = np.emath.sqrt(index**2 - along**2)
    m = np.arange(waves + 1)
    skew = 1j * along[:, np.newaxis] * m / (radius * k[:, np.newaxis, np.newaxis])
    return Side(index, kappa, skew / (kappa**2)[:, np.newaxis])


def _scaled(one: Cylindrical) -> Cylindrical:
    """Return a function over its size, as the boundary condition is homogeneous in it.

    By a power of two, so that nothing is rounded: no contrast scatters exactly nothing.
    """
    _, exponent = np.frexp(np.hypot(np.abs(one.value), np.abs(one.slope)))
    scale = np.ldexp(1.0, -exponent)
    return Cylindrical(one.value * scale, one.slope * scale)


def _boundary(outer: Cylindrical, outside: Side, core: Cylindrical, inside: Side) -> Array:
    """Return N."""
    skew = (outside.skew - inside.skew) * (outer.value * core.value)
    there = outer.slope * core.value * (1 / outside.kappa)[:, np.newaxis]
    here = core.slope * outer.value * (1 / inside.kappa)[:, np.newaxis]
    return matrix(skew, there - here, inside.n**2 * here - outside.n**2 * there, skew)


def admittance(one: Cylindrical, side: Side) -> Array:
    r"""Return the matrix from :math:`(E_y, H_y)` to what is continuous beside them.

    Relative to the function's own value, which never is 0.
    """
    turn = one.slope / one.value * (1 / side.kappa)[:, np.newaxis]
    return matrix(side.skew, turn, -(side.n**2) * turn, side.skew)


def interface(outside: Side, inside: Side, around: Kinds, within: Kinds) -> Interface:
    """Return what a surface does to waves on both sides of it; transmission is one more."""
    out_2, in_2 = (admittance(one, outside) for one in around[1:])
    out_3, in_3 = (admittance(one, inside) for one in within[1:])
    from_outside = solved(in_3 - out_2, in_2 - in_3)
    from_inside = solved(out_2 - in_3, out_3 - out_2)
    return Interface(from_outside, from_inside, UNIT + from_outside, UNIT + from_inside)


def debye_terms(surface: Interface, around: Kinds, within: Kinds) -> tuple[Array, Array]:
    """Return the terms p = 0, with diffraction, and p = 2, of what surrounds a core.

    (Hovenac & Lock, JOSA A 9, 781 (1992); Lock, JOSA A 14, 640 (1997).)

    Parameters
    ----------
    surface : Interface
        Of one surface, or of several taken for one.
    around, within : Kinds
        Functions around the outermost one and in the core.
    """
    turn_2, turn_3 = (one.outgoing.value / one.incoming.value for one in (around, within))
    near = (surface.from_outside / turn_2 - UNIT) / 2
    inside = times(surface.from_inside, surface.into)
    return near, times(surface.out, inside) * (turn_3**2 / turn_2 / 2)
