"""What the ray tracers are asked for: octsim's scene, a beam, and counts of what came of it."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import octsim
from octsim.instrument.build import detector_of, scene_of
from octsim.optics.beam import Beam, vogel_beam
from octsim.optics.detector import RIM, Detector
from octsim.optics.scene import Cylinder, Scene
from octsim.tracing.tree import trace

RAYS = 3000
DIAMETER = 1.4
FOCUS = 0.876
MEETINGS = 11
BELOW = -1.0
"""Height from which the peers' rays start; octsim's are referred to the focus, µm."""
FAR = 1e6
"""Half the extent of what is endless, where a peer needs a limit, µm."""
Rays = NDArray[np.float64]
"""Positions and directions, (N, 6)."""


class Job(NamedTuple):
    """What is to be traced."""

    scene: Scene
    beam: Beam
    detector: Detector

    @property
    def cylinder(self) -> Cylinder:
        """The neuron."""
        cylinder = self.scene.surfaces[1]
        assert isinstance(cylinder, Cylinder)
        return cylinder

    @property
    def launched(self) -> Rays:
        """The rays of the beam, traced back from the focus to where the peers' start."""
        along = np.stack([self.beam.vx, self.beam.vy, self.beam.vz], axis=1)
        return np.hstack([[0, 0, FOCUS] + along * (BELOW - FOCUS) / along[:, 2:], along])


class Counts(NamedTuple):
    """What a trace came to."""

    segments: int
    detected: int


class Work(NamedTuple):
    """A scene that is built in a peer, ready to be traced."""

    trace: Callable[[], Any]
    count: Callable[[Any], Counts]
    """Reads the result of `trace`; not timed."""


def detected_of(returned: Rays, job: Job) -> int:
    """Count, of rays on their way down through the glass, those that octsim would detect."""
    position, along = returned[:, :3], returned[:, 3:]

    def squared_radius(height: float) -> NDArray[np.float64]:
        distance = (height - position[:, 2]) / along[:, 2]
        return ((position + distance[:, None] * along)[:, :2] ** 2).sum(axis=1)

    rim = (RIM * job.detector.objective_radius) ** 2
    through = squared_radius(FOCUS - job.detector.focus_distance) <= rim
    return int((through & (squared_radius(FOCUS) < job.detector.radius**2)).sum())


def job_of(rays: int, gap: float | None = None) -> Job:
    """Make the scene and the beam of octsim's default config, with a gap in µm if it is given."""
    overlay = {} if gap is None else {"scene": {"gap": f"{gap} um"}}
    config = octsim.load_config(overlay)
    detector = detector_of(config)
    beam = vogel_beam(rays, detector.objective_radius, detector.focus_distance)
    return Job(scene_of(config, DIAMETER), beam, detector)


def octsim_work(job: Job) -> Work:
    """Trace with octsim itself."""
    return Work(
        lambda: trace(job.scene, job.beam, job.detector, FOCUS, MEETINGS),
        lambda found: Counts(found.segments, found.ray.size),
    )
