"""The ray tree in C (`same.c`) and in numpy with octsim's own arithmetic, to measure it against."""

import ctypes
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from trees import Tree, indices, library

from octsim.optics.beam import Beam
from octsim.optics.detector import RIM, Detector
from octsim.optics.scene import Cylinder, Scene

SOURCE = Path(__file__).parent / "same.c"
Array = NDArray[np.float64]


class _Tree(ctypes.Structure):
    _fields_ = (
        ("n", ctypes.c_double * 3),
        *(
            (name, ctypes.c_double)
            for name in (
                "zc", "radius", "focus", "objective", "objective_radius", "detector_radius",
                "magnification", "focal_length", "min_amplitude",
            )
        ),
        *((name, ctypes.c_int64) for name in ("max_intersections", "rays")),
        *((name, ctypes.c_void_p) for name in ("vx", "vy", "vz", "launched")),
        *((name, ctypes.c_void_p) for name in ("ray", "amplitude", "path")),
        *((name, ctypes.c_int64) for name in ("room", "detected", "segments")),
    )  # fmt: skip


def same_tree(
    kernel: str,
    scene: Scene,
    beam: Beam,
    detector: Detector,
    focus: float,
    max_intersections: int = 11,
    min_amplitude: float = 0.0,
) -> Tree:
    """Trace in C by ``same_scalar``, a ray at a time, or ``same_lanes``, a block of them.

    Other arguments as in `octsim.tracing.tree.trace`.

    Raises
    ------
    NoCompilerError
        If there is no C compiler, or it fails.
    """
    cylinder = scene.surfaces[1]
    assert isinstance(cylinder, Cylinder)
    rays = beam.vx.size
    room = 8 * rays + 1024
    ray, amplitude, path = np.empty(room, np.int64), np.empty(room), np.empty(room)
    tree = _Tree(
        (ctypes.c_double * 3)(*indices(scene)),
        cylinder.z,
        cylinder.radius,
        focus,
        focus - detector.focus_distance,
        RIM * detector.objective_radius,
        detector.radius,
        detector.magnification,
        detector.focal_length,
        min_amplitude,
        max_intersections,
        rays,
        *(values.ctypes.data for values in (beam.vx, beam.vy, beam.vz, beam.amplitude)),
        *(values.ctypes.data for values in (ray, amplitude, path)),
        room,
    )
    getattr(library(SOURCE), kernel)(ctypes.byref(tree))
    found = slice(tree.detected)
    return Tree(beam.number[ray[found]], amplitude[found], path[found], tree.segments)


