"""A few rays over the aperture, through the whole tree: which light paths there are, and where."""

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.optics.beam import Beam
from octsim.optics.detector import Acceptance, Outcome
from octsim.schemes.paths.aperture_tiles import Tile, area, between
from octsim.schemes.paths.chebyshev import LOOK
from octsim.schemes.paths.patch_by_corners import NEAR_AN_EDGE, USUALLY, Cells, reached
from octsim.schemes.paths.tile_nodes import aim_at_tile, followed_of
from octsim.schemes.paths.workspace import Point, Survey, Workspace
from octsim.tracing.faces import Faces, is_flat
from octsim.tracing.follow import note_return
from octsim.tracing.kernel import AT_VX, AT_VY, AT_X, AT_Y, FIRST_CARRIED, trace_amplitudes
from octsim.tracing.lanes import LANES

CLOSER_LOOKS = 6
COLUMNS = 24
"""Nodes along s where part of the aperture's light passes a cylinder by."""


@register_jitable
def recall(survey: Survey, number: int, point: Point, space: Workspace) -> None:
    """Fill a bundle with the rays of one path of the survey."""
    space.bundle.followed[: survey.orders[0] * survey.orders[1]] = False
    for i in range(survey.begin[number], survey.end[number]):
        ray = survey.ray[i]
        note_return(
            space.bundle, ray, point.detector, survey.x[i], survey.y[i], survey.vx[i], survey.vy[i]
        )
        space.bundle.amplitude[ray] = survey.amplitude[i]


@register_jitable
def survey_of(
    faces: Faces, point: Point, root: Tile, n: int, m: int, max_intersections: int,
    min_amplitude: float, extrapolation: float, space: Workspace,
) -> tuple[Survey, float, int]:  # fmt: skip
    """Trace the whole tree from n x m nodes of a tile: paths, faint rays a node, segments."""
    aim_at_tile(point, root, n, m, LOOK, space.beam)
    beam = Beam(
        space.beam.vx[: n * m], space.beam.vy[: n * m], space.beam.vz[: n * m],
        space.beam.amplitude[: n * m], space.beam.number[: n * m],
    )  # fmt: skip
    # all that returns: rays beside the detector tell where between them a patch is
    labels, numbers, segments, outcomes = trace_amplitudes(
        faces, beam, point.detector, Acceptance(np.inf, np.inf), point.focus,
        max_intersections, min_amplitude,
    )  # fmt: skip
    codes, paths = labels[1], 0
    # one block of rays, so the rays of a path stand together
    firsts, lasts = np.empty(codes.size, np.int64), np.empty(codes.size, np.int64)
    for i in range(codes.size):
        if i == 0 or codes[i] != codes[i - 1]:
            firsts[paths] = i
            paths += 1
        lasts[paths - 1] = i + 1
    firsts, lasts = firsts[:paths], lasts[:paths]
    survey = Survey(
        root,
        (n, m),
        codes[firsts],
        firsts,
        lasts,
        extrapolation,
        np.zeros(firsts.size),
        np.zeros(firsts.size),
        labels[0],
        numbers[FIRST_CARRIED],
        numbers[AT_X],
        numbers[AT_Y],
        numbers[AT_VX],
        numbers[AT_VY],
    )
    every = Cells(0, n - 1, 0, m - 1)
    for p in range(firsts.size):
        recall(survey, p, point, space)
        survey.strongest[p] = followed_of(space, n * m)[1]
        survey.bound[p], _ = reached(
            space.bundle, n, m, point.tables.nodes_s[LOOK, n], point.tables.nodes_v[LOOK, m], root,
            every, point.symmetric, point.detector.radius, extrapolation,
        )  # fmt: skip
    return survey, outcomes[Outcome.FAINT] / (n * m), segments


@register_jitable
def only(survey: Survey, wanted: NDArray[np.bool_]) -> Survey:
    """Return some of a survey's paths."""
    return Survey(
        survey.root, survey.orders, survey.code[wanted], survey.begin[wanted],
        survey.end[wanted], survey.extrapolation, survey.bound[wanted], survey.strongest[wanted],
        survey.ray, survey.amplitude, survey.x, survey.y, survey.vx, survey.vy,
    )  # fmt: skip


@register_jitable
def curved(faces: Faces, code: int) -> bool:
    """Return whether a path meets anything but planes."""
    rest = code
    while rest > 1:
        for f in range(faces.kind.size):
            if faces.surface[f] == rest % faces.kind.size // 2 and not is_flat(faces.kind[f]):
                return True
        rest //= faces.kind.size
    return False


@register_jitable
def closer(faces: Faces, point: Point, survey: Survey) -> tuple[bool, Tile]:
    """Return whether not all of a survey's columns met more than planes, and the part that did."""
    n, m = survey.orders
    root, along_s = survey.root, point.tables.nodes_s[LOOK, n]
    left, right = n, -1
    for p in range(survey.code.size):
        if curved(faces, survey.code[p]):
            for i in range(survey.begin[p], survey.end[p]):
                column = survey.ray[i] // m
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
        edge, tile = closer(faces, point, close)
        much = area(tile, point.symmetric) > 0.8 * area(close.root, point.symmetric)
        if not edge or (much and close.extrapolation == NEAR_AN_EDGE):
            break
        # past the cylinder's edge: near it the light's way changes fast
        close, lost, traced = survey_of(
            faces,
            point,
            tile,
            min(COLUMNS, LANES // m),
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
        keep[p] = narrowed and not curved(faces, wide.code[p])
    for p in range(close.code.size):
        also[p] = not narrowed or curved(faces, close.code[p])
    return only(wide, keep), only(close, also), lost, segments
