"""Measure octsim against other ray tracers that can split a ray, and write it to the docs.

Run by `make bench-peers`, in an environment of its own. Each peer traces a Vogel beam through the
same scene, as far as it can build it, and takes turns with octsim on one thread; its ratio is that
of segments a second. A peer that cannot be had, or cannot trace this, is named with the reason.
"""

import math
import statistics
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from trees import indices

import octsim
from octsim.instrument.build import detector_of, scene_of
from octsim.optics.beam import Beam, vogel_beam
from octsim.optics.detector import RIM, Detector
from octsim.optics.scene import Cylinder, Scene
from octsim.tracing.tree import trace

ROOT = Path(__file__).parent.parent
ROUNDS = 7
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


class Peer(NamedTuple):
    """A peer, and what was read of it in its source."""

    distribution: str
    mode: str
    rays: int
    """As many as take it a good part of a second."""
    build: Callable[[Job], Work]
    needs: tuple[str, ...]
    """What it has, or lacks, of `NEEDS`, one for each."""


class Result(NamedTuple):
    """What was measured of a peer."""

    counts: Counts
    expected: Counts
    """octsim's own, of the same rays."""
    rate: float
    speed: float
    """octsim's rate over the peer's."""
    touching: str
    """Segments of the axial ray without a gap, over octsim's."""


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


def optiland_work(job: Job) -> Work:
    """Build the scene in optiland's non-sequential mode.

    The numbers are µm, though optiland calls them mm: without absorption they have no unit. Its
    split is bounded and its roulette off, so that the tree is the whole one.
    """
    from optiland import nonsequential as nsq
    from optiland.coordinate_system import CoordinateSystem
    from optiland.materials import IdealMaterial
    from optiland.nonsequential.ir.scene_ir import SamplingPolicy
    from optiland.nonsequential.ray_bundle import NSQRayBundle

    glass, water, neuron = (nsq.NSQMaterial(IdealMaterial(n)) for n in indices(job.scene))
    cylinder, launched = job.cylinder, job.launched
    rays = len(launched)

    class Beamed(nsq.PointSource):
        """The given rays: optiland's own sources draw theirs at random."""

        given = 0

        def generate(self, ray_id: NDArray[np.int64], rng: object) -> NSQRayBundle:  # noqa: ARG002
            """Give the next rays of the beam; the numbers are optiland's, which has split some."""
            chosen = launched[self.given : self.given + ray_id.size]
            self.given += ray_id.size
            return NSQRayBundle(
                *chosen.T.copy(),
                flux=np.full(len(chosen), 1 / rays),
                wavelength=np.full(len(chosen), 0.8),
                n_current=np.full(len(chosen), indices(job.scene)[0]),
                bounce=np.zeros(len(chosen), np.int32),
                alive=np.ones(len(chosen), np.bool_),
                ray_id=ray_id,
            )

    class Counting(nsq.NumpyBackend):
        """Its numpy backend, which also counts the segments."""

        segments = 0

        def intersect_scene(self, rays: NSQRayBundle, components: list[Any]) -> Any:
            """Count the rays that are alive, and trace each to what it meets."""
            self.segments += rays.num_rays_alive
            return super().intersect_scene(rays, components)

    scene = nsq.NSQScene()
    plane = nsq.FinitePlaneGeometry(2 * FAR, 2 * FAR)
    scene.add_component("plane", nsq.RefractiveComponent(CoordinateSystem(), plane, glass, water))
    scene.add_component(
        "cylinder",
        nsq.RefractiveComponent(
            CoordinateSystem(x=cylinder.x, z=cylinder.z, rx=np.pi / 2),
            nsq.CylindricalFrustumGeometry(cylinder.radius, cylinder.radius, -FAR, FAR),
            neuron,
            water,
        ),
    )
    beam = Beamed(CoordinateSystem(), nsq.Spectrum.monochromatic(0.8), medium=glass)
    scene.source_registry.add("beam", beam)
    objective = nsq.FinitePlaneGeometry(aperture_radius=RIM * job.detector.objective_radius)
    at_objective = CoordinateSystem(z=FOCUS - job.detector.focus_distance)
    scene.detector_registry.add("objective", nsq.RayDatabaseDetector(at_objective, objective))
    # a ray that has met just as many surfaces has one segment more
    scene.sampling_policy = SamplingPolicy(
        split_depth=MEETINGS, split_budget=1e4, rr_start_flux=0.0
    )

    def run(backend: Any) -> Any:
        beam.given = 0
        return scene.trace(
            rays, MEETINGS + 1, min_flux_fraction=0.0, batch_size=rays, backend=backend
        )

    def count(_: object) -> Counts:
        backend = Counting(seed=1)
        found = run(backend).detectors["objective"]
        returned = np.stack([found.x, found.y, found.z, found.L, found.M, found.N], axis=1)
        return Counts(backend.segments, detected_of(returned, job))

    return Work(lambda: run(nsq.NumpyBackend(seed=1)), count)


