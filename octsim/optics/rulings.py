"""Rays as the rulings of a Gaussian beam's hyperboloids: a focus limited by diffraction.

Rays that all meet in a point have no waist. A Gaussian beam's intensity goes with hyperboloids of
one sheet, which straight lines rule: rays along these are as far apart as the light at each height.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def diffraction_waist(wavenumber: float, numerical_aperture: float) -> float:
    r"""Return the waist of the beam that fills an aperture, :math:`w_0 = \lambda / (\pi NA)`, µm.

    Parameters
    ----------
    wavenumber : float
        In vacuum, 1/µm.
    numerical_aperture : float
        Of the objective.
    """
    return 2 / (wavenumber * numerical_aperture)


def rayleigh_range(index: float, waist: float, wavenumber: float) -> float:
    r"""Return the distance over which a Gaussian beam widens by √2, µm.

    .. math:: z_R = \pi n w_0^2 / \lambda

    (Siegman, Lasers, ch. 17).

    Parameters
    ----------
    index : float
        Refractive index of the medium, n.
    waist : float
        Radius w₀ at the focus, at 1/e² of intensity, µm.
    wavenumber : float
        In vacuum, 1/µm.
    """
    return index * wavenumber * waist * waist / 2


def rulings(
    vx: NDArray[np.float64],
    vy: NDArray[np.float64],
    vz: NDArray[np.float64],
    rayleigh_range: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    r"""Return where rays cross the focal plane, as one family of rulings.

    .. math:: (x, y) = z_R \tan\theta \, \hat\varphi

    with :math:`\hat\varphi` the azimuthal unit vector at the ray's place on the objective, from +x
    to +y. The ray keeps its direction, and its path is zero where it crosses. At the height z over
    the focus it is :math:`\tan\theta \sqrt{z_R^2 + z^2}` from the axis, which is the beam's
    envelope :math:`w(z) = w_0 \sqrt{1 + (z / z_R)^2}` times :math:`z_R \tan\theta / w_0`. The
    other family crosses at (−x, −y). A beam needs both, each with half the weight: by itself, one
    is not its own mirror image.

    Parameters
    ----------
    vx, vy, vz : ndarray, shape (N,)
        Unit directions, upwards.
    rayleigh_range : float
        z_R, µm.

    Returns
    -------
    x, y : ndarray, shape (N,)
        From the axis, µm.
    """
    # the ray comes from the side opposite to (vx, vy): φ̂ sin θ is (vy, −vx), 0 on the axis
    over_cosine = rayleigh_range / vz
    return over_cosine * vy, -over_cosine * vx
