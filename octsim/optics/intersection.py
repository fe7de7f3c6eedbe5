"""Shapes: where a ray meets a plane or a cylinder, also from its inside, and the normal there.

A ray knows which side it is on, so nothing is nudged.
A ray that meets nothing is an infinite distance away. Distances are signed where a ray is still
referred to its focus (see `octsim.optics.beam`), which may lie beyond the surface.
"""

import math

from numba.extending import register_jitable

from octsim.optics.interface import Vector


@register_jitable(forceinline=True)
def meet_plane(height: float, above: bool, position: Vector, direction: Vector) -> float:
    """Return the distance along a ray to a horizontal plane (thesis fig. 2).

    Parameters
    ----------
    height : float
        Height of the plane, µm.
    above : bool
        Whether the ray is above the plane.
    position, direction : Vector
        Point on the ray (µm) and its unit direction.

    Returns
    -------
    float
        Distance in µm; infinite if the ray does not head for the plane.
    """
    level = direction.z == 0
    distance = (height - position.z) / (1.0 if level else direction.z)
    return distance if (direction.z < 0) == above and not level else math.inf


@register_jitable(forceinline=True)
def plane_normal(above: bool) -> Vector:
    """Return the unit normal of a horizontal plane, on one of its sides."""
    return Vector(0.0, 0.0, 1.0 if above else -1.0)


@register_jitable(forceinline=True)
def enter_cylinder(
    x: float, z: float, radius: float, position: Vector, direction: Vector
) -> tuple[float, float]:
    r"""Return the distance to a cylinder along y from outside, and the cosine of incidence there.

    With the distance m' to half way along the chord and the distance b of the ray from the axis,
    both in the cross section,

    .. math:: d = (m' - h) / \lVert v_\parallel \rVert, \quad h^2 = (r - b)(r + b)

    (thesis fig. 3; its :math:`h^2 = r^2 - |x|^2 + m^2` is the same without cancelling large
    squares), and :math:`\cos\theta_i = h \lVert v_\parallel \rVert / r`.

    Parameters
    ----------
    x, z, radius : float
        Axis and radius of the cylinder, µm.
    position, direction : Vector
        Point on the ray (µm) and its unit direction.

    Returns
    -------
    distance, cos_i : float
        Distance in µm, infinite if the ray misses (a tangent ray does).
    """
    to_x, to_z = x - position.x, z - position.z
    across = math.sqrt(direction.x * direction.x + direction.z * direction.z)
    middle = to_x * direction.x + to_z * direction.z
    offset = (to_x * direction.z - to_z * direction.x) / across
    h_squared = (radius - offset) * (radius + offset)
    h = math.sqrt(max(h_squared, 0.0))
    distance = (middle / across - h) / across
    return (distance if middle > 0 and h_squared > 0 else math.inf), h * across / radius


@register_jitable(forceinline=True)
def cross_cylinder(
    x: float, z: float, radius: float, position: Vector, direction: Vector
) -> tuple[float, float]:
    r"""Return the distance from a point on a cylinder, through its inside, to its far side.

    .. math:: d = 2 m' / \lVert v_\parallel \rVert

    as h equals m' for a ray that stands on the cylinder. Arguments and results as in
    `enter_cylinder`; infinite if the ray does not head inwards.
    """
    middle = (x - position.x) * direction.x + (z - position.z) * direction.z
    across_squared = direction.x * direction.x + direction.z * direction.z
    return (2 * middle / across_squared if middle > 0 else math.inf), middle / radius


@register_jitable(forceinline=True)
def leave_cylinder(
    x: float, z: float, radius: float, position: Vector, direction: Vector
) -> tuple[float, float]:
    r"""Return the distance from anywhere inside a cylinder along y to its wall.

    .. math:: d = (m' + h) / \lVert v_\parallel \rVert

    Arguments and results as in `enter_cylinder`; infinite for a ray along the axis.
    """
    to_x, to_z = x - position.x, z - position.z
    across = math.sqrt(direction.x * direction.x + direction.z * direction.z)
    middle = (to_x * direction.x + to_z * direction.z) / across
    offset = (to_x * direction.z - to_z * direction.x) / across
    h_squared = (radius - offset) * (radius + offset)
    h = math.sqrt(max(h_squared, 0.0))
    distance = max(middle + h, 0.0) / across
    return (distance if h_squared > 0 else math.inf), h * across / radius


@register_jitable(forceinline=True)
def cylinder_normal(x: float, z: float, curvature: float, position: Vector) -> Vector:
    """Return the normal of a cylinder at a point on it, of a length of nearly 1.

    Parameters
    ----------
    x, z : float
        Axis of the cylinder, µm.
    curvature : float
        1 / radius for the normal on the outside, −1 / radius for that on the inside, 1/µm.
    position : Vector
        The point, µm.
    """
    return Vector((position.x - x) * curvature, 0.0, (position.z - z) * curvature)