def pyoptools_work(job: Job) -> Work:
    """Build the scene in pyoptools.

    The numbers are µm: it has no unit. Its surfaces split by one constant, here a half. There is no
    surface for the objective: within the glass it would refract as if in water.
    """
    from pyoptools.raytrace.component import Component
    from pyoptools.raytrace.ray import Ray
    from pyoptools.raytrace.shape import Circular, Rectangular
    from pyoptools.raytrace.surface import Cylinder as Tube
    from pyoptools.raytrace.surface import Plane
    from pyoptools.raytrace.system import System

    n_glass, n_water, n_neuron = indices(job.scene)
    cylinder, launched = job.cylinder, job.launched
    here = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    plane = Plane(shape=Rectangular(size=(2 * FAR, 2 * FAR)), reflectivity=0.5)
    tube = Tube(cylinder.radius, 2 * FAR, reflectivity=0.5, shape=Circular(radius=FAR))
    system = System(
        complist=[
            (Component(surflist=[(plane, *here)], material=n_glass), *here),
            (
                Component(surflist=[(tube, *here)], material=n_neuron),
                (cylinder.x, 0.0, cylinder.z),
                (math.pi / 2, 0.0, 0.0),
            ),
        ],
        n=n_water,
        max_ray_parent=MEETINGS + 1,  # a ray that has met just as many has one segment more
    )

    def run() -> list[Any]:
        system.reset()
        system.ray_add(
            [Ray(origin=tuple(r[:3]), direction=tuple(r[3:]), n=n_glass) for r in launched.tolist()]
        )
        system.propagate()
        return list(system.prop_ray)

    def count(traced: list[Any]) -> Counts:
        segments, returned, rays = 0, [], [(ray, 0) for ray in traced]
        while rays:
            ray, meetings = rays.pop()
            if meetings <= MEETINGS:
                segments += 1
                rays += [(child, meetings + 1) for child in ray.childs]
                if ray.n == n_glass and ray.direction[2] < 0:
                    returned.append([*ray.origin, *ray.direction])
        return Counts(segments, detected_of(np.array(returned).reshape(-1, 6), job))

    return Work(run, count)


NEEDS = (
    "signed amplitudes",
    "optical path length",
    "which light path a ray took",
    "a given beam",
    "the objective as a surface in the glass",
    "neighbouring surfaces",
)
PEERS = (
    Peer(
        "optiland",
        "non-sequential mode",
        RAYS,
        optiland_work,
        (
            "lacks: a ray has a flux, multiplied by R or 1 − R of unpolarised light",
            "lacks: neither `NSQRayBundle` nor a detector has a field for it",
            "lacks: one child of each split gets a new `ray_id`, without its parent's",
            "lacks: its sources draw rays at random; done here by a source of its kind",
            "has",
            "hits nearer than 1e-9 of its lengths are dropped, by an epsilon",
        ),
    ),
    Peer(
        "pyoptools",
        "`System`",
        200,
        pyoptools_work,
        (
            "lacks: a ray has an intensity, split by a constant of the surface; no Fresnel "
            "equations",
            "has: `optical_path_parent`, summed up the tree for each ray anew",
            "has: each ray knows its parent and its surface",
            "has",
            "lacks: outside each component it takes the system's medium; done here without",
            "hits nearer than 1e-10 are dropped; components within 1e-12 of each other are "
            "in contact, and two that both split are then refused",
        ),
    ),
)


