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
from octsim.schemes.paths.workspace import Room, Survey, Task
from octsim.tracing.faces import Faces, is_flat
from octsim.tracing.follow import note_return
from octsim.tracing.lanes import LANES
from octsim.tracing.tree import trace_amplitudes

CLOSER_LOOKS = 6
COLUMNS = 24
"""Nodes along s where part of the aperture's light passes a cylinder by."""


@register_jitable
def recall(survey: Survey, number: int, task: Task, room: Room) -> None:
    """Fill a bundle with the rays of one path of the survey."""
    room.bundle.followed[: survey.orders[0] * survey.orders[1]] = False
    for i in range(survey.begin[number], survey.end[number]):
        ray = survey.ray[i]
        note_return(
            room.bundle, ray, task.detector, survey.x[i], survey.y[i], survey.vx[i], survey.vy[i]
        )
        room.bundle.amplitude[ray] = survey.amplitude[i]


@register_jitable
def survey_of(
    task: Task, root: Tile, n: int, m: int, max_intersections: int, min_amplitude: float,
    beyond: float, room: Room,
) -> tuple[Survey, float, int]:  # fmt: skip
    """Trace the whole tree from n x m nodes of a tile: paths, faint rays a node, segments."""
    aim_at_tile(task, root, n, m, LOOK, room.beam)
    beam = Beam(
        room.beam.vx[: n * m], room.beam.vy[: n * m], room.beam.vz[: n * m],
        room.beam.amplitude[: n * m], room.beam.number[: n * m],
    )  # fmt: skip
    # all that returns: rays beside the detector tell where between them a patch is
    labels, numbers, segments, outcomes = trace_amplitudes(
        task.faces, beam, task.detector, Acceptance(np.inf, np.inf), task.focus, max_intersections,
        min_amplitude,
    )  # fmt: skip
    codes = labels[1]
    # one block of rays, so the rays of a path stand together
    firsts = np.flatnonzero(np.append(True, codes[1:] != codes[:-1])[: codes.size])
    lasts = np.append(firsts[1:], codes.size)[: firsts.size]
    survey = Survey(
        root,
        (n, m),
        codes[firsts],
        firsts,
        lasts,
        beyond,
        np.zeros(firsts.size),
        np.zeros(firsts.size),
        labels[0],
        numbers[5],
        numbers[1],
        numbers[2],
        numbers[3],
        numbers[4],
    )
    every = Cells(0, n - 1, 0, m - 1)
    for p in range(firsts.size):
        recall(survey, p, task, room)
        survey.strongest[p] = followed_of(room, n * m)[1]
        survey.bound[p], _ = reached(
            room.bundle, n, m, task.nodes_s[LOOK, n], task.nodes_v[LOOK, m], root, every,
            task.symmetric, task.detector.radius, beyond,
        )  # fmt: skip
    return survey, outcomes[Outcome.FAINT] / (n * m), segments


@register_jitable
def only(survey: Survey, wanted: NDArray[np.bool_]) -> Survey:
    """Give some of a survey's paths."""
    return Survey(
        survey.root, survey.orders, survey.code[wanted], survey.begin[wanted],
        survey.end[wanted], survey.beyond, survey.bound[wanted], survey.strongest[wanted],
        survey.ray, survey.amplitude, survey.x, survey.y, survey.vx, survey.vy,
    )  # fmt: skip


@register_jitable
def curved(faces: Faces, code: int) -> bool:
    """Tell whether a path meets anything but planes."""
    rest = code
    while rest > 1:
        for f in range(faces.kind.size):
            if faces.surface[f] == rest % faces.kind.size // 2 and not is_flat(faces.kind[f]):
                return True
        rest //= faces.kind.size
    return False


@register_jitable
def closer(task: Task, survey: Survey) -> tuple[bool, Tile]:
    """Tell whether not all of a survey's columns met more than planes; give the part that did."""
    n, m = survey.orders
    root, along_s = survey.root, task.nodes_s[LOOK, n]
    left, right = n, -1
    for p in range(survey.code.size):
        if curved(task.faces, survey.code[p]):
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
def share_of_faint(survey: Survey, amplitude: float) -> float:
    """Give the largest share of its amplitude that a path fainter than this one may contribute."""
    share, some = 0.0, False
    for p in range(survey.code.size):
        if survey.strongest[p] < amplitude:
            share, some = max(share, survey.bound[p] / survey.strongest[p]), True
    return share if some else 1.0


@register_jitable
def survey_aperture(
    task: Task, orders: tuple[int, int], max_intersections: int, min_amplitude: float, room: Room
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
    root = Tile(0.0 if task.symmetric else -1.0, 1.0, 0.0, 1.0)
    wide, lost, segments = survey_of(
        task, root, n, m, max_intersections, min_amplitude, USUALLY, room
    )
    close = wide
    for _ in range(CLOSER_LOOKS):
        edge, tile = closer(task, close)
        much = area(tile, task.symmetric) > 0.8 * area(close.root, task.symmetric)
        if not edge or (much and close.beyond == NEAR_AN_EDGE):
            break
        # past the cylinder's edge: near it the light's way changes fast
        close, lost, traced = survey_of(
            task,
            tile,
            min(COLUMNS, LANES // m),
            m,
            max_intersections,
            min_amplitude,
            NEAR_AN_EDGE,
            room,
        )
        segments += traced
    narrowed = close.beyond == NEAR_AN_EDGE
    bends = np.array([curved(task.faces, code) for code in wide.code])
    keep = ~bends if narrowed else np.zeros(wide.code.size, np.bool_)
    also = np.array([curved(task.faces, code) or not narrowed for code in close.code])
    return only(wide, keep), only(close, also), lost, segments
