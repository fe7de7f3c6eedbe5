"""Polarisation: of the light that goes in, and of what is detected of the returned light."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin, sqrt

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Polarisation:
    r"""What light goes in, and what of the returned light is detected.

    Fields are :math:`e^{-i\omega t}`; angles are from x to y, rad, in the frame of the laboratory.
    """

    input: tuple[complex, complex] | None = None
    """Jones vector (x, y) of the light that goes in, of length 1; None is unpolarised."""
    analyser: float | None = None
    """Angle of a linear analyser for the returned light; without, all of it is detected."""


UNPOLARISED = Polarisation()
LEFT = (complex(1 / sqrt(2)), 1j / sqrt(2))
"""Jones vector of left circular light: of positive helicity (Hecht; IEEE calls it right)."""
RIGHT = (complex(1 / sqrt(2)), -1j / sqrt(2))
"""Jones vector of right circular light: of negative helicity."""


def linear(angle: float) -> tuple[complex, complex]:
    """Return the Jones vector of linear light at an angle from x to y, rad."""
    return complex(cos(angle)), complex(sin(angle))


def jones_rows(polarisation: Polarisation, azimuth: float) -> NDArray[np.complex128]:
    r"""Return what light polarised across and along a cylinder has in the detected intensity.

    A horizontal cylinder is its own mirror image in the plane across it, so light that is polarised
    across it, or along it, returns as such: the Jones matrix is diagonal in the cylinder's frame,
    with the fields :math:`D = (D_x, D_y)`. The intensity is then

    .. math:: I = \frac{1}{C} \sum_c \Big| \sum_p J_{cp} D_p \Big|^2

    Parameters
    ----------
    polarisation : Polarisation
        Of the light that goes in, and of what is detected.
    azimuth : float
        Angle from the y axis to the cylinder's axis, (−sin, cos), rad.

    Returns
    -------
    ndarray
        J, (C, 2): a row for each part that adds to the intensity and not to the field, with the
        factors of the fields across and along.
    """
    inputs = _inputs(polarisation, azimuth)
    if polarisation.analyser is None:
        if polarisation.input is None:
            return inputs
        # both detected polarisations count: twice as many parts, of twice the mean
        return np.diag(inputs[0] * sqrt(2))
    return inputs * _in_frame(linear(polarisation.analyser), azimuth).conj()


def _inputs(polarisation: Polarisation, azimuth: float) -> NDArray[np.complex128]:
    """Return the Jones vectors across and along, (1, 2), or two orthogonal ones of both."""
    if polarisation.input is None:
        return np.eye(2, dtype=np.complex128)
    return _in_frame(polarisation.input, azimuth)[np.newaxis]


def _in_frame(jones: tuple[complex, complex], azimuth: float) -> NDArray[np.complex128]:
    """Return a vector of the laboratory by its parts across and along a cylinder, (2,)."""
    x, y = jones
    return np.array(
        [cos(azimuth) * x + sin(azimuth) * y, -sin(azimuth) * x + cos(azimuth) * y], np.complex128
    )
