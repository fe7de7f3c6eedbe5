r"""What a detector collects of a weak cylinder's light, by Born: an integral over its area.

.. math:: D = \frac{i k^2}{2 \pi N} \int ds_y \int \Delta\varepsilon\, E(-s_y) \cdot E(s_y)\, dA

Nothing of the package but the pupil's amplitudes is in it: the light is vectors of s and p,
refracted by Fresnel's coefficients, summed over plane waves at points of the cylinder's section.
"""

from typing import Any

import numpy as np
from dense_waves import Beam, Slide
from numpy.typing import NDArray

Array = NDArray[Any]


def light_at(slide: Slide, beam: Beam, k: float, along: float, x: Array, z: Array) -> Array:
    """Return E of light with s_y at points (P,), of both polarisations: (2, 3, P)."""
    node, weight = np.polynomial.legendre.leggauss(80)
    reach = np.sqrt(beam.aperture**2 - along**2)
    sx = reach * node
    rho = np.hypot(sx, along)
    c, s = sx / rho, along / rho
    below, above = (np.sqrt(n**2 - rho**2) for n in (slide.n_glass, slide.n_water))
    e_1, e_2 = slide.n_glass**2, slide.n_water**2
    t_s = 2 * below / (below + above)
    t_p = 2 * slide.n_glass * slide.n_water * below / (e_2 * below + e_1 * above)
    size = weight * reach * beam.pupil.amplitude(rho, beam.aperture, k)
    size = size / np.sqrt(below / slide.n_glass) * np.exp(-1j * k * beam.focus * below)
    azimuthal = np.stack([-s, c, np.zeros_like(s)])
    cosine = above / slide.n_water
    radial = np.stack([c * cosine, s * cosine, -rho / slide.n_water])
    waves = np.exp(1j * k * (sx[:, np.newaxis] * x + above[:, np.newaxis] * z))
    return np.stack(
        [
            (size * (of_p * t_p * radial + of_s * t_s * azimuthal)) @ waves
            for of_p, of_s in ((c, -s), (s, c))
        ]
    )


def born_return(slide: Slide, beam: Beam, k: float) -> Array:
    """Return what is collected of a cylinder's light, polarised across it and along it, (2,)."""
    node, weight = np.polynomial.legendre.leggauss(24)
    a = slide.diameter / 2
    r, dr = a * (node + 1) / 2, a * weight / 2
    turn = 2 * np.pi * np.arange(48) / 48
    x = slide.offset + r[:, np.newaxis] * np.cos(turn)
    z = slide.gap + a + r[:, np.newaxis] * np.sin(turn)
    area = np.broadcast_to((r * dr)[:, np.newaxis] * 2 * np.pi / 48, x.shape).ravel()
    total = np.zeros(2, np.complex128)
    along, measure = np.polynomial.legendre.leggauss(60)
    # s_y and −s_y change places in the product: half of them, twice
    for one, share in zip(beam.aperture * along[30:], beam.aperture * measure[30:], strict=True):
        there, back = (
            light_at(slide, beam, k, sign * one, x.ravel(), z.ravel()) for sign in (1, -1)
        )
        total += 2 * share * ((there * back).sum(axis=1) * area).sum(axis=1)
    rho = beam.aperture * (along + 1) / 2
    squared = beam.pupil.amplitude(rho, beam.aperture, k) ** 2
    whole = 4 * np.pi * slide.n_glass * (squared * rho * measure).sum() * beam.aperture / 2
    contrast = slide.n_neuron**2 - slide.n_water**2
    return np.asarray(1j * k**2 / (2 * np.pi * whole) * contrast * total)
