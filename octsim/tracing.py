"""The ray tree: every ray splits at every surface it meets, until it is detected or gone."""

from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.beam import Beam
from octsim.compiled import compiled
from octsim.detection import Detector, Outcome, detect
from octsim.intersection import cross_cylinder, enter_cylinder, meet_plane
from octsim.optics import Vector, cos_transmitted_squared, fresnel, reflect, refract
from octsim.scene import Medium, Scene, Shape, Surfaces

NOWHERE = -1
OUTCOMES = len(Outcome)


class Detections(NamedTuple):
    """Rays that reached the detector, D of them, by launched ray and then depth first."""

    ray: NDArray[np.int64]
    """Launched ray that each comes from, (D,)."""
    path: NDArray[np.int64]
    """Code of the light path, (D,); `path_name` reads it."""
    amplitude: NDArray[np.float64]
    """Amplitude, weighted by the detector, (D,)."""
    optical_path_length: NDArray[np.float64]
    """Path from the focus to the fibre, beyond that of an axial ray through the lens, (D,), µm."""
    segments: int
    """Straight pieces of ray that were traced."""
    outcomes: NDArray[np.int64]
    """How often each `Outcome` came about, (7,)."""


class _Stack(NamedTuple):
    """Segments that are still to be traced."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    z: NDArray[np.float64]
    vx: NDArray[np.float64]
    vy: NDArray[np.float64]
    vz: NDArray[np.float64]
    amplitude: NDArray[np.float64]
    optical_path_length: NDArray[np.float64]
    medium: NDArray[np.int64]
    surface: NDArray[np.int64]
    """Surface that the segment starts on."""
    meetings: NDArray[np.int64]
    path: NDArray[np.int64]


@register_jitable
def _empty_stack(size: int) -> _Stack:
    return _Stack(
        np.empty(size), np.empty(size), np.empty(size),
        np.empty(size), np.empty(size), np.empty(size),
        np.empty(size), np.empty(size),
        np.empty(size, np.int64), np.empty(size, np.int64),
        np.empty(size, np.int64), np.empty(size, np.int64),
    )  # fmt: skip


@register_jitable
def _push(
    stack: _Stack,
    top: int,
    position: Vector,
    direction: Vector,
    amplitude: float,
    optical_path_length: float,
    medium: int,
    surface: int,
    meetings: int,
    path: int,
) -> None:
    stack.x[top], stack.y[top], stack.z[top] = position
    stack.vx[top], stack.vy[top], stack.vz[top] = direction
    stack.amplitude[top] = amplitude
    stack.optical_path_length[top] = optical_path_length
    stack.medium[top] = medium
    stack.surface[top] = surface
    stack.meetings[top] = meetings
    stack.path[top] = path


@register_jitable
def nearest_surface(
    surfaces: Surfaces, medium: int, standing_on: int, position: Vector, direction: Vector
) -> tuple[int, float, float]:
    """Find the surface that a ray meets next.

    Only those that bound its medium can be; of a plane or the outside of a cylinder that it
    stands on it can't meet any more.

    Returns
    -------
    surface : int
        Number of the surface; −1 if the ray meets none.
    distance, cos_i : float
        Distance to it (µm) and cosine of incidence there.
    """
    nearest, distance, cos_i = NOWHERE, np.inf, 0.0
    for s in range(surfaces.shape.size):
        inside = medium == surfaces.inner[s]
        if not inside and medium != surfaces.outer[s]:
            continue
        if surfaces.shape[s] == Shape.PLANE:
            if s == standing_on:
                continue
            to_surface = meet_plane(surfaces.z[s], not inside, position, direction)
            cos_there = abs(direction.z)
        elif inside:
            to_surface, cos_there = cross_cylinder(
                surfaces.x[s], surfaces.z[s], surfaces.radius[s], position, direction
            )
        else:
            if s == standing_on:
                continue
            to_surface, cos_there = enter_cylinder(
                surfaces.x[s], surfaces.z[s], surfaces.radius[s], position, direction
            )
        if to_surface < distance:
            nearest, distance, cos_i = s, to_surface, cos_there
    return nearest, distance, cos_i


@register_jitable
def normal_towards(surfaces: Surfaces, s: int, medium: int, position: Vector) -> Vector:
    """Give the unit normal of surface `s` at a position on it, on the side of `medium`."""
    side = -1.0 if medium == surfaces.inner[s] else 1.0
    if surfaces.shape[s] == Shape.PLANE:
        return Vector(0.0, 0.0, side)
    scale = side / surfaces.radius[s]
    return Vector((position.x - surfaces.x[s]) * scale, 0.0, (position.z - surfaces.z[s]) * scale)


@compiled()
def _trace(
    surfaces: Surfaces,
    beam: Beam,
    detector: Detector,
    focus: float,
    max_intersections: int,
    min_amplitude: float,
) -> tuple[Any, ...]:
    # a plain tuple: making a named one on the way out crashes when an interrupt is waiting
    capacity = beam.vx.size
    ray = np.empty(capacity, np.int64)
    path = np.empty(capacity, np.int64)
    amplitude = np.empty(capacity)
    optical_path_length = np.empty(capacity)
    detected, segments = 0, 0
    outcomes = np.zeros(OUTCOMES, np.int64)
    # a segment is replaced by at most two, so depth first one more waits at each meeting
    stack = _empty_stack(max_intersections + 2)
    index = surfaces.refractive_index
    digits = 2 * surfaces.shape.size

    for j in range(beam.vx.size):
        faintest = min_amplitude * abs(beam.amplitude[j])
        aim = Vector(beam.vx[j], beam.vy[j], beam.vz[j])
        at_focus = Vector(0.0, 0.0, focus)
        _push(stack, 0, at_focus, aim, beam.amplitude[j], 0.0, Medium.GLASS, NOWHERE, 0, 1)
        waiting = 1
        while waiting > 0:
            waiting -= 1
            segments += 1
            top = waiting
            start = Vector(stack.x[top], stack.y[top], stack.z[top])
            along = Vector(stack.vx[top], stack.vy[top], stack.vz[top])
            a, path_length = stack.amplitude[top], stack.optical_path_length[top]
            medium, meetings, code = stack.medium[top], stack.meetings[top], stack.path[top]
            s, distance, cos_i = nearest_surface(surfaces, medium, stack.surface[top], start, along)
            if s == NOWHERE:
                outcome: int = Outcome.ESCAPED
                if medium == Medium.GLASS and along.z < 0:
                    outcome, weight, to_fibre = detect(detector, focus, index[medium], start, along)
                    if outcome == Outcome.DETECTED:
                        if detected == ray.size:
                            ray = np.concatenate((ray, np.empty_like(ray)))
                            path = np.concatenate((path, np.empty_like(path)))
                            amplitude = np.concatenate((amplitude, np.empty_like(amplitude)))
                            optical_path_length = np.concatenate(
                                (optical_path_length, np.empty_like(optical_path_length))
                            )
                        ray[detected] = j
                        path[detected] = code
                        amplitude[detected] = a * weight
                        optical_path_length[detected] = path_length + to_fibre
                        detected += 1
                outcomes[outcome] += 1
                continue
            if meetings == max_intersections:
                outcomes[Outcome.SPENT] += 1
                continue

            n_i = index[medium]
            position = Vector(
                start.x + distance * along.x,
                start.y + distance * along.y,
                start.z + distance * along.z,
            )
            path_length += n_i * distance
            normal = normal_towards(surfaces, s, medium, position)
            beyond = surfaces.outer[s] if medium == surfaces.inner[s] else surfaces.inner[s]
            n_t = index[beyond]
            meetings += 1
            code = code * digits + 2 * s

            cos_t_squared = cos_transmitted_squared(n_i, n_t, cos_i)
            if cos_t_squared < 0:
                r = 1.0
                outcomes[Outcome.TOTALLY_REFLECTED] += 1
            else:
                cos_t = np.sqrt(cos_t_squared)
                r, t = fresnel(n_i, n_t, cos_i, cos_t)
                if abs(a * t) < faintest:
                    outcomes[Outcome.FAINT] += 1
                else:
                    onwards = refract(along, normal, n_i, n_t, cos_i, cos_t)
                    _push(
                        stack, waiting, position, onwards, a * t, path_length,
                        beyond, s, meetings, code + 1,
                    )  # fmt: skip
                    waiting += 1
            if abs(a * r) < faintest:
                outcomes[Outcome.FAINT] += 1
            else:
                back = reflect(along, normal, cos_i)
                _push(
                    stack, waiting, position, back, a * r, path_length,
                    medium, s, meetings, code,
                )  # fmt: skip
                waiting += 1
    return (
        ray[:detected].copy(),
        path[:detected].copy(),
        amplitude[:detected].copy(),
        optical_path_length[:detected].copy(),
        segments,
        outcomes,
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
        If the focus is not below the focus distance: the objective would not be in the glass.
    """
    if not focus < detector.focus_distance:
        raise ValueError(
            f"focus: {focus} µm given; it must be below the focus distance, "
            f"{detector.focus_distance} µm"
        )
    return Detections(
        *_trace(scene.arrays(), beam, detector, focus, max_intersections, min_amplitude)
    )


def path_name(code: int, surface_names: str = "PC") -> str:
    """Read the code of a light path: its surfaces in order, R reflected or T transmitted at each.

    Examples
    --------
    >>> path_name(0b1_01_11)
    'PT CT'
    """
    meetings = []
    while code > 1:
        code, digit = divmod(code, 2 * len(surface_names))
        meetings.append(surface_names[digit // 2] + "RT"[digit % 2])
    return " ".join(reversed(meetings))
