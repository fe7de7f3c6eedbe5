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
from octsim.optics.detector import Detector
from octsim.optics.scene import Plane, Scene
from octsim.schemes.light import AccuracyStatus, Light
from octsim.schemes.paths.aperture_tiles import Tile, images
from octsim.schemes.paths.chebyshev import HIGHEST, LOOK, tables
from octsim.schemes.paths.patch_integrals import rules
from octsim.schemes.paths.refine import SPARE, Allowed, Tally, Work, settle
from octsim.schemes.paths.survey import COLUMNS, recall, share_of_faint, survey_aperture
from octsim.schemes.paths.tile_nodes import aim_at_tile
from octsim.schemes.paths.waiting_tiles import promising
from octsim.schemes.paths.workspace import Found, Room, Survey, Task, room_for_nodes, room_for_point
from octsim.tracing.faces import faces_at
from octsim.tracing.follow import follow
from octsim.tracing.lanes import LANES
from octsim.tracing.light_paths import steps_of
from octsim.tracing.tree import arrivals, check_reach

BUDGET = 1_000_000
"""Segments traced for one point, at most."""
_ATTEMPTS = 4
_PEAK_SAMPLES = 32
_ONE_PATH = 0.1  # of the accuracy, that a single path may use
_MARGIN = 0.7  # of the accuracy, that the estimate of the error may reach


@register_jitable
def _mean_of(found: Found, first: int, end: int) -> tuple[float, float]:
    """Sum of the amplitudes of some nodes, and their mean optical path."""
    total, reach = 0.0, 0.0
    for i in range(first, end):
        total += found.amplitude[i]
        reach += found.amplitude[i] * found.optical_path_length[i]
    return total, (reach / total if total != 0 else 0.0)


@register_jitable
def _peak(
    size: NDArray[np.float64], reach: NDArray[np.float64], k_mid: float, k_max: float
) -> float:
    """Largest magnitude over the band of the sum of paths, each taken for a single ray."""
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
    task: Task, code: int, survey: Survey, number: int, allowed: Allowed, room: Room,
    found: Found, count: int,
) -> tuple[Found, Tally, int]:  # fmt: skip
    """Integrate one path over the aperture: nodes, what has become of it, segments traced."""
    meetings = steps_of(task.faces, code, room.face, room.through)
    agenda, top, segments = room.agenda, -1, 0
    tally = Tally(count, 0.0, 0.0, 0.0, 0.0)
    work = Work(survey.root, survey.orders[0], survey.orders[1], LOOK, 1.0, np.inf)
    recall(survey, number, task, room)
    while True:
        found, top, tally = settle(
            task, code, agenda, top, work, allowed, segments > allowed.budget, segments > 0, room,
            found, tally,
        )  # fmt: skip
        if top < 0:
            return found, tally, segments
        promising(agenda, top)
        row = agenda.tiles[top]
        work = Work(
            Tile(row[0], row[1], row[2], row[3]), agenda.orders[top, 0], agenda.orders[top, 1],
            agenda.kinds[top], agenda.shares[top], agenda.offs[top],
        )  # fmt: skip
        top -= 1
        aim_at_tile(task, work.tile, work.n, work.m, work.kind, room.beam)
        segments += follow(
            task.faces, room.face, room.through, meetings, room.beam, work.n * work.m,
            task.detector, task.focus, room.rays, room.bundle,
        )  # fmt: skip


@register_jitable
def _integrate_all(
    task: Task, wide: Survey, close: Survey, orders: tuple[int, int], relative: float,
    scale: float, budget: int, room: Room, found: Found,
) -> tuple[Found, Tally, int, float]:  # fmt: skip
    """Integrate the paths of two surveys, the strongest first, until the rest may be left out.

    Returns the nodes, what has become of all of them, the segments traced and the largest magnitude
    of the field over the band.
    """
    bounds = np.concatenate((wide.bound, close.bound))
    sizes, reach = np.zeros(bounds.size), np.zeros(bounds.size)
    order = np.argsort(-bounds, kind="mergesort")
    rest = np.append(np.cumsum(bounds[order][::-1])[::-1], 0.0)
    done, segments, all_paths = 0, 0, Tally(0, 0.0, 0.0, 0.0, 0.0)
    for p in order:
        known = max(scale, _peak(sizes, reach, task.k_mid, task.k_max), 0.03 * rest[0])
        if rest[done] <= SPARE * relative * known - all_paths.missing:
            break
        survey, number = (wide, p) if p < wide.code.size else (close, p - wide.code.size)
        allowed = Allowed(
            relative, known, all_paths.missing, survey.beyond, orders, (budget - segments) // 2
        )
        first = all_paths.nodes
        found, tally, traced = _integrate_path(
            task, survey.code[number], survey, number, allowed, room, found, first
        )
        sizes[p], reach[p] = _mean_of(found, first, tally.nodes)
        segments += traced
        all_paths = Tally(
            tally.nodes, all_paths.size + tally.size, max(all_paths.filled, tally.filled),
            all_paths.error + tally.error, all_paths.missing + tally.missing,
        )  # fmt: skip
        done += 1
    return (
        found,
        Tally(
            all_paths.nodes, all_paths.size, all_paths.filled, all_paths.error,
            all_paths.missing + rest[done],
        ),
        segments,
        _peak(sizes, reach, task.k_mid, task.k_max),
    )  # fmt: skip


