"""The ray tree by optiland's non-sequential mode."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from peers.ray_job import FAR, FOCUS, MEETINGS, Counts, Job, Work, detected_of
from trees import indices

from octsim.optics.detector import RIM


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
