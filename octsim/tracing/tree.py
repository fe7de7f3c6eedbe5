"""The ray tree: every ray splits at every surface it meets, until it is detected or gone.

Rays that are neighbours in the aperture go through the tree together, as a block of lanes, along
one light path after the other, depth first.
"""

from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.base.compiled import compiled
from octsim.optics.beam import Beam
from octsim.optics.detector import Detector, Outcome, arrival, collect, fate
from octsim.optics.scene import Scene
from octsim.tracing.blocks import (
    AMPLITUDE,
    BLOCK,
    LANES,
    PATH,
    RAY,
    VX,
    VY,
    Block,
    Lanes,
    X,
    Y,
    advance_chosen,
    choose,
    direction,
    launch,
    meet_nearest,
    position,
    sift,
    split,
)
from octsim.tracing.faces import Faces, faces_of

OUTCOMES = len(Outcome)


class Detections(NamedTuple):
    """Rays that reached the detector, D of them, always in the same order."""

    ray: NDArray[np.int64]
    """Number of the launched ray that each comes from, (D,)."""
    path: NDArray[np.int64]
    """Code of the light path, (D,); `path_name` reads it."""
    amplitude: NDArray[np.float64]
    """Amplitude, weighted by the detector, (D,)."""
    optical_path_length: NDArray[np.float64]
    """Path from the focus to the fibre, beyond that of an axial ray through the lens, (D,), µm."""
    x: NDArray[np.float64]
    """Where it leaves the focal plane, (D,), µm."""
    y: NDArray[np.float64]
    """The same, along the cylinder, (D,), µm."""
    vx: NDArray[np.float64]
    """Unit direction there, x component, (D,); it heads down."""
    vy: NDArray[np.float64]
    """The same, y component, (D,)."""
    segments: int
    """Straight pieces of ray that were traced."""
    outcomes: NDArray[np.int64]
    """How often each `Outcome` came about, (7,)."""


