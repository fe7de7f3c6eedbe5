"""octsim's own formulas, ray by ray in another precision: what float32 would cost.

The formulas are not copied: the very functions of octsim.optics run on numpy scalars, with a square
root that keeps their precision. In float64 the results are octsim's.
"""

import math
from types import FunctionType, ModuleType, SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from octsim.optics import detector as detection
from octsim.optics import interface as optics
from octsim.optics import intersection
from octsim.optics.beam import Beam
from octsim.optics.detector import Detector
from octsim.tracing.faces import Faces, Kind, is_flat

Real = Any  # np.float32 or np.float64
Precision = type[np.float32] | type[np.float64]


def _of(module: ModuleType) -> dict[str, Any]:
    """Return a module's names, its functions with a square root that keeps the precision."""
    names = dict(vars(module))
    names["math"] = SimpleNamespace(sqrt=np.sqrt, inf=math.inf)
    for name, function in vars(module).items():
        if isinstance(function, FunctionType) and function.__module__ == module.__name__:
            names[name] = FunctionType(function.__code__, names, name, function.__defaults__)
    return names


OPTICS, INTERSECTION, DETECTION = _of(optics), _of(intersection), _of(detection)


class Arrival(NamedTuple):
    """What a ray brings to the fibre: amplitude relative to launch, and path (µm)."""

    amplitude: Real
    optical_path_length: Real


def _numbers(row: Any, precision: Precision) -> Any:
    """Return a named tuple with its floats in a precision."""
    return row._replace(
        **{
            name: precision(value) if isinstance(value, float) else value.astype(precision)
            for name, value in row._asdict().items()
            if isinstance(value, float) or value.dtype == np.float64
        }
    )


def _meet(faces: Faces, f: int, at: Any, along: Any) -> tuple[Real, Real]:
    kind, shape = faces.kind[f], faces.shape[f]
    if is_flat(kind):
        above = kind == Kind.PLANE_FROM_ABOVE
        return INTERSECTION["meet_plane"](shape[0], above, at, along), abs(along.z)
    name = "enter_cylinder" if kind == Kind.CYLINDER_FROM_OUTSIDE else "cross_cylinder"
    distance, cos_i = INTERSECTION[name](*shape, at, along)
    return distance, cos_i


def follow_single(
    faces: Faces,
    detector: Detector,
    beam: Beam,
    focus: float,
    ray: int,
    code: int,
    precision: Precision,
) -> Arrival | None:
    """Return what arrives by one light path of the ray at a place of a beam; None if nothing does.

    Arguments as octsim's tracer has them; they are rounded to the precision first.
    """
    faces, detector = _numbers(faces, precision), _numbers(detector, precision)
    vector: Any = optics.Vector  # of doubles, as octsim has it
    at = vector(precision(0), precision(0), precision(focus))
    along = vector(precision(beam.vx[ray]), precision(beam.vy[ray]), precision(beam.vz[ray]))
    amplitude, path, departure = precision(1), precision(0), 0
    digits = []
    while code > 1:
        code, digit = divmod(code, faces.kind.size)
        digits.append(digit)
    for digit in reversed(digits):
        choices = faces.next_face[faces.first[departure] : faces.first[departure + 1]]
        met = [(f, *_meet(faces, f, at, along)) for f in choices]
        met = [(f, *m) for f, *m in met if m[0] < np.inf]
        if not met:
            return None
        f, distance, cos_i = min(met, key=lambda m: m[1])
        if faces.surface[f] != digit // 2:
            return None
        at = vector(*(a + distance * v for a, v in zip(at, along, strict=True)))
        path = path + distance * faces.n_i[f]
        step = _split(faces, f, at, along, cos_i, digit % 2 == 1)
        if step is None:
            return None
        along, factor = step
        amplitude = amplitude * factor
        after = faces.after_transmission if digit % 2 else faces.after_reflection
        departure = after[f]
    to_focus, at_focus = DETECTION["at_plane"](precision(focus), at, along)
    plane = precision(focus) - detector.focus_distance
    _, at_objective = DETECTION["at_plane"](plane, at, along)
    within = detection.acceptance(detector)
    if DETECTION["fate"](within, at_focus, at_objective) != detection.Outcome.DETECTED:
        return None
    weight = DETECTION["falloff"](at_focus / (detector.radius * detector.radius))
    rest = DETECTION["to_fibre"](detector, faces.n_objective, to_focus, at_focus)
    return Arrival(amplitude * weight, path + rest)


def _split(
    faces: Faces, f: int, at: Any, along: Any, cos_i: Real, transmitted: bool
) -> tuple[Any, Real] | None:
    """Return direction and factor on the amplitude behind a face; None if there is no such ray."""
    n_i, n_t = faces.n_i[f], faces.n_t[f]
    squared = OPTICS["cos_transmitted_squared"](n_i, n_t, cos_i)
    if squared < 0 and transmitted:
        return None
    zero = cos_i * 0
    kind, shape = faces.kind[f], faces.shape[f]
    flat = is_flat(kind)
    if flat:
        side = INTERSECTION["plane_normal"](kind == Kind.PLANE_FROM_ABOVE)
        normal = optics.Vector(*(zero + part for part in side))
    else:
        curvature = (1 if kind == Kind.CYLINDER_FROM_OUTSIDE else -1) / shape[2]
        normal = INTERSECTION["cylinder_normal"](shape[0], shape[1], curvature, at)
    cos_t = np.sqrt(np.maximum(squared, zero))
    r, t = OPTICS["fresnel"](n_i, n_t, cos_i, cos_t)
    if transmitted:
        onward, factor = OPTICS["refract"](along, normal, n_i, n_t, cos_i, cos_t), t
    else:
        onward = OPTICS["reflect"](along, normal, cos_i)
        factor = r if squared >= 0 else zero + 1
    return (onward if flat else OPTICS["unit"](onward)), factor