@compiled()
def _integrate(
    task: Task, survey_orders: tuple[int, int], orders: tuple[int, int], max_intersections: int,
    accuracy: float, budget: int,
) -> tuple[Any, ...]:  # fmt: skip
    # a plain tuple, as in trace_tree
    room, found = room_for_point(), room_for_nodes(16 * HIGHEST * HIGHEST)
    accuracy = _MARGIN * accuracy
    faint, segments, scale, missing, count = 1e-3 * accuracy, 0, 0.0, 0.0, 0
    relative, status = _ONE_PATH * accuracy, AccuracyStatus.NOT_REACHED.value
    multiplicity = images(task.symmetric)
    for _ in range(_ATTEMPTS):
        wide, close, lost, traced = survey_aperture(
            task, survey_orders, max_intersections, faint, room
        )
        segments += traced
        found, tally, traced, scale = _integrate_all(
            task, wide, close, orders, relative, scale, budget - segments, room, found
        )
        segments += traced
        count = tally.nodes
        share = min(multiplicity * tally.filled, share_of_faint(close, 100 * faint))
        faint_field = 0.5 * lost * faint * share
        missing = tally.missing + faint_field
        if segments > 0.9 * budget:
            status = AccuracyStatus.BUDGET_SPENT.value
            break
        # |ΔI| = 2 |E| |ΔE|
        if 2 * (tally.error + missing) <= accuracy * scale or count == 0:
            status = AccuracyStatus.REACHED.value
            break
        if faint_field > 0.1 * accuracy * scale:
            faint *= 0.1
        else:
            relative *= 0.3
    return (
        found.path[:count].copy(), found.amplitude[:count].copy(), found.rough[:count].copy(),
        found.optical_path_length[:count].copy(), missing, segments, status,
    )  # fmt: skip


def light_misses(scene: Scene, detector: Detector, focus: float, wavenumber: float) -> bool:
    """Return whether the outermost light, to either side in x, meets planes alone."""
    flat = tuple(surface for surface in scene.surfaces if isinstance(surface, Plane))
    if len(flat) == len(scene.surfaces):
        return False
    radius = np.array([-detector.objective_radius, detector.objective_radius])
    vx, vy, vz = aim(radius, np.zeros(2), detector.focus_distance)
    planes = replace(scene, surfaces=flat)
    for side in (1,) if scene.symmetry.x else (0, 1):
        beam = Beam(vx[[side]], vy[[side]], vz[[side]], np.ones(1), np.zeros(1, np.int64))
        met = [
            arrivals(which, beam, detector, focus, 3, wavenumber=wavenumber).segments
            for which in (scene, planes)
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
    task = Task(
        faces_at(scene, middle), symmetric, detector, focus, middle, high,
        *tables(symmetric), *tables(True), rules(),
    )  # fmt: skip
    path, amplitude, rough_amplitude, optical_path_length, missing, segments, status = _integrate(
        task, *_orders(accuracy, symmetric), max_intersections, accuracy, budget
    )
    return Light(
        path,
        amplitude,
        rough_amplitude,
        optical_path_length,
        missing,
        segments,
        AccuracyStatus.AT_AN_EDGE
        if status == AccuracyStatus.REACHED and light_misses(scene, detector, focus, middle)
        else AccuracyStatus(status),
    )


def _orders(accuracy: float, symmetric: bool) -> tuple[tuple[int, int], tuple[int, int]]:
    """Give the number of nodes along each axis to begin with: of the survey and of a tile."""
    digits = -math.log10(accuracy)
    along_s = min(max(3, round(2 + digits)), 9)
    along_v = max(3, along_s - 2)
    # where nothing says that patches are near x = 0, all of the aperture is looked at closely
    survey = (along_s if symmetric else min(COLUMNS, LANES // along_v)), along_v
    return survey, (min(max(4, round(digits + 1)), 10), min(max(3, round(0.5 * digits + 1)), 8))
