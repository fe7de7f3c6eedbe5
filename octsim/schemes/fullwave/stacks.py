r"""Stacks of planes: how they reflect and let through light polarised s and p, and E_y and Z₀H_y.

.. math::

    r \to \frac{r_{j,j+1} + r\, e^{2 i k_z d}}{1 + r_{j,j+1}\, r\, e^{2 i k_z d}}, \quad
    t \to \frac{(1 + r_{j,j+1})\, t\, e^{i k_z d}}{1 + r_{j,j+1}\, r\, e^{2 i k_z d}}

from the farthest plane on (Airy's sum of all reflections to and fro, Born & Wolf, ch. 1.6), for E
of s light and H of p light. Wavenumbers are in units of k.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane, Layer
from octsim.schemes.fullwave.plane import Reflection, fresnel

Array = NDArray[Any]
Pair = tuple[Array, Array]
"""Of s and of p light."""


class Through(NamedTuple):
    """What a stack does to light, of s and of p."""

    reflected: Pair
    """From its first plane, at that plane."""
    passed: Pair
    """From its first plane to its last one."""


def through(
    indices: Sequence[complex], thickness: Sequence[float], squared: Array, k: Array
) -> Through:
    """Return what a stack does to light.

    Parameters
    ----------
    indices : sequence of complex
        n + iκ from where the light comes to where it goes, (S + 1,) of S planes.
    thickness : sequence of float
        From each plane to the next one, (S − 1,), µm.
    squared : ndarray
        ρ² of the light, its component along the planes; complex on a contour.
    k : ndarray
        Wavenumbers, 1/µm, to be broadcast with ρ².
    """
    normals = [np.sqrt(n**2 - squared + 0j) for n in indices]
    steps = [
        fresnel(*sides, *media)
        for sides, media in zip(pairwise(normals), pairwise(indices), strict=True)
    ]
    if not steps:
        nothing = np.zeros_like(normals[0])
        return Through((nothing, nothing), (nothing + 1, nothing + 1))
    whole, passed = steps[-1], _passed(steps[-1])
    for step, inside, d in zip(steps[-2::-1], normals[-2:0:-1], reversed(thickness), strict=True):
        once = np.exp(1j * k * d * inside)
        below = [1 + one * beyond * once**2 for one, beyond in zip(step, whole, strict=True)]
        passed = _pair(
            (1 + one) * on * once / to_and_fro
            for one, on, to_and_fro in zip(step, passed, below, strict=True)
        )
        whole = _pair(
            (one + beyond * once**2) / to_and_fro
            for one, beyond, to_and_fro in zip(step, whole, below, strict=True)
        )
    return Through(whole, passed)


def below_water(scene: CylinderOnPlane, squared: Array, k: Array) -> Pair:
    """Return the reflection of the planes below the water for light in it, at the highest."""
    indices = (scene.n_water, *(film.n for film in reversed(scene.films)), scene.n_glass)
    return through(indices, [f.thickness for f in reversed(scene.films)], squared, k).reflected


def above_water(scene: CylinderOnPlane, squared: Array, k: Array) -> Pair:
    """Return the reflection of the planes above the water for light in it, at the lowest."""
    indices = (scene.n_water, *(layer.n for layer in scene.above))
    thickness = [layer.thickness for layer in scene.above[:-1]]
    return through(indices, thickness, squared, k).reflected


def into_water(scene: CylinderOnPlane, squared: Array, k: Array) -> Pair:
    """Return what comes from the glass through the planes below the water, and just them."""
    indices = (scene.n_glass, *(film.n for film in scene.films), scene.n_water)
    return through(indices, [film.thickness for film in scene.films], squared, k).passed


def from_glass(scene: CylinderOnPlane, squared: Array, k: Array) -> Pair:
    """Return the reflection of all planes, without the cylinder, for light in the glass."""
    layers = scene.films
    if scene.above:
        layers = (*layers, Layer(scene.n_water, scene.room), *scene.above)
    indices = [scene.n_glass, *(layer.n for layer in layers)]
    thickness = [layer.thickness for layer in layers]
    if scene.above:
        thickness.pop()
    else:
        indices.append(scene.n_water)
    return through(indices, thickness, squared, k).reflected


def conical(
    of: Pair, along: Array, across: Array, here: Array, epsilon: float, turned: bool, upwards: bool
) -> Reflection:
    r"""Return what multiplies s and p light as a matrix of :math:`(E_y, Z_0 H_y)` in one medium.

    .. math::

        \begin{pmatrix} q_s - w & -u v \\ b u \varepsilon v & q_p - b w \end{pmatrix}, \quad
        w = \frac{k_z^2 k_y^2}{\kappa^2} \frac{q_s + b q_p}{\rho^2}, \;
        v = \frac{k_x k_y k_z}{\kappa^2} \frac{q_s + b q_p}{\rho^2}

    with b = 1 for light that is turned back, −1 for light that goes on, and u = 1 for light from
    below, −1 for light from above.

    Parameters
    ----------
    of : (ndarray, ndarray)
        q_s of E and q_p of H.
    along, across, here : ndarray
        k_y, k_x and k_z over k.
    epsilon : float
        n² of the medium.
    turned : bool
        Whether the light goes the other way after.
    upwards : bool
        Whether it comes from below.
    """
    q_s, q_p = of
    back, up = (1 if turned else -1), (1 if upwards else -1)
    share = (q_s + back * q_p) / (across**2 + along**2)
    kappa_squared = epsilon - along**2
    w = here**2 * along**2 * share / kappa_squared
    v = up * across * along * here * share / kappa_squared
    return Reflection(q_s - w, -v, back * epsilon * v, q_p - back * w)


def _passed(step: Pair) -> Pair:
    return 1 + step[0], 1 + step[1]


def _pair(both: Any) -> Pair:
    one, other = both
    return one, other