class _Found(NamedTuple):
    """Room for detected rays."""

    ray: NDArray[np.int64]
    path: NDArray[np.int64]
    amplitude: NDArray[np.float64]
    optical_path_length: NDArray[np.float64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    vx: NDArray[np.float64]
    vy: NDArray[np.float64]


class _Waiting(NamedTuple):
    """Blocks that are still to be traced, the next one last."""

    blocks: NDArray[np.float64]
    lanes: NDArray[np.int64]
    departure: NDArray[np.int64]
    meetings: NDArray[np.int64]
    path: NDArray[np.int64]


@register_jitable(forceinline=True)
def _room_for_found(size: int) -> _Found:
    return _Found(
        np.empty(size, np.int64), np.empty(size, np.int64), np.empty(size), np.empty(size),
        np.empty(size), np.empty(size), np.empty(size), np.empty(size),
    )  # fmt: skip


@register_jitable(forceinline=True)
def _doubled(found: _Found) -> _Found:
    return _Found(
        np.concatenate((found.ray, np.empty_like(found.ray))),
        np.concatenate((found.path, np.empty_like(found.path))),
        np.concatenate((found.amplitude, np.empty_like(found.amplitude))),
        np.concatenate((found.optical_path_length, np.empty_like(found.optical_path_length))),
        np.concatenate((found.x, np.empty_like(found.x))),
        np.concatenate((found.y, np.empty_like(found.y))),
        np.concatenate((found.vx, np.empty_like(found.vx))),
        np.concatenate((found.vy, np.empty_like(found.vy))),
    )


@register_jitable(forceinline=True)
def _room_for_waiting(size: int) -> _Waiting:
    return _Waiting(
        np.empty((size, BLOCK)), np.empty(size, np.int64), np.empty(size, np.int64),
        np.empty(size, np.int64), np.empty(size, np.int64),
    )  # fmt: skip


@register_jitable(forceinline=True)
def _wait(waiting: _Waiting, top: int, lanes: int, departure: int, meetings: int, path: int) -> int:
    """Have the block above `top` wait, as the next; give the new top."""
    waiting.lanes[top + 1] = lanes
    waiting.departure[top + 1] = departure
    waiting.meetings[top + 1] = meetings
    waiting.path[top + 1] = path
    return top + 1


@register_jitable(forceinline=True)
def _detect(
    detector: Detector,
    focus: float,
    n_glass: float,
    beam: Beam,
    block: Block,
    n: int,
    code: int,
    found: _Found,
    detected: int,
    outcomes: NDArray[np.int64],
    to_focus: Lanes,
    at_focus: Lanes,
    at_objective: Lanes,
) -> tuple[_Found, int]:
    """Note which of n lanes on their way to the objective are detected.

    The last three are room to work in.
    """
    for i in range(n):
        here, along = position(block, i), direction(block, i)
        to_focus[i], at_focus[i] = arrival(focus, here, along)
        _, at_objective[i] = arrival(focus - detector.focus_distance, here, along)
    for i in range(n):
        outcome = fate(detector, at_focus[i], at_objective[i])
        outcomes[outcome] += 1
        if outcome == Outcome.DETECTED:
            if detected == found.ray.size:
                found = _doubled(found)
            weight, to_fibre = collect(detector, n_glass, to_focus[i], at_focus[i])
            ray = int(block[RAY + i])
            found.ray[detected] = beam.number[ray]
            found.path[detected] = code
            found.amplitude[detected] = beam.amplitude[ray] * block[AMPLITUDE + i] * weight
            found.optical_path_length[detected] = block[PATH + i] + to_fibre
            found.x[detected] = block[X + i] + to_focus[i] * block[VX + i]
            found.y[detected] = block[Y + i] + to_focus[i] * block[VY + i]
            found.vx[detected], found.vy[detected] = block[VX + i], block[VY + i]
            detected += 1
    return found, detected


@compiled()
def trace_tree(
    faces: Faces,
    beam: Beam,
    detector: Detector,
    focus: float,
    max_intersections: int,
    min_amplitude: float,
) -> tuple[Any, ...]:
    """Trace the tree, in compiled code: `trace` says what, and `Detections` what comes back."""
    # a plain tuple: making a named one on the way out crashes when an interrupt is waiting
    found, detected, segments = _room_for_found(beam.vx.size), 0, 0
    outcomes = np.zeros(OUTCOMES, np.int64)
    # depth first: above each block on the way wait two for each face that it can meet
    waiting = _room_for_waiting((2 * faces.kind.size + 1) * (max_intersections + 1))
    distance, cos_i, cos_t = np.empty(LANES), np.empty(LANES), np.empty(LANES)
    cos_met, wanted = np.empty(LANES), np.empty(LANES, np.bool_)
    face, chosen = np.empty(LANES, np.int64), np.empty(LANES, np.uint32)

    for first in range(0, beam.vx.size, LANES):
        count = min(LANES, beam.vx.size - first)
        launch(beam, first, count, focus, waiting.blocks[0])
        top = _wait(waiting, -1, count, 0, 0, 1)
        while top >= 0:
            n, d, m = waiting.lanes[top], waiting.departure[top], waiting.meetings[top]
            code, block = waiting.path[top], waiting.blocks[top]
            waiting.lanes[top] = 0  # done, but its children's blocks go above it
            if n == 0:
                top -= 1
                continue
            segments += n
            if faces.to_objective[d]:
                found, detected = _detect(
                    detector,
                    focus,
                    faces.n_objective,
                    beam,
                    block,
                    n,
                    code,
                    found,
                    detected,
                    outcomes,
                    distance,
                    cos_i,
                    cos_t,
                )
                continue
            meet_nearest(faces, d, block, n, face, distance, cos_i, cos_met, cos_t)
            escaped = n
            for choice in range(faces.first[d], faces.first[d + 1]):
                f = faces.next_face[choice]
                count = choose(face, f, n, chosen)
                escaped -= count
                if m == max_intersections:
                    outcomes[Outcome.SPENT] += count
                    continue
                met, beyond = waiting.blocks[top + 1], waiting.blocks[top + 2]
                advance_chosen(block, n, chosen, count, distance, cos_i, faces.n_i[f], met, cos_met)
                total = split(faces, f, met, count, cos_met, cos_t, beyond)
                returned, through = sift(met, beyond, count, total, cos_t, min_amplitude, wanted)
                outcomes[Outcome.TOTALLY_REFLECTED] += total
                outcomes[Outcome.FAINT] += 2 * count - total - through - returned
                here = code * faces.kind.size + 2 * faces.surface[f]
                top = _wait(waiting, top, returned, faces.after_reflection[f], m + 1, here)
                top = _wait(waiting, top, through, faces.after_transmission[f], m + 1, here + 1)
            outcomes[Outcome.ESCAPED] += escaped
    return (
        found.ray[:detected].copy(),
        found.path[:detected].copy(),
        found.amplitude[:detected].copy(),
        found.optical_path_length[:detected].copy(),
        found.x[:detected].copy(),
        found.y[:detected].copy(),
        found.vx[:detected].copy(),
        found.vy[:detected].copy(),
        segments,
        outcomes,
    )


def check_reach(scene: Scene, detector: Detector, focus: float, max_intersections: int) -> None:
    """Refuse what `trace` can't trace.

    Raises
    ------
    ValueError
        If the focus is not below the focus distance, as the objective would not be in the glass, or
        there are more `max_intersections` than light paths can be numbered for.
    """
    if not focus < detector.focus_distance:
        raise ValueError(
            f"focus: {focus} µm given; it must be below the focus distance, "
            f"{detector.focus_distance} µm"
        )
    if (2 * len(scene.surfaces)) ** max_intersections >= 2**62:
        raise ValueError(
            f"max_intersections: {max_intersections} given; the light paths of so many meetings "
            f"with {len(scene.surfaces)} surfaces can't be numbered, so give less"
        )


def trace(
    scene: Scene,
    beam: Beam,
    detector: Detector,
    focus: float,
    max_intersections: int = 11,
    min_amplitude: float = 0.0,
) -> Detections:
    """Trace a beam through a scene, splitting every ray at every surface.

    Parameters
    ----------
    scene : Scene
        Surfaces and media; the objective lies in the glass below them.
    beam : Beam
        Rays aimed at the focus, N of them.
    detector : Detector
        What receives the rays that return.
    focus : float
        Height of the focus above z = 0 as if all were glass, µm; below the focus distance.
    max_intersections : int
        Surfaces that one ray may meet; a ray that has met just as many can still be detected.
    min_amplitude : float
        Rays fainter than this, relative to their launch amplitude, are dropped.

    Returns
    -------
    Detections
        The detected rays, and how all others ended.

    Raises
    ------
    ValueError
        As `check_reach` says.
    """
    check_reach(scene, detector, focus, max_intersections)
    return Detections(
        *trace_tree(faces_of(scene), beam, detector, focus, max_intersections, min_amplitude)
    )
