"""Fields to a stated accuracy: each light path integrated over the patch where it is detected.

A few rays over the whole aperture, through the whole tree, tell which paths there are and where on
the aperture each may be detected (`survey`). There, on a tile, a path is followed from a few nodes;
what lies between them are polynomials (`tile_nodes`, `patch_integrals`). A tile that these do not
fit is refined (`refine`), until the whole is within the accuracy.
"""

from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.compiled import compiled
from octsim.optics.detector import Detector
from octsim.optics.scene import Scene, Symmetry
from octsim.optics.turned_rays import STRAIGHT, Straight, Turning
from octsim.schemes.light import AccuracyStatus, Light
from octsim.schemes.paths.aperture_tiles import images
from octsim.schemes.paths.chebyshev import LOOK
from octsim.schemes.paths.check_rays import CHECKS
from octsim.schemes.paths.falloffs import Parabola, Series
from octsim.schemes.paths.first_orders import (
    are_many,
    faintest,
    orders_of,
    sees_edges,
    steepest_sine,
)
from octsim.schemes.paths.kept_rays import WeightedRays, kept, room_for_nodes
from octsim.schemes.paths.missed_light import light_misses
from octsim.schemes.paths.peak import mean_of, peak
from octsim.schemes.paths.progress import SPARE, PathGoal, Progress, traced
from octsim.schemes.paths.refine import settle
from octsim.schemes.paths.strongest import strongest_first
from octsim.schemes.paths.survey import part_of_faint, recall, survey_aperture
from octsim.schemes.paths.tile_nodes import aim_at_tile
from octsim.schemes.paths.unseen_paths import unseen
from octsim.schemes.paths.waiting_tiles import OpenTile, pop_strongest
from octsim.schemes.paths.workspace import (
    Point,
    Survey,
    Workspace,
    room_for_point,
    tables_of,
)
from octsim.tracing.faces import Faces, faces_at
from octsim.tracing.follow import follow
from octsim.tracing.light_paths import steps_of
from octsim.tracing.tree import check_reach


class Integrated(NamedTuple):
    """The light of a point, and how it was found."""

    light: Light
    faces: Faces
    """Of the scene."""
    launched: tuple[NDArray[np.float64], ...]
    """Unit directions of the rays at launch, x and y components, and the amplitudes that they
    carry, without the weights of the integral, (D,) each; where asked for."""


PARABOLA = Parabola()
EVEN = Symmetry(x=True, y=True)
BUDGET = 1_000_000
"""Segments traced for one point, at most."""
_ATTEMPTS = 4
_FAINT, _FAINT_OF_MANY = 1e-3, 2e-4  # of the accuracy: amplitude from which light is followed
_FAINTER = 0.01  # than that, to which it may have to be
_ONE_PATH, _ONE_OF_MANY = 0.1, 0.06  # of the accuracy, that a single path may use
_MARGIN = 0.7  # of the accuracy, that the estimate of the error may reach


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
            point.detector, point.focus, point.lens, space.rays, space.bundle,
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
        known = max(scale, peak(sizes, reach, point.k_mid, point.k_max), 0.03 * rest[0])
        if rest[done] <= SPARE * relative * known - paths.missing:
            break
        survey, number = (wide, p) if p < wide.code.size else (close, p - wide.code.size)
        goal = PathGoal(
            survey.code[number], relative, known, paths.missing, survey.extrapolation, orders,
            (budget - paths.segments) // 2,
        )  # fmt: skip
        first = paths.nodes
        rays, path = _integrate_path(faces, point, goal, survey, number, space, rays, first)
        sizes[p], reach[p] = mean_of(rays, first, path.nodes)
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
        peak(sizes, reach, point.k_mid, point.k_max),
    )  # fmt: skip


@compiled()
def _integrate(
    faces: Faces, point: Point, survey_orders: tuple[int, int], orders: tuple[int, int],
    max_intersections: int, accuracy: float, relative: float, faint: float, least: float,
    budget: int, space: Workspace, rays: Any,
) -> tuple[Any, ...]:  # fmt: skip
    faint, segments, scale, missing, count = max(faint, least), 0, 0.0, 0.0, 0
    status = AccuracyStatus.NOT_REACHED.value
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
            if faint <= least:
                status = AccuracyStatus.BUDGET_SPENT.value
                break
            faint = max(0.1 * faint, least)
        else:
            relative *= 0.3
    return kept(rays, count), missing, segments, status, scale


