"""What an objective does to rays on their way in and out, besides turning them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.light import Optics

Directions = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Unit directions of rays, their x and y components, (D,) each."""


class Passed(NamedTuple):
    """What D rays have of their two ways through the objective."""

    factor: NDArray[np.float64] | float
    """On the amplitude: of the apodisation, (D,)."""
    path: NDArray[np.float64] | float
    """On the optical path: of an aberration that does not turn rays, (D,), µm."""
    in_glass: NDArray[np.float64]
    """Length from the objective's plane to the focal plane, and back, (D,), µm."""


def passed(optics: Optics, index: float, into: Directions, out: Directions) -> Passed:
    """Return what rays have of their ways through an objective.

    Parameters
    ----------
    optics : Optics
    index : float
        Of the medium that the objective lies in.
    into, out : tuple of ndarray, shape (D,)
        Directions at launch, and of the rays that return.
    """
    effects = optics.effects
    cos_in, cos_out = (np.sqrt(np.maximum(1 - x * x - y * y, 0.0)) for x, y in (into, out))
    factor = np.sqrt(cos_in / cos_out) if effects.aplanatic else 1.0
    path: NDArray[np.float64] | float = 0.0
    if effects.aberration and not effects.turned:
        # light comes from the side of the pupil that is opposite to where it heads
        over = index / optics.numerical_aperture
        path = effects.aberration.wavefront(-over * into[0], -over * into[1])
        path = path + effects.aberration.wavefront(over * out[0], over * out[1])
    return Passed(factor, path, optics.detector.focus_distance * (1 / cos_in + 1 / cos_out))