def numpy_tree(
    scene: Scene,
    beam: Beam,
    detector: Detector,
    focus: float,
    max_intersections: int = 11,
) -> Tree:
    """Trace in plain numpy, breadth first: all rays of a generation and a departure at a time.

    Arguments as in `octsim.tracing.tree.trace`.
    """
    n_glass, n_water, n_neuron = indices(scene)
    cylinder = scene.surfaces[1]
    assert isinstance(cylinder, Cylinder)
    zc, radius = cylinder.z, cylinder.radius
    zero = np.zeros_like(beam.vx)
    number = np.arange(beam.vx.size)
    launched = np.stack(
        [zero, zero, zero + focus, beam.vx, beam.vy, beam.vz, beam.amplitude, zero, number]
    )
    # light in the water on its way up, in the cylinder, and on its way out of the cylinder
    up, within, out = np.empty((9, 0)), np.empty((9, 0)), np.empty((9, 0))
    detected, segments = [], launched.shape[1]

    def split(
        rays: Array, distance: Array, cos_i: Array, n_i: float, n_t: float, side: float | None
    ) -> tuple[Array, Array]:
        """Give the reflected and the transmitted rays; `side` is that of a plane."""
        x, y, z, vx, vy, vz, amplitude, path, ray = rays
        x, y, z = x + distance * vx, y + distance * vy, z + distance * vz
        path = path + n_i * distance
        if side is None:
            sign = 1 if n_i == n_water else -1
            nx, nz = sign * (x - cylinder.x) / radius, sign * (z - zc) / radius
        else:
            nx, nz = np.zeros_like(x), np.full_like(x, side)
        eta = n_i / n_t
        squared = (1 - eta) * (1 + eta) + eta**2 * cos_i**2
        passes = squared >= 0
        cos_t = np.sqrt(np.maximum(squared, 0))
        parallel, perpendicular = n_t * cos_i + n_i * cos_t, n_i * cos_i + n_t * cos_t
        r = np.sqrt(
            (((n_t * cos_i - n_i * cos_t) / parallel) ** 2
             + ((n_i * cos_i - n_t * cos_t) / perpendicular) ** 2) / 2
        )  # fmt: skip
        r = np.where(passes, -r if n_t > n_i else r, 1.0)
        t = 2 * n_i * cos_i * np.sqrt((parallel**-2 + perpendicular**-2) / 2)
        turn = eta * cos_i - cos_t
        back = np.stack(
            [x, y, z, vx + 2 * cos_i * nx, vy, vz + 2 * cos_i * nz, amplitude * r, path, ray]
        )
        onwards = np.stack(
            [
                x,
                y,
                z,
                eta * vx + turn * nx,
                eta * vy,
                eta * vz + turn * nz,
                amplitude * t,
                path,
                ray,
            ]
        )
        return back, onwards[:, passes]

    def land(rays: Array) -> None:
        """Note which of the rays on their way down through the glass are detected."""
        x, y, z, vx, vy, vz, amplitude, path, ray = rays
        far, near = (focus - detector.focus_distance - z) / vz, (focus - z) / vz
        at_objective = (x + far * vx) ** 2 + (y + far * vy) ** 2
        rho = (x + near * vx) ** 2 + (y + near * vy) ** 2
        limit, f = detector.radius**2, detector.focal_length
        found = (at_objective <= (RIM * detector.objective_radius) ** 2) & (rho < limit)
        lens = detector.magnification * rho / (np.sqrt(f * f + rho) + f)
        whole = path + n_glass * near + lens
        detected.append(np.stack([ray, amplitude * (1 - rho / limit), whole])[:, found])

    down, up = split(launched, (0 - launched[2]) / launched[5], launched[5], n_glass, n_water, -1.0)
    land(down)
    segments += down.shape[1] + up.shape[1]
    for _ in range(1, max_intersections):
        to_x, to_z = cylinder.x - up[0], zc - up[2]
        across = np.sqrt(up[3] ** 2 + up[5] ** 2)
        middle, offset = to_x * up[3] + to_z * up[5], (to_x * up[5] - to_z * up[3]) / across
        h_squared = (radius - offset) * (radius + offset)
        hits = (middle > 0) & (h_squared > 0)
        h = np.sqrt(h_squared[hits])
        distance = (middle[hits] / across[hits] - h) / across[hits]
        off, entered = split(
            up[:, hits], distance, h * across[hits] / radius, n_water, n_neuron, None
        )
        middle = (cylinder.x - within[0]) * within[3] + (zc - within[2]) * within[5]
        inwards, middle = within[:, middle > 0], middle[middle > 0]
        chord = 2 * middle / (inwards[3] ** 2 + inwards[5] ** 2)
        kept, left = split(inwards, chord, middle / radius, n_neuron, n_water, None)
        falling = out[:, out[5] < 0]
        up, down = split(falling, -falling[2] / falling[5], -falling[5], n_water, n_glass, 1.0)
        land(down)
        within, out = np.concatenate((entered, kept), 1), np.concatenate((off, left), 1)
        segments += down.shape[1] + up.shape[1] + within.shape[1] + out.shape[1]
    ray, amplitude, path = np.concatenate(detected, 1)
    return Tree(beam.number[ray.astype(int)], amplitude, path, segments)
