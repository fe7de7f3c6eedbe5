"""What the detector collects: which returning rays, with which weight and path."""

import math
from enum import IntEnum
from typing import NamedTuple

from numba.extending import register_jitable

from octsim.beam import aperture_radius
from octsim.config import Config
from octsim.optics import Vector

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
    """Not traced: below `min_amplitude`."""
    TOTALLY_REFLECTED = 6
    """Not traced: the transmitted ray of a total reflection, which does not exist."""


class Detector(NamedTuple):
    """The objective as a receiver and the fibre's image in the focal plane; lengths in µm."""

    objective_radius: float
    focus_distance: float
    radius: float
    """R_det, of the fibre core's image at the focus."""
    magnification: float
    focal_length: float
    """f = focus_distance · M / (M + 1)."""


def detector_radius(config: Config) -> float:
    """Radius R_det of the fibre core's image at the focus, core_diameter / (2 M), in µm."""
    return config.detector.core_diameter / (2 * config.objective.magnification)


def detector_of(config: Config) -> Detector:
    """Make the detector that a config describes."""
    objective = config.objective
    magnification = objective.magnification
    return Detector(
        objective_radius=aperture_radius(objective, config.scene.refractive_index.glass),
        focus_distance=objective.focus_distance,
        radius=detector_radius(config),
        magnification=magnification,
        focal_length=objective.focus_distance * magnification / (magnification + 1),
    )


@register_jitable
def falloff(radius: float, detector_radius: float) -> float:
    """Parabolic falloff of the detected amplitude, 1 − (ρ/R)² (thesis §4.4)."""
    ratio = radius / detector_radius
    return 1 - ratio * ratio


@register_jitable
def lens_correction(radius: float, magnification: float, focal_length: float) -> float:
    r"""Optical path from the focal point to the fibre, beyond that on the axis, in µm.

    .. math:: M (\sqrt{f^2 + \rho^2} - f) = M \rho^2 / (\sqrt{f^2 + \rho^2} + f)

    (thesis §4.4), in the form that does not cancel.
    """
    squared = radius * radius
    return magnification * squared / (math.sqrt(focal_length**2 + squared) + focal_length)


@register_jitable
def detect(
    detector: Detector, focus: float, n_glass: float, position: Vector, direction: Vector
) -> tuple[int, float, float]:
    """Trace a ray that goes down through the glass to the objective, and back to the focal plane.

    By the lens's rules 3 and 4 (thesis §4.4) a ray reaches the fibre at the point whose image is
    where it would have left the focal plane, with the path from there; path up to the focal plane
    is negative when that lies behind the ray.

    Parameters
    ----------
    detector : Detector
        The receiver.
    focus : float
        Height of the focal plane, µm.
    n_glass : float
        Refractive index below the scene.
    position, direction : Vector
        Point on the ray (µm) and its unit direction, downwards.

    Returns
    -------
    outcome : int
        `Outcome.DETECTED`, `OFF_DETECTOR` or `OFF_OBJECTIVE`.
    weight : float
        Factor on the amplitude.
    optical_path_length : float
        What is added to the ray's path, µm.
    """
    to_objective = (focus - detector.focus_distance - position.z) / direction.z
    x = position.x + to_objective * direction.x
    y = position.y + to_objective * direction.y
    if not x * x + y * y <= (RIM * detector.objective_radius) ** 2:
        return Outcome.OFF_OBJECTIVE, 0.0, 0.0
    to_focus = (focus - position.z) / direction.z
    x = position.x + to_focus * direction.x
    y = position.y + to_focus * direction.y
    radius = math.sqrt(x * x + y * y)
    if not radius < detector.radius:
        return Outcome.OFF_DETECTOR, 0.0, 0.0
    path = n_glass * to_focus + lens_correction(
        radius, detector.magnification, detector.focal_length
    )
    return Outcome.DETECTED, falloff(radius, detector.radius), path
