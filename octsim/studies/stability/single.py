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
from octsim.tracing.faces import Faces, Kind

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
    if faces.kind[f] == Kind.CYLINDER_FROM_OUTSIDE:
        enter = INTERSECTION["enter_cylinder"]
        distance, cos_i = enter(faces.x[f], faces.z[f], faces.radius[f], at, along)
    elif faces.kind[f] == Kind.CYLINDER_FROM_INSIDE:
        cross = INTERSECTION["cross_cylinder"]
        distance, cos_i = cross(faces.x[f], faces.z[f], faces.radius[f], at, along)
    else:
        above = faces.kind[f] == Kind.PLANE_FROM_ABOVE
        distance = INTERSECTION["meet_plane"](faces.z[f], above, at, along)
        cos_i = abs(along.z)
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
    to_focus, at_focus = DETECTION["arrival"](precision(focus), at, along)
    plane = precision(focus) - detector.focus_distance
    _, at_objective = DETECTION["arrival"](plane, at, along)
    if DETECTION["fate"](detector, at_focus, at_objective) != detection.Outcome.DETECTED:
        return None
    weight, rest = DETECTION["collect"](detector, faces.n_objective, to_focus, at_focus)
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
    flat = faces.kind[f] in (Kind.PLANE_FROM_ABOVE, Kind.PLANE_FROM_BELOW)
    if flat:
        side = 1 if faces.kind[f] == Kind.PLANE_FROM_ABOVE else -1
        normal = optics.Vector(zero, zero, zero + side)
    else:
        side = 1 if faces.kind[f] == Kind.CYLINDER_FROM_OUTSIDE else -1
        scale = side / faces.radius[f]
        normal = optics.Vector((at.x - faces.x[f]) * scale, zero, (at.z - faces.z[f]) * scale)
    cos_t = np.sqrt(np.maximum(squared, zero))
    r, t = OPTICS["fresnel"](n_i, n_t, cos_i, cos_t)
    if transmitted:
        onward, factor = OPTICS["refract"](along, normal, n_i, n_t, cos_i, cos_t), t
    else:
        onward = OPTICS["reflect"](along, normal, cos_i)
        factor = r if squared >= 0 else zero + 1
    return (onward if flat else OPTICS["unit"](onward)), factor
