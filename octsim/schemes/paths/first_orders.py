"""How closely an aperture is looked at to begin with, and whether its light passes the cylinder."""

import math
from dataclasses import replace

import numpy as np

from octsim.optics.beam import Beam, aim
from octsim.optics.detector import Detector, acceptance
from octsim.optics.scene import Plane, Scene
from octsim.schemes.paths.check_rays import CHECKS
from octsim.schemes.paths.survey import COLUMNS
from octsim.schemes.paths.workspace import MOST_RAYS, Point
from octsim.tracing.faces import Faces, faces_at
from octsim.tracing.kernel import trace_amplitudes

STEEP = 0.92
"""Sine of the angle of light, from which on the aperture is surveyed closely."""


def light_misses(scene: Scene, faces: Faces, point: Point) -> bool:
    """Return whether the outermost light, to either side in x, meets planes alone."""
    flat = tuple(surface for surface in scene.surfaces if isinstance(surface, Plane))
    if len(flat) == len(scene.surfaces):
        return False
    detector = point.detector
    radius = np.array([-detector.objective_radius, detector.objective_radius])
    vx, vy, vz = aim(radius, np.zeros(2), detector.focus_distance)
    planes = faces_at(replace(scene, surfaces=flat), point.k_mid)
    for side in (1,) if point.symmetric else (0, 1):
        beam = Beam(vx[[side]], vy[[side]], vz[[side]], np.ones(1), np.zeros(1, np.int64))
        met = [
            trace_amplitudes(faces, beam, detector, acceptance(detector), point.focus, 3, 0.0)[2]
            for faces in (faces, planes)
        ]
        if met[0] == met[1]:
            return True
    return False


def steepest_sine(faces: Faces, detector: Detector) -> float:
    """Return the largest sine of light's angle with the axis; above 1 past the critical angle."""
    radius, distance = detector.objective_radius, detector.focus_distance
    least = float(min(faces.n_i.min(), faces.n_t.min()))
    return radius / math.hypot(radius, distance) * faces.n_objective / least


def orders_of(
    accuracy: float, symmetric: bool, steepest: float
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the numbers of nodes along each axis to begin with: of the survey and of a tile."""
    digits = -math.log10(accuracy)
    along_s = min(max(3, round(2 + digits)), 9)
    along_v = max(3, along_s - 2)
    if steepest > STEEP:
        # near grazing incidence light goes to and fro, and its way changes fast
        along_s, along_v = 12, (MOST_RAYS - CHECKS) // 12
    # where nothing says that patches are near x = 0, all of the aperture is looked at closely
    survey = (along_s if symmetric else min(COLUMNS, (MOST_RAYS - CHECKS) // along_v)), along_v
    return survey, (min(max(4, round(digits + 1)), 10), min(max(3, round(0.5 * digits + 1)), 8))
