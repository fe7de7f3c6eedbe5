r"""What the detector collects: the overlap of returned light with the pupil's own mode."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.optics.pupil import Pupil
from octsim.schemes.fullwave.coupling import both_signs
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.gauss_legendre import gauss_legendre
from octsim.schemes.fullwave.illumination import Lit, Wavefront
from octsim.schemes.fullwave.plane import fresnel, normal
from octsim.schemes.fullwave.stacks import from_glass

Array = NDArray[Any]


def collected(lit: Lit, e: Array, h: Array, n_water: float, along: NDArray[np.float64]) -> Array:
    r"""Return the overlap density of outgoing waves over k_y, (K, Y), by reciprocity.

    .. math:: \frac{2}{\pi (\varepsilon_2 - s_y^2)} \sum_m (-1)^m
        \left[ \varepsilon_2 \tilde a^E_{-m}(-s_y)\, b^E_m - \tilde a^H_{-m}(-s_y)\, b^H_m \right]

    The detected mode's waves ã are those of the illumination: at −m and −s_y the same but for the
    sign of the mirror class that the polarisation does not have of itself.

    Parameters
    ----------
    lit : Lit
        The illumination by the detected mode.
    e, h : ndarray, shape (K, Y, M + 1)
        Outgoing waves of the same mirror class.
    n_water : float
    along : ndarray, shape (Y,)
        s_y.
    """
    own = 1 if lit.polarisation == lit.mirror else -1
    sum_over_m = ((n_water**2 * lit.e * e - lit.h * h) * both_signs(e.shape[-1])).sum(axis=-1)
    density: Array = own * 2 / (np.pi * (n_water**2 - along**2)) * sum_over_m
    return density


def norm(pupil: Pupil, aperture: float, k: NDArray[np.float64], nodes: int) -> NDArray[np.float64]:
    """Return ∫ w² ρ dρ over the pupil at each wavenumber, (K,): a perfect mirror's, once."""
    sine, measure = _radial(aperture, nodes)
    return np.array([(_squared(pupil, sine, aperture, one) * measure).sum() for one in k.tolist()])


def plane_return(
    scene: CylinderOnPlane,
    pupil: Pupil,
    aperture: float,
    focus: float,
    k: NDArray[np.float64],
    nodes: int,
    wavefront: Wavefront | None = None,
) -> Array:
    r"""Return what the detector collects of the planes' own reflection, (K,).

    Through an aberration, whose odd part does nothing, of light across and along, (2, K).

    .. math:: \frac{\int w^2 \frac{r_s - r_p}{2} e^{-2 i k z_f \sqrt{n_1^2 - \rho^2}} \rho d\rho}
        {\int w^2 \rho d\rho}
    """
    sine, _ = _radial(aperture, nodes)
    below, above = normal(scene.n_glass, sine), normal(scene.n_water, sine)
    if scene.one_plane:
        r_s, r_p = fresnel(below, above, scene.n_glass, scene.n_water)
    else:
        r_s, r_p = from_glass(scene, np.square(sine) + 0j, k[:, np.newaxis])
    return returned_by(r_s, r_p, below, pupil, aperture, focus, k, nodes, wavefront)


def pupil_nodes(aperture: float, nodes: int) -> NDArray[np.float64]:
    """Return the values of ρ at which the integrals over the pupil need a reflection, (R,)."""
    return _radial(aperture, nodes)[0]


def returned_by(
    r_s: Array, r_p: Array, below: Array, pupil: Pupil, aperture: float, focus: float,
    k: NDArray[np.float64], nodes: int, wavefront: Wavefront | None = None,
) -> Array:  # fmt: skip
    """Return what the detector collects of a reflection that is known at `pupil_nodes`.

    Parameters
    ----------
    r_s, r_p, below : ndarray, shape (R,)
        Reflection of E and of H, (K, R) where it depends on k, and k_z over k in the glass, at
        `pupil_nodes`.
    pupil, aperture, k, nodes, wavefront
        As `plane_return` has them.
    focus : float
        Height of the focus over what reflects, µm.
    """
    sine, measure = _radial(aperture, nodes)
    travel = np.exp(-2j * focus * k[:, np.newaxis] * below)
    weight = np.stack([_squared(pupil, sine, aperture, one) for one in k.tolist()])
    lit = (weight * measure).sum(axis=1)

    def returned(reflection: Array) -> Array:
        whole: Array = (weight * (travel * (reflection * measure))).sum(axis=1) / lit
        return whole

    if wavefront is None:
        return returned((r_s - r_p) / 2)
    around = _around(r_s, r_p, sine / aperture, k, wavefront, nodes)
    return np.stack([returned(reflection) for reflection in around])


def _around(
    r_s: Array, r_p: Array, radius: Array, k: NDArray[np.float64], wavefront: Wavefront, nodes: int
) -> tuple[Array, Array]:
    """Return the mean around the pupil of the reflection of light across and along, (K, R) each.

    Light comes in by one point of the pupil and goes out by the opposite one.
    """
    angle = np.pi * (np.arange(nodes) + 0.5) / nodes
    px, py = radius[:, np.newaxis] * np.cos(angle), radius[:, np.newaxis] * np.sin(angle)
    path = wavefront(px, py) + wavefront(-px, py)
    turned = np.exp(1j * k[:, np.newaxis, np.newaxis] * path)
    s_part, p_part = (turned * np.sin(angle) ** 2).mean(-1), (turned * np.cos(angle) ** 2).mean(-1)
    return r_s * s_part - r_p * p_part, r_s * p_part - r_p * s_part


def _radial(aperture: float, nodes: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return ρ and ρ dρ, Gauss–Legendre in ρ²."""
    x, w = gauss_legendre(nodes)
    return aperture * np.sqrt((x + 1) / 2), w * aperture**2 / 4


def _squared(
    pupil: Pupil, sine: NDArray[np.float64], aperture: float, wavenumber: float
) -> NDArray[np.float64]:
    squared: NDArray[np.float64] = pupil.amplitude(sine, aperture, wavenumber) ** 2
    return squared
