"""How closely an aperture is looked at to begin with, and how far the trees of its rays go."""

import math

import numpy as np

from octsim.optics.beam import Beam, aim
from octsim.optics.detector import Acceptance, Detector
from octsim.optics.scene import Cylinder, Scene
from octsim.schemes.paths.check_rays import CHECKS
from octsim.schemes.paths.survey import COLUMNS
from octsim.schemes.paths.workspace import MOST_RAYS, Point
from octsim.tracing.faces import AnyFaces, Faces
from octsim.tracing.kernel import trace_amplitudes

STEEP = 0.92
"""Sine of the angle of light, from which on the aperture is surveyed closely."""
_PILOTS = 8
_LARGEST = 0.15
"""Part of the budget that the trees of one survey may take."""
_BRIGHT, _FAINTER = 1e-4, 0.01


def steepest_sine(faces: Faces, detector: Detector) -> float:
    """Return the largest sine of light's angle with the axis; above 1 past the critical angle."""
    radius, distance = detector.objective_radius, detector.focus_distance
    own = faces.n_objective
    least = float(min(faces.n_i.min(initial=own), faces.n_t.min(initial=own)))
    return radius / math.hypot(radius, distance) * own / least


def in_shells(scene: Scene) -> bool:
    """Return whether a cylinder has more than one wall: ways that end at one of them are many."""
    axes = [(one.x, one.z) for one in scene.surfaces if isinstance(one, Cylinder)]
    return len(set(axes)) < len(axes)


def sees_edges(scene: Scene) -> bool:
    """Return whether light may take ways by the edges of cylinders anywhere on the aperture.

    It does beside neighbours, and by a cylinder that does not lie across the mirror plane.
    """
    cylinders = [one for one in scene.surfaces if isinstance(one, Cylinder)]
    axes = {(one.x, one.z) for one in cylinders}
    return len(axes) > 1 or not all(one.along_y for one in cylinders)


def orders_of(
    accuracy: float, symmetric: bool, steepest: float, scene: Scene
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the numbers of nodes along each axis to begin with: of the survey and of a tile."""
    digits = -math.log10(accuracy)
    along_s = min(max(3, round(2 + digits)), 9)
    along_v = max(3, along_s - 2)
    if in_shells(scene):
        along_s, along_v = max(along_s, 8), max(along_v, 5)
    if steepest > STEEP or sees_edges(scene):
        # near grazing incidence light goes to and fro, and its way changes fast
        along_s, along_v = 12, (MOST_RAYS - CHECKS) // 12
    # where nothing says that patches are near x = 0, all of the aperture is looked at closely
    survey = (along_s if symmetric else min(COLUMNS, (MOST_RAYS - CHECKS) // along_v)), along_v
    return survey, (min(max(4, round(digits + 1)), 10), min(max(3, round(0.5 * digits + 1)), 8))


def are_many(faces: Faces) -> bool:
    """Return whether a scene has many more light paths than the thesis's, or plates."""
    return isinstance(faces, AnyFaces)


def faintest(
    faces: Faces, point: Point, rays: int, max_intersections: int, least: float,
    budget: int,
) -> float:  # fmt: skip
    """Return the least amplitude to which the rays of a survey can be followed within a budget.

    The trees of general scenes grow without end as fainter light is followed: those of a few rays
    tell how far. The thesis's end by themselves.

    Parameters
    ----------
    faces : Faces
        Of the scene.
    point : Point
    rays : int
        In the survey.
    max_intersections : int
    least : float
        Amplitude below which no light matters.
    budget : int
        Segments for all of the point.
    """
    if not are_many(faces):
        return 0.0
    radius = point.detector.objective_radius * (np.arange(_PILOTS) + 0.5) / _PILOTS
    angle = np.arange(_PILOTS) * math.pi * (3 - math.sqrt(5))
    directions = aim(radius * np.cos(angle), radius * np.sin(angle), point.detector.focus_distance)
    beam = Beam(*directions, np.ones(_PILOTS), np.arange(_PILOTS))
    amplitude = max(_BRIGHT, least)
    while amplitude > least:
        fainter = max(_FAINTER * amplitude, least)
        segments = trace_amplitudes(
            faces, beam, point.detector, Acceptance(0.0, 0.0), point.focus, max_intersections,
            fainter,
        )[2]  # fmt: skip
        if segments * rays > _LARGEST * budget * _PILOTS:
            break
        amplitude = fainter
    return amplitude
