"""What the detector collects: which of the rays that arrive, with which weight and path.

Rays are followed without it, to where they would leave the focal plane. It *accepts* those within
two radii, and *weighs* what they carry by that place.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.optics.beam import Coordinate, aperture_radius
from octsim.optics.interface import Vector

# A ray sent back to the rim itself (a focus on the glass does that) is within it, however the last
# digit is rounded.
RIM = 1 + 1e-12


class Outcome(IntEnum):
    """How a traced segment ends, if it does not split at a surface; or why it was not traced."""

    DETECTED = 0
    """Reached the detector."""
    OFF_DETECTOR = 1
    """Came back through the objective, but beside the detector's image."""
    OFF_OBJECTIVE = 2
    """Came back into the glass, but past the objective's rim."""
    ESCAPED = 3
    """Left the scene: no surface ahead, and not on its way down through the glass."""
    SPENT = 4
    """Met a surface once more than `max_intersections`."""
    FAINT = 5
    """Not traced: below `min_amplitude`, or of no amplitude at all."""
    TOTALLY_REFLECTED = 6
    """Not traced: the transmitted ray of a total reflection, which does not exist."""


class Acceptance(NamedTuple):
    """Radii within which rays are accepted, µm; infinite ones accept every ray that returns."""

    objective_radius: float
    """At the objective."""
    radius: float
    """In the focal plane, of the detector's image."""


class Detector(NamedTuple):
    """The objective as a receiver and the fibre's image in the focal plane; lengths in µm."""

    objective_radius: float
    focus_distance: float
    radius: float
    """R_det, of the fibre core's image at the focus."""
    magnification: float
    focal_length: float
    """f = focus_distance · M / (M + 1)."""


def detector_radius(core_diameter: float, magnification: float) -> float:
    """Return the radius R_det of the fibre core's image at the focus, core / (2 M), in µm."""
    return core_diameter / (2 * magnification)


def fibre_detector(
    numerical_aperture: float,
    index: float,
    focus_distance: float,
    magnification: float,
    core_diameter: float,
) -> Detector:
    """Return an objective that images the focal plane onto a fibre's core (thesis §4.4).

    Parameters
    ----------
    numerical_aperture, index : float
        Of the objective, and of the medium that it lies in.
    focus_distance : float
        From the objective to the focus, µm.
    magnification : float
        From the object to the fibre.
    core_diameter : float
        Of the fibre, µm.
    """
    return Detector(
        objective_radius=aperture_radius(numerical_aperture, index, focus_distance),
        focus_distance=focus_distance,
        radius=detector_radius(core_diameter, magnification),
        magnification=magnification,
        focal_length=focus_distance * magnification / (magnification + 1),
    )


def acceptance(detector: Detector) -> Acceptance:
    """Return the radii within which a detector accepts rays."""
    return Acceptance(detector.objective_radius, detector.radius)


@register_jitable(forceinline=True)
def at_plane(height: float, position: Vector, direction: Vector) -> tuple[float, float]:
    """Trace a ray to a horizontal plane, onwards or back.

    Returns
    -------
    distance : float
        Distance along the ray, µm; negative if the plane lies behind.
    squared_radius : float
        Squared distance from the optical axis there, µm².
    """
    distance = (height - position.z) / direction.z
    x = position.x + distance * direction.x
    y = position.y + distance * direction.y
    return distance, x * x + y * y


@register_jitable(forceinline=True)
def fate(within: Acceptance, at_focus: float, at_objective: float) -> int:
    """Return whether a ray is accepted, from its squared radii (µm²) at focus and objective.

    By the lens's rule 3 (thesis §4.4) a ray that passes the objective reaches the fibre at the
    point whose image is where it would have left the focal plane.
    """
    if not at_objective <= (RIM * within.objective_radius) ** 2:
        return Outcome.OFF_OBJECTIVE
    if not at_focus < within.radius**2:
        return Outcome.OFF_DETECTOR
    return Outcome.DETECTED


@register_jitable(forceinline=True)
def falloff(squared: Coordinate, and_squared: float = 0.0) -> Coordinate:
    r"""Return the parabolic falloff of the detected amplitude, 1 − u² with u = ρ/R_det.

    (thesis §4.4). The square can be given in two parts, those of x and y: their sum, close to 1 at
    the edge of the detector, is then not rounded.
    """
    return 1 - squared - and_squared


def weight(
    detector: Detector, x: NDArray[np.float64], y: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the factors on the amplitudes of accepted rays (D,).

    Parameters
    ----------
    detector : Detector
        The receiver.
    x, y : ndarray, shape (D,)
        Where the rays would leave the focal plane, µm.
    """
    return falloff((x * x + y * y) / (detector.radius * detector.radius))


@register_jitable(forceinline=True)
def lens_correction(
    squared_radius: Coordinate, magnification: float, focal_length: float
) -> Coordinate:
    r"""Return the optical path from the focal point to the fibre, beyond that on the axis, in µm.

    .. math:: M (\sqrt{f^2 + \rho^2} - f) = M \rho^2 / (\sqrt{f^2 + \rho^2} + f)

    (thesis §4.4), in the form that does not cancel.
    """
    reach = np.sqrt(focal_length * focal_length + squared_radius) + focal_length
    correction: Coordinate = magnification * squared_radius / reach
    return correction


@register_jitable(forceinline=True)
def to_fibre(detector: Detector, n_objective: float, to_focus: float, at_focus: float) -> float:
    """Return the optical path that a returning ray has still to go to the fibre, µm.

    By the lens's rule 4 (thesis §4.4) that is the path to where it would have left the focal plane,
    negative when that lies behind it, and the lens's correction.

    Parameters
    ----------
    detector : Detector
        The receiver.
    n_objective : float
        Refractive index of the region that the objective lies in.
    to_focus, at_focus : float
        Distance to the focal plane (µm) and squared radius there (µm²), from `at_plane`.
    """
    correction = lens_correction(at_focus, detector.magnification, detector.focal_length)
    return n_objective * to_focus + correction


@register_jitable(forceinline=True)
def rim_margin(detector: Detector, x: float, y: float, vx: float, vy: float, cos: float) -> float:
    """Return cos² θ (1 − (radius at the objective / that of its rim)²) of a returning ray.

    It is positive for one that is accepted there, and smooth where θ comes near a right angle.

    Parameters
    ----------
    detector : Detector
        The receiver.
    x, y : float
        Where the ray leaves the focal plane, times cos θ, µm.
    vx, vy : float
        Its unit direction.
    cos : float
        Cosine of its angle θ with the optical axis.
    """
    at_x, at_y = x + detector.focus_distance * vx, y + detector.focus_distance * vy
    rim = RIM * detector.objective_radius
    return cos * cos - (at_x * at_x + at_y * at_y) / (rim * rim)
