r"""Where a ray meets a cylinder of any direction, and its normal; as `octsim.optics.intersection`.

All is seen in the cross section, across the axis. With :math:`\hat a` along it and w from the ray
to a point of it, the ray heads along :math:`v_\perp = \hat v - (\hat v\cdot\hat a)\hat a`, is half
way through at :math:`m' = w\cdot v_\perp / |v_\perp|`, and passes the axis at the distance
:math:`b = (w\times\hat v)\cdot\hat a / |v_\perp|`.
"""

import math
from typing import NamedTuple

from numba.extending import register_jitable

from octsim.optics.interface import Vector


class Axis(NamedTuple):
    """An axis through (x, 0, z), µm, along the unit vector (along_x, along_y, along_z)."""

    x: float
    z: float
    along_x: float
    along_y: float
    along_z: float


@register_jitable(forceinline=True)
def _to_axis(axis: Axis, position: Vector) -> Vector:
    """Return the way from a point to the axis's own point."""
    return Vector(axis.x - position.x, -position.y, axis.z - position.z)


@register_jitable(forceinline=True)
def _across(axis: Axis, way: Vector) -> Vector:
    """Return a vector without its part along the axis."""
    along = way.x * axis.along_x + way.y * axis.along_y + way.z * axis.along_z
    return Vector(
        way.x - along * axis.along_x, way.y - along * axis.along_y, way.z - along * axis.along_z
    )


@register_jitable(forceinline=True)
def _passing(
    axis: Axis, radius: float, position: Vector, direction: Vector
) -> tuple[float, float, float]:
    """Return |v_⊥|, m' and the square of the half chord h."""
    to, v = _to_axis(axis, position), _across(axis, direction)
    across = math.sqrt(v.x * v.x + v.y * v.y + v.z * v.z)
    middle = (to.x * v.x + to.y * v.y + to.z * v.z) / across
    offset = (
        (to.y * direction.z - to.z * direction.y) * axis.along_x
        + (to.z * direction.x - to.x * direction.z) * axis.along_y
        + (to.x * direction.y - to.y * direction.x) * axis.along_z
    ) / across
    return across, middle, (radius - offset) * (radius + offset)


@register_jitable(forceinline=True)
def enter_turned(
    axis: Axis, radius: float, position: Vector, direction: Vector
) -> tuple[float, float]:
    """Return the distance from outside, infinite if the ray misses, and the cosine of incidence."""
    across, middle, h_squared = _passing(axis, radius, position, direction)
    h = math.sqrt(max(h_squared, 0.0))
    meets = middle > 0 and h_squared > 0
    return ((middle - h) / across if meets else math.inf), h * across / radius


@register_jitable(forceinline=True)
def leave_turned(
    axis: Axis, radius: float, position: Vector, direction: Vector
) -> tuple[float, float]:
    """Return the distance from anywhere inside, and the cosine of incidence."""
    across, middle, h_squared = _passing(axis, radius, position, direction)
    h = math.sqrt(max(h_squared, 0.0))
    # a ray along the axis never leaves
    distance = max(middle + h, 0.0) / across
    return (distance if h_squared > 0 else math.inf), h * across / radius


@register_jitable(forceinline=True)
def cross_turned(
    axis: Axis, radius: float, position: Vector, direction: Vector
) -> tuple[float, float]:
    """Return the distance from a point on it through its inside, and the cosine of incidence."""
    to, v = _to_axis(axis, position), _across(axis, direction)
    middle = to.x * v.x + to.y * v.y + to.z * v.z
    across_squared = v.x * v.x + v.y * v.y + v.z * v.z
    return (2 * middle / across_squared if middle > 0 else math.inf), middle / radius


@register_jitable(forceinline=True)
def turned_normal(axis: Axis, curvature: float, position: Vector) -> Vector:
    """Return the normal at a point on it, of a length of nearly 1.

    `curvature` is 1 / radius for that on the outside, −1 / radius for that on the inside, 1/µm.
    """
    to = _across(axis, _to_axis(axis, position))
    return Vector(-curvature * to.x, -curvature * to.y, -curvature * to.z)


@register_jitable(forceinline=True)
def is_inside(axis: Axis, radius: float, position: Vector) -> bool:
    """Return whether a point is inside."""
    to = _across(axis, _to_axis(axis, position))
    return to.x * to.x + to.y * to.y + to.z * to.z < radius * radius
