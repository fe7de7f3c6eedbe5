r"""The plane between two media: how it reflects and transmits :math:`E_y` and :math:`Z_0 H_y`.

Light of a component :math:`k_y` along the cylinder is reflected into both (conical incidence): the
Fresnel coefficients of s and p light turned into these components. Wavenumbers are in units of k.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


class Reflection(NamedTuple):
    r"""The matrix [[ee, eh], [he, hh]] from :math:`(E_y, Z_0 H_y)` to itself."""

    ee: Array
    eh: Array
    he: Array
    hh: Array


def fresnel(here: Array, beyond: Array, n_here: complex, n_beyond: complex) -> tuple[Array, Array]:
    """Return r_s, of E, and r_p, of H, for normal components of the wave vector on both sides."""
    e_here, e_beyond = n_here**2, n_beyond**2
    r_s = (here - beyond) / (here + beyond)
    r_p = (e_beyond * here - e_here * beyond) / (e_beyond * here + e_here * beyond)
    return r_s, r_p


def reflection(
    along: Array, across: Array, here: Array, beyond: Array, n_here: float, n_beyond: float,
    upwards: bool,
) -> Reflection:  # fmt: skip
    r"""Return the reflection of light that comes from one side.

    .. math::

        r = \begin{pmatrix} r_s - w & \mp v \\ \pm \varepsilon v & r_p - w \end{pmatrix}, \quad
        w = \frac{k_z^2 k_y^2 g}{\kappa^2},\; v = \frac{k k_x k_y k_z g}{\kappa^2},\;
        g = \frac{2 (\varepsilon - \varepsilon')}{(k_z + k_z')(\varepsilon' k_z + \varepsilon k_z')}

    upper signs for light that travels upwards. Transmission is 1 + r.

    Parameters
    ----------
    along, across : ndarray
        k_y and k_x over k.
    here, beyond : ndarray
        k_z over k on the side that the light is on, and beyond the plane; positive.
    n_here, n_beyond : float
        Refractive indices.
    upwards : bool
        Whether the light comes from below.
    """
    e_here, e_beyond = n_here**2, n_beyond**2
    r_s, r_p = fresnel(here, beyond, n_here, n_beyond)
    g = 2 * (e_here - e_beyond) / ((here + beyond) * (e_beyond * here + e_here * beyond))
    kappa_squared = e_here - along**2
    w = here**2 * along**2 * g / kappa_squared
    v = across * along * here * g / kappa_squared * (1 if upwards else -1)
    return Reflection(r_s - w, -v, e_here * v, r_p - w)


def normal(index: complex, sine: NDArray[np.float64]) -> Array:
    """Return k_z over k in a medium, for the tangential component ρ over k."""
    found: Array = np.sqrt(index**2 - np.square(sine) + 0j)
    return found
