"""Where lanes meet a face, and the normal there, by the kind of scene when code is compiled."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from numba.extending import overload, register_jitable

from octsim.optics.interface import Vector
from octsim.optics.intersection import (
    cross_cylinder,
    cylinder_normal,
    enter_cylinder,
    leave_cylinder,
    meet_plane,
)
from octsim.optics.turned_cylinder import (
    Axis,
    cross_turned,
    enter_turned,
    is_inside,
    leave_turned,
    turned_normal,
)
from octsim.tracing.faces import AnyFaces, Faces, Kind, Meeting, PlainFaces, is_flat
from octsim.tracing.lanes import VZ, Block, Lanes, direction, position

_OF_CYLINDER = 6
"""Numbers of a cylinder in the shape of a part of a plane, which begin at `_CYLINDERS`."""
_CYLINDERS = 3


@register_jitable(forceinline=True)
def _meet_level(
    faces: PlainFaces, choice: int, block: Block, n: int, distance: Lanes, cos_i: Lanes
) -> None:
    f = faces.next_face[choice]
    kind, shape = faces.kind[f], faces.shape[f]
    if is_flat(kind):
        height, above = shape[0], kind == Kind.PLANE_FROM_ABOVE
        for i in range(n):
            distance[i] = meet_plane(height, above, position(block, i), direction(block, i))
            cos_i[i] = abs(block[VZ + i])
        return
    x, z, radius = shape[0], shape[1], shape[2]
    if kind == Kind.CYLINDER_FROM_OUTSIDE:
        for i in range(n):
            distance[i], cos_i[i] = enter_cylinder(
                x, z, radius, position(block, i), direction(block, i)
            )
    else:
        for i in range(n):
            distance[i], cos_i[i] = cross_cylinder(
                x, z, radius, position(block, i), direction(block, i)
            )


@register_jitable(forceinline=True)
def _within_part(shape: Lanes, at: Vector) -> bool:
    """Return whether a point of a plane is in a part of it."""
    rest, inside = int(shape[1]), shape[2] > 0
    for c in range(rest + 1 if inside else rest):
        own = shape[_CYLINDERS + c * _OF_CYLINDER :]
        axis = Axis(own[0], own[1], own[3], own[4], own[5])
        if is_inside(axis, own[2], at) != (inside and c == 0):
            return False
    return True


@register_jitable
def _meet_flat(
    faces: AnyFaces, choice: int, block: Block, n: int, distance: Lanes, cos_i: Lanes
) -> None:
    how, shape = faces.meeting[choice], faces.shape[faces.next_face[choice]]
    above = how == Meeting.PLANE_FROM_ABOVE or how == Meeting.PART_FROM_ABOVE
    for i in range(n):
        distance[i] = meet_plane(shape[0], above, position(block, i), direction(block, i))
        cos_i[i] = abs(block[VZ + i])
    if how == Meeting.PART_FROM_BELOW or how == Meeting.PART_FROM_ABOVE:
        for i in range(n):
            way, here, along = distance[i], position(block, i), direction(block, i)
            if way < math.inf:
                at = Vector(here.x + way * along.x, here.y + way * along.y, shape[0])
                distance[i] = way if _within_part(shape, at) else math.inf


@register_jitable
def _meet_turned(
    faces: AnyFaces, choice: int, block: Block, n: int, distance: Lanes, cos_i: Lanes
) -> None:
    how, shape = faces.meeting[choice], faces.shape[faces.next_face[choice]]
    axis, radius = _any_axis(faces, faces.next_face[choice]), shape[2]
    if how == Meeting.ENTER_TURNED:
        for i in range(n):
            distance[i], cos_i[i] = enter_turned(
                axis, radius, position(block, i), direction(block, i)
            )
    elif how == Meeting.CROSS_TURNED:
        for i in range(n):
            distance[i], cos_i[i] = cross_turned(
                axis, radius, position(block, i), direction(block, i)
            )
    else:
        for i in range(n):
            distance[i], cos_i[i] = leave_turned(
                axis, radius, position(block, i), direction(block, i)
            )


@register_jitable
def _meet_along_y(
    faces: AnyFaces, choice: int, block: Block, n: int, distance: Lanes, cos_i: Lanes
) -> None:
    how, shape = faces.meeting[choice], faces.shape[faces.next_face[choice]]
    x, z, radius = shape[0], shape[1], shape[2]
    if how == Meeting.ENTER:
        for i in range(n):
            distance[i], cos_i[i] = enter_cylinder(
                x, z, radius, position(block, i), direction(block, i)
            )
    elif how == Meeting.CROSS:
        for i in range(n):
            distance[i], cos_i[i] = cross_cylinder(
                x, z, radius, position(block, i), direction(block, i)
            )
    else:
        for i in range(n):
            distance[i], cos_i[i] = leave_cylinder(
                x, z, radius, position(block, i), direction(block, i)
            )


@register_jitable
def _meet_any(
    faces: AnyFaces, choice: int, block: Block, n: int, distance: Lanes, cos_i: Lanes
) -> None:
    how = faces.meeting[choice]
    if how < Meeting.ENTER:
        _meet_flat(faces, choice, block, n, distance, cos_i)
    elif how < Meeting.ENTER_TURNED:
        _meet_along_y(faces, choice, block, n, distance, cos_i)
    else:
        _meet_turned(faces, choice, block, n, distance, cos_i)


def meet(faces: Faces, choice: int, block: Block, n: int, distance: Lanes, cos_i: Lanes) -> None:
    """Find the distance of n lanes to a choice of next face, and the cosine of incidence there."""
    if isinstance(faces, AnyFaces):
        _meet_any(faces, choice, block, n, distance, cos_i)
    else:
        _meet_level(faces, choice, block, n, distance, cos_i)


# by the type of the faces, when code is compiled: the thesis's scene has nothing of others
@overload(meet, strict=False, jit_options={"forceinline": True})
def _compile_meet(
    faces: Any, choice: Any, block: Any, n: Any, distance: Any, cos_i: Any  # noqa: ARG001
) -> Callable[..., None]:  # fmt: skip
    return _meet_any if faces.instance_class is AnyFaces else _meet_level


class LevelAxis(NamedTuple):
    """An axis along y, through (x, 0, z), µm."""

    x: float
    z: float


@register_jitable(forceinline=True)
def _level_axis(faces: PlainFaces, f: int) -> LevelAxis:
    return LevelAxis(faces.shape[f][0], faces.shape[f][1])


@register_jitable(forceinline=True)
def _any_axis(faces: AnyFaces, f: int) -> Axis:
    shape = faces.shape[f]
    return Axis(shape[0], shape[1], shape[3], shape[4], shape[5])


def axis_of(faces: Faces, f: int) -> LevelAxis | Axis:
    """Return the axis of a face of a cylinder."""
    return _any_axis(faces, f) if isinstance(faces, AnyFaces) else _level_axis(faces, f)


@overload(axis_of, strict=False, jit_options={"forceinline": True})
def _compile_axis(faces: Any, f: Any) -> Callable[..., Any]:  # noqa: ARG001
    return _any_axis if faces.instance_class is AnyFaces else _level_axis


@register_jitable(forceinline=True)
def _level_normal(axis: LevelAxis, curvature: float, at: Vector) -> Vector:
    return cylinder_normal(axis.x, axis.z, curvature, at)


def normal_from(axis: LevelAxis | Axis, curvature: float, at: Vector) -> Vector:
    """Return the normal of a cylinder at a point on it, of a length of nearly 1.

    `curvature` is 1 / radius on the outside, −1 / radius on the inside, 1/µm.
    """
    if isinstance(axis, Axis):
        return turned_normal(axis, curvature, at)
    return _level_normal(axis, curvature, at)


@overload(normal_from, strict=False, jit_options={"forceinline": True})
def _compile_normal(axis: Any, curvature: Any, at: Any) -> Callable[..., Vector]:  # noqa: ARG001
    return turned_normal if axis.instance_class is Axis else _level_normal


@register_jitable(forceinline=True)
def _always(faces: PlainFaces, f: int) -> bool:  # noqa: ARG001
    return True


@register_jitable(forceinline=True)
def _unless_equal(faces: AnyFaces, f: int) -> bool:
    return bool(faces.n_i[f] != faces.n_t[f])


def reflects(faces: Faces, f: int) -> bool:
    """Return whether light that a face reflects is traced: of none, between equal indices, not."""
    return _unless_equal(faces, f) if isinstance(faces, AnyFaces) else True


@overload(reflects, strict=False, jit_options={"forceinline": True})
def _compile_reflects(faces: Any, f: Any) -> Callable[..., bool]:  # noqa: ARG001
    return _unless_equal if faces.instance_class is AnyFaces else _always
