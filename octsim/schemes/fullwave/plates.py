"""Plates without a cylinder: a stack of planes reflects each plane wave of the pupil by itself.

What returns is integrated over the pupil, as a plane's own light is.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.pupil import Pupil
from octsim.optics.scene import Scene
from octsim.schemes.cost import MOST_WAVENUMBERS
from octsim.schemes.field_sum import relative_error
from octsim.schemes.fullwave.detection import pupil_nodes, returned_by
from octsim.schemes.fullwave.illumination import Wavefront
from octsim.schemes.fullwave.orders import radial_nodes
from octsim.schemes.fullwave.plane import normal
from octsim.schemes.fullwave.series import coefficients, nodes
from octsim.schemes.fullwave.solve import left_out
from octsim.schemes.fullwave.stacks import through
from octsim.schemes.light import TERMS, AccuracyStatus, Waves

Array = NDArray[Any]
_FIRST, _MOST_RADII = 16, 4096
"""Wavenumbers in the band to begin with, and the most nodes over the pupil."""
_CHECKED = 3
"""Wavenumbers at which the integral over the pupil is compared with one of twice the nodes."""
_ROUNDING = 2e-14


class Stack(NamedTuple):
    """Planes one above the other, in numbers."""

    height: float
    """Of the lowest one, µm."""
    indices: tuple[complex, ...]
    """n + iκ below, between and above S planes, (S + 1,)."""
    thickness: tuple[float, ...]
    """From each plane to the next one, (S − 1,), µm."""

    @property
    def depth(self) -> float:
        """Optical path from the lowest plane to the highest one, µm."""
        inner = zip(self.indices[1:-1], self.thickness, strict=True)
        return sum(n.real * thickness for n, thickness in inner)


StackAt = Callable[[float], tuple[Stack, float]]
"""Returns the planes and the height of the focus (µm) at a wavenumber, 1/µm."""


def stack_of(scene: Scene, wavenumber: float) -> Stack:
    """Return a scene of planes in numbers, at a wavenumber, 1/µm; planes are from below."""
    heights = [surface.row[0] for surface in scene.surfaces]
    regions = (scene.objective, *(surface.sides[1] for surface in scene.surfaces))
    indices = tuple(
        region.material.index(wavenumber).real
        + 0.5j * region.attenuation_at(wavenumber) / wavenumber
        for region in regions
    )
    return Stack(heights[0], indices, tuple(b - a for a, b in pairwise(heights)))


def reflection_of(
    stack: Stack, sine: NDArray[np.float64], wavenumber: float
) -> tuple[Array, Array, Array]:
    """Return r_s, of E, and r_p, of H, of a stack, and k_z over k below it, (R,) each.

    Parameters
    ----------
    stack : Stack
    sine : ndarray, shape (R,)
        Component along the planes ρ over k.
    wavenumber : float
        1/µm.
    """
    found = through(stack.indices, stack.thickness, sine**2, np.array(wavenumber))
    return *found.reflected, normal(stack.indices[0], sine)


def solve_plates(
    stack_at: StackAt,
    pupil: Pupil,
    aperture: float,
    band: tuple[float, float],
    accuracy: float,
    wavefront: Wavefront | None = None,
) -> Waves:
    """Return the detected field of plates over a band, to an accuracy.

    The error is estimated from an integral of twice the nodes over the pupil, at three wavenumbers,
    and from the last Chebyshev coefficients over the wavenumber; what it is from is doubled until
    it is within the accuracy. Of the terms the first is the light of the lowest plane by itself.

    Parameters
    ----------
    stack_at : callable
        The planes and the height of the focus at a wavenumber.
    pupil, aperture
        What weighs the light over the pupil, and the numerical aperture.
    band : (float, float)
        Smallest and largest wavenumber, 1/µm.
    accuracy : float
        Largest error of the intensity over the largest intensity.
    wavefront : callable, optional
        Aberration of the pupil.
    """
    stack, focus = stack_at(sum(band) / 2)
    n_glass = stack.indices[0].real
    removed = 2 * n_glass * (stack.height - focus) + stack.depth

    def field_at(k: NDArray[np.float64], over_pupil: int) -> Array:
        each = [_field(*stack_at(at), pupil, aperture, at, over_pupil, wavefront)
                for at in k.tolist()]  # fmt: skip
        return np.stack(each, axis=-1)

    reach = abs(focus - stack.height) + sum(stack.thickness)
    radial, number, by_radius = radial_nodes(aperture, n_glass, reach, band[1]), _FIRST, np.inf
    while True:
        k = nodes(band, number)
        found = field_at(k, radial)
        if by_radius == np.inf:
            check = np.unique(np.linspace(0, number - 1, _CHECKED).round().astype(int))
            finer = field_at(k[check], 2 * radial)
            by_radius = 2 * float(np.abs(finer[0] - found[0][:, check]).max())
        slow = found * np.exp(-1j * k * removed)
        by_nodes = left_out(np.abs(coefficients(slow[0])))[0]
        error = by_radius + by_nodes
        largest = float(np.sqrt((np.abs(found[0]) ** 2).mean(axis=0).max()))
        reached = relative_error(largest, error) <= accuracy or error < _ROUNDING * largest
        over_pupil = by_radius > by_nodes
        spent = radial >= _MOST_RADII if over_pupil else number == MOST_WAVENUMBERS
        if reached or spent:
            break
        if over_pupil:
            radial, by_radius = 2 * radial, np.inf
        else:
            number = min(2 * number, MOST_WAVENUMBERS)
    status = AccuracyStatus.REACHED if reached else AccuracyStatus.BUDGET_SPENT
    terms = np.concatenate((slow[1:], np.zeros((len(TERMS) - 1, *slow[0].shape), np.complex128)))
    return Waves(k, slow[0], terms, removed, 0.0, error, 0, status)


def _field(
    stack: Stack, focus: float, pupil: Pupil, aperture: float, wavenumber: float, over_pupil: int,
    wavefront: Wavefront | None,
) -> Array:  # fmt: skip
    """Return the field of the stack, and of its lowest plane alone, across and along, (2, 2)."""
    sine, k = pupil_nodes(aperture, over_pupil), np.array([wavenumber])
    each = []
    for planes in (stack, stack._replace(indices=stack.indices[:2], thickness=())):
        returned = returned_by(
            *reflection_of(planes, sine, wavenumber), pupil, aperture, focus - stack.height, k,
            over_pupil, wavefront,
        )  # fmt: skip
        each.append(np.broadcast_to(returned, (2, 1))[:, 0])
    return np.stack(each)