def integrate_nodes(
    scene: Scene,
    detector: Detector,
    focus: float,
    band: tuple[float, float],
    accuracy: float,
    max_intersections: int = 11,
    budget: int = BUDGET,
    wavenumber: float | None = None,
    falloff: Parabola | Series = PARABOLA,
    lens: Straight | Turning = STRAIGHT,
    even: Symmetry = EVEN,
    placed: bool = False,
) -> Integrated:
    r"""Integrate the field of each light path over the aperture, to a stated accuracy.

    .. math:: E(k) = \sum_p \frac{1}{\pi R^2} \iint_{\mathrm{patch}_p} A_p(x, y)
              \left(1 - \frac{\rho_p^2}{R_{det}^2}\right) e^{ik\Lambda_p(x, y)}\, dx\, dy

    as a sum over weighted rays, that holds for every wavenumber of the band.

    Parameters
    ----------
    scene : Scene
        Surfaces, and the regions between them; its own mirror image in the plane y = 0.
    detector : Detector
        What receives the rays that return; its radius is that within which they are accepted.
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
    wavenumber : float, optional
        At which materials are taken, 1/µm; without one in the middle of the band.
    falloff : Parabola or Series
        Of the detected amplitude; the thesis's is the parabola.
    lens : Straight or Turning
        Whether an aberration turns rays, in and out.
    even : Symmetry
        Of what else the field is multiplied by.
    placed : bool
        Whether it is asked for where the rays come from.

    Returns
    -------
    Integrated
        Weighted rays, what was left out, and whether the accuracy is reached.

    Raises
    ------
    ValueError
        As `octsim.tracing.tree.check_reach` does, or if something lacks that symmetry.
    """
    check_reach(scene, detector, focus, max_intersections)
    max_intersections += scene.unseen_meetings
    symmetric, mirrored = scene.symmetry.x and even.x, scene.symmetry.y and even.y
    if not mirrored:
        raise ValueError("the scene is not symmetric in y, which scheme paths takes for granted")
    low, high = band
    middle = (low + high) / 2
    faces = faces_at(scene, middle if wavenumber is None else wavenumber)
    point = Point(symmetric, detector, focus, middle, high, falloff, lens, tables_of(symmetric))
    survey_orders, orders = orders_of(accuracy, symmetric, steepest_sine(faces, detector), scene)
    accuracy *= _MARGIN
    # of many paths each may have less of the error, and of more rays that are too faint each is
    one_path, faint = (_ONE_OF_MANY, _FAINT_OF_MANY) if are_many(faces) else (_ONE_PATH, _FAINT)
    faint *= accuracy
    least = faintest(
        faces, point, survey_orders[0] * survey_orders[1] + CHECKS, max_intersections,
        _FAINTER * faint, budget,
    )  # fmt: skip
    rays, missing, segments, status, size = _integrate(
        faces, point, survey_orders, orders, max_intersections, accuracy, one_path * accuracy,
        faint, least, budget, room_for_point(), room_for_nodes(placed),
    )  # fmt: skip
    if sees_edges(scene):
        # all of what is found in this way counts as error
        found, more = unseen(faces, point, np.unique(rays[0]), max_intersections, accuracy, least)
        segments += more
        rest = (*found[:2], np.zeros(found.path.size), *found[2:])
        rays = tuple(map(np.concatenate, zip(rays, rest[: len(rays)], strict=True)))
        largest = float(np.abs(found.amplitude).sum())
        # besides the integrals' own, which may be the margin
        allowed = (1 / _MARGIN - 1) * accuracy * size
        if status == AccuracyStatus.REACHED and 2 * largest > allowed:
            status = AccuracyStatus.NOT_REACHED.value
    path, amplitude, rough_amplitude, optical_path_length, *launched = rays
    light = Light(
        path,
        amplitude,
        rough_amplitude,
        optical_path_length,
        missing,
        segments,
        AccuracyStatus.AT_AN_EDGE
        if status == AccuracyStatus.REACHED and light_misses(faces, point)
        else AccuracyStatus(status),
    )
    return Integrated(light, faces, tuple(launched))


def integrate(
    scene: Scene,
    detector: Detector,
    focus: float,
    band: tuple[float, float],
    accuracy: float,
    max_intersections: int = 11,
    budget: int = BUDGET,
) -> Light:
    """Return the light of `integrate_nodes` alone, with the thesis's falloff.

    Arguments and exceptions as there.
    """
    return integrate_nodes(scene, detector, focus, band, accuracy, max_intersections, budget).light
