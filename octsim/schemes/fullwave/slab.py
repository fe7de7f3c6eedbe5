r"""What planes below and above send back to the cylinder, to and fro between them.

The outgoing waves are plane waves over complex angles β (`coupling`), downwards and upwards,

.. math::

    d = \frac1\pi \sum_m (-1)^m b_m e^{i m \beta}, \quad u = \frac1\pi \sum_m b_m e^{-i m \beta},

and with what the stacks below and above reflect, :math:`r'` at the height of the axis,

.. math::

    U = \frac{r'_b (d + r'_a u)}{1 - r'_b r'_a}, \quad D = \frac{r'_a (u + r'_b d)}{1 - r'_b r'_a},
    \quad a_m = \int U e^{i m \beta} + (-1)^m D e^{-i m \beta}\, d\beta.

These are of s and of p light, which planes do not mix.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.fullwave.coupling import Contour, Coupling, both_signs, coupling, reflected
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.stacks import above_water, below_water, conical

Array = NDArray[Any]
Both = tuple[Array, Array]
"""Of E_y and of H_y."""
_EVEN_ODD = slice(0, None, 2), slice(1, None, 2)


class Slab(NamedTuple):
    """What comes of plane waves at the contour's nodes, times (2/π) dβ, (K, Y, B) each."""

    up_of_down: Coupling
    """Light that reaches the cylinder upwards, of that which left it downwards."""
    up_of_up: Coupling
    down_of_up: Coupling
    down_of_down: Coupling


Planes = Coupling | Slab
"""One plane or stack below the cylinder, or one above it as well."""


def planes_of(
    scene: CylinderOnPlane, path: Contour, along: NDArray[np.float64], k: NDArray[np.float64]
) -> Planes:
    """Return what the planes do for components k_y / k (Y,) at wavenumbers (K,), 1/µm."""
    if scene.one_plane:
        return coupling(scene, path, along, k)
    epsilon = scene.n_water**2
    kappa = np.sqrt(epsilon - along**2)[:, np.newaxis]
    across, here = kappa * np.sin(path.angle), kappa * np.cos(path.angle)
    sideways, wavenumber = along[:, np.newaxis] + 0j, k[:, np.newaxis, np.newaxis]
    squared = across**2 + sideways**2
    measure = 2 / np.pi * path.weight

    def of(s_light: Array, p_light: Array, turned: bool, upwards: bool) -> Coupling:
        found = conical((s_light, p_light), sideways, across, here, epsilon, turned, upwards)
        return Coupling(*(part * measure for part in found))

    below = below_water(scene, squared, wavenumber)
    down = np.exp(2j * scene.height * wavenumber * here)
    if not scene.above:
        return of(below[0] * down, below[1] * down, turned=True, upwards=False)
    above = above_water(scene, squared, wavenumber)
    up = np.exp(2j * (scene.room - scene.height) * wavenumber * here)
    each = []
    for r_b, r_a in zip((r * down for r in below), (r * up for r in above), strict=True):
        often = 1 / (1 - r_b * r_a)
        each.append((r_b * often, r_a * often, r_b * r_a * often))
    (s_b, s_a, s_both), (p_b, p_a, p_both) = each
    return Slab(
        of(s_b, p_b, turned=True, upwards=False),
        of(s_both, p_both, turned=False, upwards=True),
        of(s_a, p_a, turned=True, upwards=True),
        of(s_both, p_both, turned=False, upwards=False),
    )


def returned(planes: Planes, b_e: Array, b_h: Array, waves_of: Both, mirror: int) -> Both:
    """Return the regular waves that planes make of outgoing ones.

    Parameters
    ----------
    planes : Coupling or Slab
    b_e, b_h : ndarray, shape (K, Y, M + 1) or (Y, M + 1)
        Of E_y and H_y, m ≥ 0, of one mirror class.
    waves_of : (ndarray, ndarray)
        e^{imβ}, (M + 1, B), the part of it that has the class's parity, of E_y and H_y.
    mirror : int
        The class.
    """
    if isinstance(planes, Coupling):
        return reflected(planes, b_e, b_h, *waves_of)
    signs = both_signs(b_e.shape[-1])
    if b_e.ndim == 2:
        return _returned_once(planes, signs * b_e, signs * b_h, waves_of, mirror)
    found = np.empty_like(b_e), np.empty_like(b_h)
    # one wavenumber at a time, which fast memory holds
    for number in range(len(b_e)):
        slab = Slab(*(_at(part, number) for part in planes))
        found[0][number], found[1][number] = _returned_once(
            slab, signs * b_e[number], signs * b_h[number], waves_of, mirror
        )
    return found


