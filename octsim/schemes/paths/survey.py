"""A few rays over the aperture, through the whole tree: which light paths there are, and where."""

from typing import Any

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.optics.beam import Beam
from octsim.optics.detector import Acceptance, Outcome
from octsim.optics.turned_rays import through_lens
from octsim.schemes.paths.aperture_tiles import Tile, area, between
from octsim.schemes.paths.chebyshev import LOOK
from octsim.schemes.paths.check_rays import CHECKS, place_of, weight_of
from octsim.schemes.paths.patch_by_corners import NEAR_AN_EDGE, USUALLY, Cells, reached
from octsim.schemes.paths.tile_nodes import aim_at, aim_at_tile, followed_of
from octsim.schemes.paths.workspace import MOST_RAYS, Point, Survey, Workspace
from octsim.tracing.faces import Faces, is_flat
from octsim.tracing.follow import note_return
from octsim.tracing.kernel import AT_VX, AT_VY, AT_X, AT_Y, FIRST_CARRIED, trace_amplitudes
from octsim.tracing.light_paths import steps_of

CLOSER_LOOKS = 6
COLUMNS = 24
"""Nodes along s where part of the aperture's light passes a cylinder by."""


@register_jitable
def recall(survey: Survey, number: int, point: Point, space: Workspace) -> None:
    """Fill a bundle with the rays of one path of the survey, and note its check rays."""
    bundle, checks, nodes = space.bundle, space.checks, survey.orders[0] * survey.orders[1]
    for i in range(nodes + CHECKS):
        bundle.followed[i] = False
    for i in range(survey.begin[number], survey.end[number]):
        ray = survey.ray[i]
        note_return(
            bundle, ray, point.detector, point.lens, survey.x[i], survey.y[i], survey.vx[i],
            survey.vy[i],
        )  # fmt: skip
        bundle.amplitude[ray] = survey.amplitude[i]
    checks.detected[0] = 0
    for i in range(CHECKS):
        ray = nodes + i
        checks.s[i], checks.v[i] = survey.check_s[i], survey.check_v[i]
        checks.weight[i] = 0.0
        if bundle.followed[ray]:
            checks.weight[i] = weight_of(
                bundle.x[ray], bundle.y[ray], bundle.cos[ray], bundle.inside[ray],
                point.detector.radius, point.falloff,
            )  # fmt: skip
            checks.amplitude[i] = bundle.amplitude[ray]
        if checks.weight[i] > 0:
            checks.detected[0] += 1


@register_jitable
def in_order(values: NDArray[Any], order: NDArray[np.int64]) -> NDArray[Any]:
    """Return some values in an order; to index by it takes numba longer to compile."""
    chosen = np.empty(order.size, values.dtype)
    for i in range(order.size):
        chosen[i] = values[order[i]]
    return chosen


