"""The ray tree: every ray splits at every surface it meets, until it arrives or is gone."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.beam import Beam, DisplacedBeam
from octsim.optics.detector import Acceptance, Detector, acceptance, weight
from octsim.optics.scene import Scene
from octsim.tracing.faces import faces_at, most_meetings
from octsim.tracing.kernel import FIRST_CARRIED, trace_amplitudes


class Arrivals(NamedTuple):
    """Rays that a detector accepts, D of them, always in the same order; not weighed."""

    ray: NDArray[np.int64]
    """Place in the beam of the launched ray that each comes from, (D,)."""
    path: NDArray[np.int64]
    """Code of the light path, (D,); `octsim.tracing.light_paths` reads it."""
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
    carried: NDArray[np.float64]
    """What it carries there, (C, D)."""
    segments: int
    """Straight pieces of ray that were traced."""
    outcomes: NDArray[np.int64]
    """How often each `Outcome` came about, (7,)."""


class Detections(NamedTuple):
    """Arrivals, weighed by the detector."""

    ray: NDArray[np.int64]
    """Number of the launched ray that each comes from, (D,)."""
    path: NDArray[np.int64]
    """Code of the light path, (D,)."""
    amplitude: NDArray[np.float64]
    """Amplitude, weighed by the detector, (D,)."""
    optical_path_length: NDArray[np.float64]
    """Path from the focus to the fibre, beyond that of an axial ray through the lens, (D,), µm."""
    segments: int
    """Straight pieces of ray that were traced."""
    outcomes: NDArray[np.int64]
    """How often each `Outcome` came about, (7,)."""


def check_reach(scene: Scene, detector: Detector, focus: float, max_intersections: int) -> None:
    """Refuse what can't be traced.

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
    if max_intersections > (most := most_meetings(scene) - scene.unseen_meetings):
        raise ValueError(
            f"max_intersections: {max_intersections} given; the light paths of so many meetings "
            f"with {len(scene.surfaces)} surfaces can't be numbered, so give {most} or less"
        )


def arrivals(
    scene: Scene,
    beam: Beam | DisplacedBeam,
    detector: Detector,
    focus: float,
    max_intersections: int = 11,
    min_amplitude: float = 0.0,
    wavenumber: float = math.nan,
    tree: Callable[..., tuple[Any, ...]] = trace_amplitudes,
    within: Acceptance | None = None,
) -> Arrivals:
    """Trace a beam through a scene, splitting every ray at every surface.

    Parameters
    ----------
    scene : Scene
        Surfaces, and the regions between them.
    beam : Beam
        Rays aimed at the focus, N of them.
    detector : Detector
        What accepts the rays that return.
    focus : float
        Height of the focus above z = 0 as if all were glass, µm; below the focus distance.
    max_intersections : int
        Surfaces that one ray may meet; a ray that has met just as many can still arrive.
    min_amplitude : float
        Rays fainter than this, relative to their launch amplitude, are dropped.
    wavenumber : float
        At which materials are taken, 1/µm; without one all must be constant.
    tree : callable
        From `octsim.tracing.kernel.make_tree`: it says what the rays carry.
    within : Acceptance, optional
        Radii within which rays are accepted; without, those of the detector.

    Returns
    -------
    Arrivals
        The accepted rays, and how all others ended.

    Raises
    ------
    ValueError
        As `check_reach` says.
    """
    check_reach(scene, detector, focus, max_intersections)
    (ray, path), numbers, segments, outcomes = tree(
        faces_at(scene, wavenumber), beam, detector, within or acceptance(detector), focus,
        max_intersections + scene.unseen_meetings, min_amplitude,
    )  # fmt: skip
    length, x, y, vx, vy = numbers[:FIRST_CARRIED]
    carried = numbers[FIRST_CARRIED:]
    return Arrivals(ray, path, length, x, y, vx, vy, carried, segments, outcomes)


def trace(
    scene: Scene,
    beam: Beam,
    detector: Detector,
    focus: float,
    max_intersections: int = 11,
    min_amplitude: float = 0.0,
    wavenumber: float = math.nan,
) -> Detections:
    """Trace a beam of unpolarised light, and weigh what arrives.

    Arguments and exceptions as in `arrivals`.
    """
    found = arrivals(scene, beam, detector, focus, max_intersections, min_amplitude, wavenumber)
    return Detections(
        beam.number[found.ray],
        found.path,
        beam.amplitude[found.ray] * found.carried[0] * weight(detector, found.x, found.y),
        found.optical_path_length,
        found.segments,
        found.outcomes,
    )