def _returned_once(slab: Slab, b_e: Array, b_h: Array, waves_of: Both, mirror: int) -> Both:
    """Return the regular waves of one wavenumber, (Y, M + 1), of both signs' outgoing ones."""
    even = parities(mirror)
    sent = []
    for b, waves in zip((b_e, b_h), waves_of, strict=True):
        # of even orders, which go both ways alike, and of odd ones, with a sign
        of_even, of_odd = (b[:, part] @ waves[part] for part in _EVEN_ODD)
        sent.append((of_even + of_odd, of_even - of_odd))
    (d_e, u_e), (d_h, u_h) = sent
    u_e, u_h = even[0] * u_e, even[1] * u_h
    up = _sum(_sent(slab.up_of_down, d_e, d_h), _sent(slab.up_of_up, u_e, u_h))
    down = _sum(_sent(slab.down_of_up, u_e, u_h), _sent(slab.down_of_down, d_e, d_h))
    found = np.empty_like(b_e), np.empty_like(b_h)
    for a, upwards, downwards, waves, parity in zip(found, up, down, waves_of, even, strict=True):
        for part, sign in zip(_EVEN_ODD, (parity, -parity), strict=True):
            a[:, part] = (upwards + sign * downwards) @ waves[part].T
    return found


def parities(mirror: int) -> tuple[int, int]:
    """Return whether E_y and H_y of a mirror class are even in m, 1, or odd, −1."""
    return (-1, 1) if mirror == 0 else (1, -1)


def at(planes: Planes, one: Any) -> Planes:
    """Return what planes do at some k and k_y."""
    if isinstance(planes, Coupling):
        return _at(planes, one)
    return Slab(*(_at(part, one) for part in planes))


def _at(by: Coupling, one: Any) -> Coupling:
    return Coupling(*(part[one] for part in by))


def returned_matrices(planes: Planes, waves_of: Both, mirror: int) -> list[list[Array]]:
    """Return what `returned` does as matrices (Y, M + 1, M + 1): [to][of] E_y and H_y.

    Parameters
    ----------
    planes : Coupling or Slab
        Of Y components k_y at one wavenumber, (Y, B) each.
    waves_of, mirror
        As `returned` has them.
    """
    signs = both_signs(waves_of[0].shape[0])[:, np.newaxis]
    if isinstance(planes, Coupling):
        return _between(planes, waves_of, [signs * waves for waves in waves_of])
    turns = np.where(np.arange(len(signs)) % 2, -1.0, 1.0)[:, np.newaxis]
    even = parities(mirror)
    downwards = [signs * waves for waves in waves_of]
    upwards = [p * turns * waves for p, waves in zip(even, downwards, strict=True)]
    back = [p * turns * waves for p, waves in zip(even, waves_of, strict=True)]
    four = (
        _between(planes.up_of_down, waves_of, downwards),
        _between(planes.up_of_up, waves_of, upwards),
        _between(planes.down_of_up, back, upwards),
        _between(planes.down_of_down, back, downwards),
    )
    first, *others = four
    return [
        [sum((each[to][of] for each in others), first[to][of]) for of in (0, 1)] for to in (0, 1)
    ]


def _sent(by: Coupling, e: Array, h: Array) -> Both:
    return by.ee * e + by.eh * h, by.he * e + by.hh * h


def _sum(one: Both, other: Both) -> Both:
    return one[0] + other[0], one[1] + other[1]


def _between(by: Coupling, to: Any, of: Any) -> list[list[Array]]:
    parts = ((by.ee, by.eh), (by.he, by.hh))
    return [[(to[i] * parts[i][j][:, np.newaxis]) @ of[j].T for j in (0, 1)] for i in (0, 1)]