@register_jitable
def by_path(codes: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return an order in which the rays of a path stand together, and where each path begins.

    Paths stand in the order in which the first ray of each does.
    """
    together = np.argsort(codes, kind="mergesort")  # which is stable
    begins = np.empty(codes.size + 1, np.int64)
    paths = 0
    for i in range(codes.size):
        if i == 0 or codes[together[i]] != codes[together[i - 1]]:
            begins[paths], paths = i, paths + 1
    begins[paths] = codes.size
    order, firsts = np.empty(codes.size, np.int64), np.empty(paths + 1, np.int64)
    count = 0
    for place, p in enumerate(np.argsort(in_order(together, begins[:paths]))):
        firsts[place] = count
        for i in range(begins[p], begins[p + 1]):
            order[count], count = together[i], count + 1
    firsts[paths] = count
    return order, firsts


@register_jitable
def survey_of(
    faces: Faces, point: Point, root: Tile, n: int, m: int, max_intersections: int,
    min_amplitude: float, extrapolation: float, space: Workspace,
) -> tuple[Survey, float, int]:  # fmt: skip
    """Trace the whole tree from n x m nodes of a tile: paths, faint rays a node, segments.

    Check rays go with them.
    """
    aim_at_tile(point, root, n, m, LOOK, space.beam)
    check_s, check_v = np.empty(CHECKS), np.empty(CHECKS)
    for i in range(CHECKS):
        check_s[i], check_v[i] = place_of(root, point.symmetric, i)
        aim_at(point, check_s[i], check_v[i], space.beam, n * m + i)
    count = n * m + CHECKS
    beam = Beam(
        space.beam.vx[:count], space.beam.vy[:count], space.beam.vz[:count],
        space.beam.amplitude[:count], space.beam.number[:count],
    )  # fmt: skip
    # all that returns: rays beside the detector tell where between them a patch is
    labels, numbers, segments, outcomes = trace_amplitudes(
        faces, through_lens(beam, point.lens), point.detector, Acceptance(np.inf, np.inf),
        point.focus,
        max_intersections, min_amplitude,
    )  # fmt: skip
    order, firsts = by_path(labels[1])
    paths = firsts.size - 1
    survey = Survey(
        root,
        (n, m),
        in_order(labels[1], order[firsts[:paths]]),
        firsts[:paths],
        firsts[1:],
        extrapolation,
        np.zeros(paths),
        np.zeros(paths),
        in_order(labels[0], order),
        in_order(numbers[FIRST_CARRIED], order),
        in_order(numbers[AT_X], order),
        in_order(numbers[AT_Y], order),
        in_order(numbers[AT_VX], order),
        in_order(numbers[AT_VY], order),
        check_s,
        check_v,
    )
    every = Cells(0, n - 1, 0, m - 1)
    for p in range(paths):
        recall(survey, p, point, space)
        survey.strongest[p] = followed_of(space, count)[1]
        survey.bound[p], _ = reached(
            space.bundle, n, m, point.tables.nodes_s[LOOK, n], point.tables.nodes_v[LOOK, m], root,
            every, point.symmetric, point.detector.radius, extrapolation, space.checks,
        )  # fmt: skip
    return survey, outcomes[Outcome.FAINT] / count, segments


@register_jitable
def only(survey: Survey, wanted: NDArray[np.bool_]) -> Survey:
    """Return some of a survey's paths."""
    return Survey(
        survey.root, survey.orders, survey.code[wanted], survey.begin[wanted],
        survey.end[wanted], survey.extrapolation, survey.bound[wanted], survey.strongest[wanted],
        survey.ray, survey.amplitude, survey.x, survey.y, survey.vx, survey.vy, survey.check_s,
        survey.check_v,
    )  # fmt: skip


@register_jitable
def curved(faces: Faces, code: int, space: Workspace) -> bool:
    """Return whether a path meets anything but planes."""
    for m in range(steps_of(faces, code, space.face, space.through)):
        if not is_flat(faces.kind[space.face[m]]):
            return True
    return False


@register_jitable
def closer(faces: Faces, point: Point, survey: Survey, space: Workspace) -> tuple[bool, Tile]:
    """Return whether not all of a survey's columns met more than planes, and the part that did."""
    n, m = survey.orders
    root, along_s = survey.root, point.tables.nodes_s[LOOK, n]
    left, right = n, -1
    for p in range(survey.code.size):
        if curved(faces, survey.code[p], space):
            for i in range(survey.begin[p], survey.end[p]):
                column = survey.ray[i] // m
                if column >= n:
                    continue
                # at the top of the aperture all columns are one place
                if root.v_max < 1 or survey.ray[i] % m < m - 1:
                    left, right = min(left, column), max(right, column)
    if right < 0:
        return False, root
    tile = between(root, n, m, along_s, along_s, max(left - 1, 0), min(right + 1, n - 1), 0, m - 1)
    return left > 0 or right < n - 1, tile


@register_jitable
def part_of_faint(survey: Survey, amplitude: float) -> float:
    """Return the largest part of its amplitude that a path fainter than this one may contribute."""
    part, some = 0.0, False
    for p in range(survey.code.size):
        if survey.strongest[p] < amplitude:
            part, some = max(part, survey.bound[p] / survey.strongest[p]), True
    return part if some else 1.0


@register_jitable
def survey_aperture(
    faces: Faces,
    point: Point,
    orders: tuple[int, int],
    max_intersections: int,
    min_amplitude: float,
    space: Workspace,
) -> tuple[Survey, Survey, float, int]:
    """Survey the aperture, and closer the part of it whose light meets more than planes.

    Returns
    -------
    wide, close : Survey
        Each path is in one of them: those of planes alone in the wide one, unless both are one.
    lost : float
        Rays too faint to follow, for each node.
    segments : int
        Traced.
    """
    n, m = orders
    root = Tile(0.0 if point.symmetric else -1.0, 1.0, 0.0, 1.0)
    wide, lost, segments = survey_of(
        faces, point, root, n, m, max_intersections, min_amplitude, USUALLY, space
    )
    close = wide
    for _ in range(CLOSER_LOOKS):
        edge, tile = closer(faces, point, close, space)
        much = area(tile, point.symmetric) > 0.8 * area(close.root, point.symmetric)
        if not edge or (much and close.extrapolation == NEAR_AN_EDGE):
            break
        # past the cylinder's edge: near it the light's way changes fast
        close, lost, traced = survey_of(
            faces,
            point,
            tile,
            min(COLUMNS, (MOST_RAYS - CHECKS) // m),
            m,
            max_intersections,
            min_amplitude,
            NEAR_AN_EDGE,
            space,
        )
        segments += traced
    narrowed = close.extrapolation == NEAR_AN_EDGE
    keep, also = np.empty(wide.code.size, np.bool_), np.empty(close.code.size, np.bool_)
    for p in range(wide.code.size):
        keep[p] = narrowed and not curved(faces, wide.code[p], space)
    for p in range(close.code.size):
        also[p] = not narrowed or curved(faces, close.code[p], space)
    return only(wide, keep), only(close, also), lost, segments
