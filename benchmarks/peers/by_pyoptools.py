"""The ray tree by pyoptools."""

import math
from typing import Any

import numpy as np
from peers.ray_job import FAR, MEETINGS, Counts, Job, Work, detected_of
from trees import indices


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
