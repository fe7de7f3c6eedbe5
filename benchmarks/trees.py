"""The full ray tree of the thesis's scene in C by its invariants, to measure octsim against.

`scalar_tree` and `simd_tree` take what `octsim.tracing.tree.trace` takes and find the same
rays; `tree.c` says how. They know one scene only, a cylinder in water over a plane of glass, and
owe part of their speed to it.
"""

import ctypes
import functools
import math
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.beam import Beam
from octsim.optics.detector import RIM, Detector
from octsim.optics.scene import Cylinder, Plane, Scene

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

SOURCE = Path(__file__).parent / "tree.c"
FLAGS = (
    "-O3",
    "-march=native",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-std=c11",
    "-fPIC",
    "-shared",
)
LEVELS = 64
"""Queues of the tracer in lanes: it takes fewer intersections than these."""


class Tree(NamedTuple):
    """Rays that reached the detector, D of them, in no particular order."""

    ray: Integers
    """Launched ray that each comes from, (D,)."""
    amplitude: Floats
    """Amplitude, weighted by the detector, (D,)."""
    optical_path_length: Floats
    """Path from the focus to the fibre, beyond that of an axial ray through the lens, (D,), µm."""
    segments: int
    """Straight pieces of ray that were traced."""


class NoCompilerError(RuntimeError):
    """The C tracers can't be built on this machine; says why."""


class Setting(NamedTuple):
    """Scene and detector as the tracers use them.

    Lengths are in radii of the cylinder and heights above the plane, if no unit is given.
    """

    n_glass: float
    glass: float
    """Square of the refractive index; so are the next two."""
    water: float
    neuron: float
    sign_glass: float
    """Sign of r for light in water that meets glass."""
    sign_neuron: float
    cx: float
    """Axis of the cylinder."""
    zc: float
    radius: float
    """Of the cylinder, µm."""
    focus: float
    drop: float
    """Height of the objective."""
    objective: float
    """Square of its radius."""
    detector: float
    """Square of the radius of the detector's image."""
    magnification: float
    focal_length: float
    """In µm."""
    faint: float
    """Square of `min_amplitude`."""


def indices(scene: Scene) -> list[float]:
    """Return the refractive index of each region of a scene of constant materials."""
    return [region.material.index(math.nan).real for region in scene.regions]


def setting(scene: Scene, detector: Detector, focus: float, min_amplitude: float) -> Setting:
    """Work out what does not depend on the ray; ValueError for a scene that is not the thesis's."""
    match scene.surfaces:
        case (
            Plane(height=height, below=slide, above=bath),
            Cylinder(x=x, z=z, radius=radius, outside=around),
        ) if slide == scene.objective and around == bath and z - radius >= height - 1e-12:
            pass
        case _:
            raise ValueError(f"a cylinder in water over a plane of glass is needed, not {scene}")
    glass, water, neuron = indices(scene)
    return Setting(
        n_glass=glass,
        glass=glass**2,
        water=water**2,
        neuron=neuron**2,
        sign_glass=-1 if glass > water else 1,
        sign_neuron=-1 if neuron > water else 1,
        cx=x / radius,
        zc=(z - height) / radius,
        radius=radius,
        focus=(focus - height) / radius,
        drop=(focus - height - detector.focus_distance) / radius,
        objective=(RIM * detector.objective_radius / radius) ** 2,
        detector=(detector.radius / radius) ** 2,
        magnification=detector.magnification,
        focal_length=detector.focal_length,
        faint=min_amplitude**2,
    )


class _CTree(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_double) for name in Setting._fields),
        *((name, ctypes.c_int64) for name in ("max", "rays")),
        *((name, ctypes.c_void_p) for name in ("vx", "vy", "vz", "launched")),
        *((name, ctypes.c_int64) for name in ("capacity", "detected", "segments")),
        *((name, ctypes.c_void_p) for name in ("ray", "amplitude", "path")),
    )


@functools.cache
def library(source: Path) -> ctypes.CDLL:
    """Compile a C source for this machine and load it.

    Raises
    ------
    NoCompilerError
        If there is no C compiler, or it fails.
    """
    compiler = os.environ.get("CC") or shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        raise NoCompilerError("no C compiler: neither gcc nor cc is on the PATH, and CC is not set")
    with tempfile.TemporaryDirectory() as folder:
        built = Path(folder) / "library.so"
        command = [compiler, *FLAGS, str(source), "-o", str(built), "-lm"]
        try:
            subprocess.run(command, check=True, capture_output=True, text=True)
            return ctypes.CDLL(str(built))
        except subprocess.CalledProcessError as failure:
            raise NoCompilerError(f"{' '.join(command)} failed:\n{failure.stderr}") from failure
        except OSError as failure:
            raise NoCompilerError(f"{' '.join(command)}: {failure}") from failure


def _c_tree(
    name: str,
    scene: Scene,
    beam: Beam,
    detector: Detector,
    focus: float,
    max_intersections: int,
    min_amplitude: float,
) -> Tree:
    if not 0 <= max_intersections < LEVELS:
        raise ValueError(f"max_intersections: {max_intersections} given; 0 to {LEVELS - 1} allowed")
    trace: Callable[[ctypes.c_void_p], None] = getattr(library(SOURCE), name)
    launched = (beam.vx, beam.vy, beam.vz, beam.amplitude)
    arrays = [np.ascontiguousarray(values, dtype=np.float64) for values in launched]
    rays = arrays[0].size
    capacity = max(rays, 1024)
    while True:
        ray, amplitude, path = np.empty(capacity, np.int64), np.empty(capacity), np.empty(capacity)
        tree = _CTree(
            *setting(scene, detector, focus, min_amplitude),
            max_intersections,
            rays,
            *(values.ctypes.data for values in arrays),
            capacity,
            0,
            0,
            *(values.ctypes.data for values in (ray, amplitude, path)),
        )
        trace(ctypes.c_void_p(ctypes.addressof(tree)))
        if tree.detected <= capacity:
            found = slice(tree.detected)
            return Tree(beam.number[ray[found]], amplitude[found], path[found], tree.segments)
        capacity = tree.detected


def scalar_tree(
    scene: Scene,
    beam: Beam,
    detector: Detector,
    focus: float,
    max_intersections: int = 11,
    min_amplitude: float = 0.0,
) -> Tree:
    """Trace in C, one ray at a time and depth first.

    Arguments as in `octsim.tracing.tree.trace`.

    Raises
    ------
    NoCompilerError
        If there is no C compiler, or it fails.
    """
    return _c_tree("trace_scalar", scene, beam, detector, focus, max_intersections, min_amplitude)


def simd_tree(
    scene: Scene,
    beam: Beam,
    detector: Detector,
    focus: float,
    max_intersections: int = 11,
    min_amplitude: float = 0.0,
) -> Tree:
    """Trace in C, eight rays at a time (four without AVX-512).

    Arguments and exceptions as in `scalar_tree`.
    """
    return _c_tree("trace_simd", scene, beam, detector, focus, max_intersections, min_amplitude)
