"""How far tables of indices are from the polynomials that fields over a band are taken for."""

from functools import cache
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from octsim.optics.detector import Detector
from octsim.optics.materials import Material, Table
from octsim.optics.scene import Cylinder, Scene, Surface
from octsim.schemes.band_nodes import nodes_within, to_coefficients

_BETWEEN = 4
"""Places from one row to the next at which an index is looked at."""
_TO_AND_FRO = 4.0
"""Longest way of light that matters, over what is between the focus and the end of the scene."""


def phase_left_out(
    scene: Scene, detector: Detector, focus: float, first: float, last: float, number: int
) -> float:
    """Return by how much the phase of light, and its logarithm, are off a polynomial of a band.

    A table turns at its rows, maybe between nodes that are too far apart to see it. Formulas are as
    smooth as what nodes tell of the fields.

    Parameters
    ----------
    scene : Scene
    detector : Detector
        How far from the focus the objective is.
    focus : float
        Height of the focus, µm.
    first, last : float
        Ends of the band, 1/µm.
    number : int
        Nodes in it.
    """
    ways = _TO_AND_FRO * (abs(focus) + max(map(_height, scene.surfaces), default=0.0))
    from_objective = 2 * np.hypot(detector.focus_distance, detector.objective_radius)
    phase = 0.0
    for region in scene.regions:
        n, kappa = _off(region.material, first, last, number)
        # paths are referred to the focus, losses are along the whole way
        long = from_objective if region == scene.objective else ways
        phase += last * (n * ways + kappa * long)
    return phase


def _height(surface: Surface) -> float:
    """Return the height of a surface's highest point, µm."""
    if isinstance(surface, Cylinder):
        return surface.z + surface.radius
    return surface.height


@cache
def _off(material: Material, first: float, last: float, number: int) -> tuple[float, float]:
    """Return how far n and κ of a table are at most from polynomials through nodes of a band."""
    if not isinstance(material, Table):
        return 0.0, 0.0
    rows = [2 * np.pi / one for one in material.wavelength]
    ends = sorted({first, last, *(k for k in rows if first < k < last)})
    if len(ends) == 2:
        return 0.0, 0.0
    parts = [np.linspace(*pair, _BETWEEN, endpoint=False) for pair in pairwise(ends)]
    k = np.concatenate((*parts, [last]))
    at = nodes_within(first, last, number)
    indices = np.array([material.index(one) for one in (*at.tolist(), *k.tolist())])
    place = (2 * k - (first + last)) / (last - first)
    through = chebyshev.chebval(place, to_coefficients(number) @ indices[:number])
    off: NDArray[np.complex128] = indices[number:] - through
    return float(np.abs(off.real).max()), float(np.abs(off.imag).max())
