"""Fields to a stated accuracy: each light path integrated over the patch where it is detected.

A few rays over the whole aperture, through the whole tree, tell which paths there are and where on
the aperture each may be detected (`survey`). There, on a tile, a path is followed from a few nodes;
what lies between them are polynomials (`tile_nodes`, `patch_integrals`). A tile that these do not
fit is refined (`refine`), until the whole is within the accuracy.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.compiled import compiled
from octsim.optics.beam import Beam, aim
from octsim.optics.detector import Detector, acceptance
from octsim.optics.scene import Plane, Scene
from octsim.schemes.light import AccuracyStatus, Light
from octsim.schemes.paths.aperture_tiles import images
from octsim.schemes.paths.chebyshev import HIGHEST, LOOK
from octsim.schemes.paths.check_rays import CHECKS
from octsim.schemes.paths.progress import SPARE, PathGoal, Progress, traced
from octsim.schemes.paths.refine import settle
from octsim.schemes.paths.strongest import strongest_first
from octsim.schemes.paths.survey import COLUMNS, part_of_faint, recall, survey_aperture
from octsim.schemes.paths.tile_nodes import aim_at_tile
from octsim.schemes.paths.waiting_tiles import OpenTile, pop_strongest
from octsim.schemes.paths.workspace import (
    MOST_RAYS,
    Point,
    Survey,
    WeightedRays,
    Workspace,
    room_for_nodes,
    room_for_point,
    tables_of,
)
from octsim.tracing.faces import Faces, faces_at
from octsim.tracing.follow import follow
from octsim.tracing.kernel import trace_amplitudes
from octsim.tracing.light_paths import steps_of
from octsim.tracing.tree import check_reach

BUDGET = 1_000_000
"""Segments traced for one point, at most."""
STEEP = 0.92
"""Sine of the angle of light, from which on the aperture is surveyed closely."""
_ATTEMPTS = 4
_PEAK_SAMPLES = 32
_ONE_PATH = 0.1  # of the accuracy, that a single path may use
_MARGIN = 0.7  # of the accuracy, that the estimate of the error may reach


@register_jitable
def _mean_of(rays: WeightedRays, first: int, end: int) -> tuple[float, float]:
    """Return the sum of the amplitudes of some rays, and their mean optical path."""
    total, reach = 0.0, 0.0
    for i in range(first, end):
        total += rays.amplitude[i]
        reach += rays.amplitude[i] * rays.optical_path_length[i]
    return total, (reach / total if total != 0 else 0.0)


@register_jitable
def _peak(
    size: NDArray[np.float64], reach: NDArray[np.float64], k_mid: float, k_max: float
) -> float:
    """Return the largest magnitude over the band of a sum of paths, each as one ray."""
    largest = 0.0
    for i in range(_PEAK_SAMPLES):
        k = k_mid + (k_max - k_mid) * (2 * i / (_PEAK_SAMPLES - 1) - 1)
        real, imaginary = 0.0, 0.0
        for p in range(size.size):
            real += size[p] * math.cos(k * reach[p])
            imaginary += size[p] * math.sin(k * reach[p])
        largest = max(largest, math.hypot(real, imaginary))
    return largest


@register_jitable
def _integrate_path(
    faces: Faces, point: Point, goal: PathGoal, survey: Survey, number: int, space: Workspace,
    rays: WeightedRays, count: int,
) -> tuple[WeightedRays, Progress]:  # fmt: skip
    """Integrate one path of a survey over the aperture; `count` rays are there already."""
    meetings = steps_of(faces, goal.code, space.face, space.through)
    space.waiting.num[0] = 0
    progress = Progress(count, 0.0, 0.0, 0.0, 0.0, 0)
    n, m = survey.orders
    work = OpenTile(survey.root, n, m, LOOK, 1.0, survey.bound[number], np.inf)
    recall(survey, number, point, space)
    while True:
        rays, progress = settle(point, goal, work, space, rays, progress)
        if space.waiting.num[0] == 0:
            return rays, progress
        work = pop_strongest(space.waiting)
        aim_at_tile(point, work.tile, work.n, work.m, work.kind, space.beam)
        segments = follow(
            faces, space.face, space.through, meetings, space.beam, work.n * work.m,
            point.detector, point.focus, space.rays, space.bundle,
        )  # fmt: skip
        progress = traced(progress, segments)


@register_jitable
def _integrate_all(
    faces: Faces, point: Point, wide: Survey, close: Survey, orders: tuple[int, int],
    relative: float, scale: float, budget: int, space: Workspace, rays: WeightedRays,
) -> tuple[WeightedRays, Progress, float]:  # fmt: skip
    """Integrate the paths of two surveys, the strongest first, until the rest may be left out.

    Returns the rays, what has become of all of them, and the largest magnitude of the field over
    the band.
    """
    order, rest = strongest_first(wide.bound, close.bound)
    sizes, reach = np.zeros(order.size), np.zeros(order.size)
    done, paths = 0, Progress(0, 0.0, 0.0, 0.0, 0.0, 0)
    for p in order:
        known = max(scale, _peak(sizes, reach, point.k_mid, point.k_max), 0.03 * rest[0])
        if rest[done] <= SPARE * relative * known - paths.missing:
            break
        survey, number = (wide, p) if p < wide.code.size else (close, p - wide.code.size)
        goal = PathGoal(
            survey.code[number], relative, known, paths.missing, survey.extrapolation, orders,
            (budget - paths.segments) // 2,
        )  # fmt: skip
        first = paths.nodes
        rays, path = _integrate_path(faces, point, goal, survey, number, space, rays, first)
        sizes[p], reach[p] = _mean_of(rays, first, path.nodes)
        paths = Progress(
            path.nodes, paths.size + path.size, max(paths.filled, path.filled),
            paths.error + path.error, paths.missing + path.missing,
            paths.segments + path.segments,
        )  # fmt: skip
        done += 1
    return (
        rays,
        Progress(
            paths.nodes, paths.size, paths.filled, paths.error, paths.missing + rest[done],
            paths.segments,
        ),
        _peak(sizes, reach, point.k_mid, point.k_max),
    )  # fmt: skip


@compiled()
def _integrate(
    faces: Faces, point: Point, survey_orders: tuple[int, int], orders: tuple[int, int],
    max_intersections: int, accuracy: float, budget: int, space: Workspace,
) -> tuple[Any, ...]:  # fmt: skip
    # a plain tuple, as in trace_tree
    rays = room_for_nodes(16 * HIGHEST * HIGHEST)
    accuracy = _MARGIN * accuracy
    faint, segments, scale, missing, count = 1e-3 * accuracy, 0, 0.0, 0.0, 0
    relative, status = _ONE_PATH * accuracy, AccuracyStatus.NOT_REACHED.value
    multiplicity = images(point.symmetric)
    for _ in range(_ATTEMPTS):
        wide, close, lost, surveyed = survey_aperture(
            faces, point, survey_orders, max_intersections, faint, space
        )
        segments += surveyed
        rays, paths, scale = _integrate_all(
            faces, point, wide, close, orders, relative, scale, budget - segments, space, rays
        )
        segments += paths.segments
        count = paths.nodes
        seen = min(multiplicity * paths.filled, part_of_faint(close, 100 * faint))
        faint_field = 0.5 * lost * faint * seen
        missing = paths.missing + faint_field
        if segments > 0.9 * budget:
            status = AccuracyStatus.BUDGET_SPENT.value
            break
        # |ΔI| = 2 |E| |ΔE|
        if 2 * (paths.error + missing) <= accuracy * scale or count == 0:
            status = AccuracyStatus.REACHED.value
            break
        if faint_field > 0.1 * accuracy * scale:
            faint *= 0.1
        else:
            relative *= 0.3
    return (
        rays.path[:count].copy(), rays.amplitude[:count].copy(),
        rays.rough_amplitude[:count].copy(), rays.optical_path_length[:count].copy(), missing,
        segments, status,
    )  # fmt: skip


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


def integrate(
    scene: Scene,
    detector: Detector,
    focus: float,
    band: tuple[float, float],
    accuracy: float,
    max_intersections: int = 11,
    budget: int = BUDGET,
) -> Light:
    r"""Integrate the field of each light path over the aperture, to a stated accuracy.

    .. math:: E(k) = \sum_p \frac{1}{\pi R^2} \iint_{\mathrm{patch}_p} A_p(x, y)
              \left(1 - \frac{\rho_p^2}{R_{det}^2}\right) e^{ik\Lambda_p(x, y)}\, dx\, dy

    as a sum over weighted rays, that holds for every wavenumber of the band.

    Parameters
    ----------
    scene : Scene
        Surfaces, and the regions between them; its own mirror image in the plane y = 0. Materials
        are taken at the middle of the band.
    detector : Detector
        What receives the rays that return.
    focus : float
        Height of the focus above z = 0 as if all were glass, µm; below the focus distance.
    band : tuple of float
        Smallest and largest wavenumber, 1/µm.
    accuracy : float
        Error that is allowed of the intensity: max |ΔI| / max I over the band.
    max_intersections : int
        Surfaces that one ray may meet.
    budget : int
        Segments that may be traced; where they do not suffice the status says so.

    Returns
    -------
    Light
        Weighted rays, what was left out, and whether the accuracy is reached.

    Raises
    ------
    ValueError
        As `octsim.tracing.tree.check_reach` does, or if the scene lacks that symmetry.
    """
    check_reach(scene, detector, focus, max_intersections)
    symmetric, mirrored = scene.symmetry
    if not mirrored:
        raise ValueError("the scene is not symmetric in y, which scheme paths takes for granted")
    low, high = band
    middle = (low + high) / 2
    faces = faces_at(scene, middle)
    point = Point(symmetric, detector, focus, middle, high, tables_of(symmetric))
    path, amplitude, rough_amplitude, optical_path_length, missing, segments, status = _integrate(
        faces, point, *_orders(accuracy, symmetric, steepest_sine(faces, detector)),
        max_intersections, accuracy, budget, room_for_point(),
    )  # fmt: skip
    return Light(
        path,
        amplitude,
        rough_amplitude,
        optical_path_length,
        missing,
        segments,
        AccuracyStatus.AT_AN_EDGE
        if status == AccuracyStatus.REACHED and light_misses(scene, faces, point)
        else AccuracyStatus(status),
    )


def steepest_sine(faces: Faces, detector: Detector) -> float:
    """Return the largest sine of light's angle with the axis; above 1 past the critical angle."""
    radius, distance = detector.objective_radius, detector.focus_distance
    least = float(min(faces.n_i.min(), faces.n_t.min()))
    return radius / math.hypot(radius, distance) * faces.n_objective / least


def _orders(
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
