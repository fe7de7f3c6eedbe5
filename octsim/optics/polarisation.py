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
    if polarisation.input is None and polarisation.analyser is None:
        # of the four parts two are zero, and the other two alone have the mean
        return np.eye(2, dtype=np.complex128)
    detected, inputs = _detected(polarisation, azimuth), _inputs(polarisation, azimuth)
    return (detected[:, np.newaxis] * inputs).reshape(-1, 2)


def detected_fields(
    polarisation: Polarisation, jones: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    r"""Return what rays that any scene returns have in the detected intensity.

    With the Jones matrices J of the rays, the input's vectors e and the analyser's a (without one,
    both x and y)

    .. math:: I = \frac{1}{C} \sum_c \Big| \sum_d E_{cd} \Big|^2, \quad
              E_{cd} = a_c \cdot J_d e_c

    Parameters
    ----------
    polarisation : Polarisation
        Of the light that goes in, and of what is detected.
    jones : ndarray, shape (D, 2, 2)
        Detected x and y of light that went in along x and along y.

    Returns
    -------
    ndarray
        E, (C, D): a row for each part that adds to the intensity and not to the field.
    """
    inputs, detected = _inputs(polarisation, 0.0), _detected(polarisation, 0.0)
    fields: NDArray[np.complex128] = np.einsum("ao,doi,ei->aed", detected, jones, inputs)
    return fields.reshape(len(detected) * len(inputs), -1)


def _detected(polarisation: Polarisation, azimuth: float) -> NDArray[np.complex128]:
    """Return the factors of the detected fields across and along, a row for each part.

    Without an analyser both detected polarisations count: twice as many parts, of twice the mean.
    """
    if polarisation.analyser is None:
        return _axes(azimuth) * sqrt(2)
    return _in_frame(linear(polarisation.analyser), azimuth).conj()[np.newaxis]


def _inputs(polarisation: Polarisation, azimuth: float) -> NDArray[np.complex128]:
    """Return the Jones vectors across and along, (1, 2), or two orthogonal ones of both."""
    if polarisation.input is None:
        return _axes(azimuth)
    return _in_frame(polarisation.input, azimuth)[np.newaxis]


def _axes(azimuth: float) -> NDArray[np.complex128]:
    """Return x and y of the laboratory by their parts across and along a cylinder, (2, 2).

    With them, what light that is returned unchanged has in each row does not depend on the azimuth.
    """
    return np.stack([_in_frame(linear(0.0), azimuth), _in_frame((0j, complex(1)), azimuth)])


def _in_frame(jones: tuple[complex, complex], azimuth: float) -> NDArray[np.complex128]:
    """Return a vector of the laboratory by its parts across and along a cylinder, (2,)."""
    x, y = jones
    return np.array(
        [cos(azimuth) * x + sin(azimuth) * y, -sin(azimuth) * x + cos(azimuth) * y], np.complex128
    )