def seconds_of(work: Work) -> float:
    """Time a trace."""
    began = time.perf_counter()
    work.trace()
    return time.perf_counter() - began


def touching(peer: Peer) -> str:
    """Trace the axial ray where cylinder and plane touch: segments found, of octsim's."""
    job = job_of(1, gap=0.0)
    ours, theirs = octsim_work(job), peer.build(job)
    expected = ours.count(ours.trace()).segments
    try:
        return f"{theirs.count(theirs.trace()).segments} of {expected}"
    except RuntimeError as error:
        return f"refused: {error}"


def measure(peer: Peer) -> Result:
    """Let a peer and octsim take turns."""
    same_rays = job_of(peer.rays)
    theirs, ours, same = (
        peer.build(same_rays),
        octsim_work(job_of(RAYS)),
        octsim_work(same_rays),
    )
    counts, our_counts = theirs.count(theirs.trace()), ours.count(ours.trace())
    seconds = [(seconds_of(ours), seconds_of(theirs)) for _ in range(ROUNDS)]
    return Result(
        counts,
        same.count(same.trace()),
        counts.segments / statistics.median(their for _, their in seconds),
        statistics.median(their / our for our, their in seconds)
        * our_counts.segments
        / counts.segments,
        touching(peer),
    )


def report(results: list[tuple[Peer, Result]], refused: dict[str, str]) -> str:
    """Write the page of what was measured."""
    rows = [
        f"| {peer.distribution} {version(peer.distribution)}, {peer.mode} | {peer.rays} "
        f"| {result.counts.segments} of {result.expected.segments} "
        f"| {result.counts.detected} of {result.expected.detected} "
        f"| {result.rate / 1e3:.3g} | {result.speed:.3g} | {result.touching} |"
        for peer, result in results
    ]
    lacks = [
        f"| {need} | " + " | ".join(peer.needs[i] for peer, _ in results) + " |"
        for i, need in enumerate(NEEDS)
    ]
    names = " | ".join(peer.distribution for peer, _ in results)
    return TEMPLATE.format(
        rows="\n".join(rows),
        refused="".join(f"\n{name} was left out: {reason}\n" for name, reason in refused.items()),
        names=names,
        rule=" | ".join("---" for _ in results),
        lacks="\n".join(lacks),
        octsim_rays=RAYS,
        rounds=ROUNDS,
        diameter=DIAMETER,
        focus=FOCUS,
        meetings=MEETINGS,
    )


TEMPLATE = """# Peers

Written by `make bench-peers`; do not edit. Ray tracers that can split every ray at every surface,
on octsim's scene: a neuron of {diameter} µm, 5 nm above the glass, focus at {focus} µm,
NA 1.2, {meetings} meetings. Each takes turns with octsim, on one thread with {octsim_rays} rays;
medians of {rounds} rounds.

| peer | rays | segments, of octsim's | detected, of octsim's | thousand segments a second \
| octsim is so many times as fast | segments of the axial ray without a gap |
| --- | --- | --- | --- | --- | --- | --- |
{rows}
{refused}
A segment is a straight piece of a ray, whether it meets a surface or leaves the scene. *Detected*
are the returning rays that octsim's rule would detect, found from the peer's own positions and
directions.

## What this job needs of them

Read in the source of the versions above.

| | {names} |
| --- | {rule} |
{lacks}
"""


def main() -> None:
    """Measure all peers, and write `docs/peers.md`."""
    results: list[tuple[Peer, Result]] = []
    refused: dict[str, str] = {}
    for peer in PEERS:
        try:
            results.append((peer, measure(peer)))
        except (ImportError, AttributeError, TypeError, ValueError, RuntimeError) as error:
            refused[peer.distribution] = f"{type(error).__name__}: {error}".splitlines()[0]
    page = report(results, refused)
    (ROOT / "docs" / "peers.md").write_text(page, encoding="utf-8")
    print(page)


if __name__ == "__main__":
    main()
