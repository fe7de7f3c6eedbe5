"""Reflection, refraction and Fresnel coefficients: the only place where these formulas stand.

Each function is plain Python on floats; compiled code calls the same source.
"""

import math
from typing import NamedTuple

from numba.extending import register_jitable


class Vector(NamedTuple):
    """A vector in space (x, y, z)."""

    x: float
    y: float
    z: float


@register_jitable(forceinline=True)
def reflect(direction: Vector, normal: Vector, cos_i: float) -> Vector:
    r"""Return a direction turned by the law of reflection.

    .. math:: \hat v_r = \hat v_i - 2 (\hat v_i \cdot \hat n) \hat n

    (thesis §4.3.1), with :math:`\hat v_i \cdot \hat n = -\cos\theta_i`.

    Parameters
    ----------
    direction : Vector
        Unit vector along the incident ray.
    normal : Vector
        Unit normal on the side that the ray comes from.
    cos_i : float
        Cosine of the angle of incidence, ≥ 0.

    Returns
    -------
    Vector
        Unit vector along the reflected ray.
    """
    twice = 2 * cos_i
    return Vector(
        direction.x + twice * normal.x,
        direction.y + twice * normal.y,
        direction.z + twice * normal.z,
    )


@register_jitable(forceinline=True)
def cos_transmitted_squared(n_i: float, n_t: float, cos_i: float) -> float:
    r"""Return the squared cosine of the angle of refraction; negative beyond the critical angle.

    .. math:: \cos^2\theta_t = 1 - \eta^2 (1 - \cos^2\theta_i)
                             = (n_t - n_i)(n_t + n_i) / n_t^2 + \eta^2\cos^2\theta_i,
              \quad \eta = n_i / n_t

    Snell's law (thesis §4.3.1). The second form has no cancellation for :math:`\eta \le 1` and is
    exactly :math:`\cos^2\theta_i` where the indices are equal; where they nearly are, their
    difference is exact, which that of η from 1 is not.
    """
    eta = n_i / n_t
    return (n_t - n_i) * (n_t + n_i) / (n_t * n_t) + eta * eta * cos_i * cos_i


@register_jitable(forceinline=True)
def refract(
    direction: Vector, normal: Vector, n_i: float, n_t: float, cos_i: float, cos_t: float
) -> Vector:
    r"""Return a direction turned by Snell's law.

    .. math:: \hat v_t = -\cos\theta_t \hat n + \eta\, \hat n \times (\hat v_i \times \hat n)
                       = \eta \hat v_i + (\eta\cos\theta_i - \cos\theta_t) \hat n

    (thesis §4.3.1). Arguments as in `reflect`; `cos_t` is the cosine of the angle of refraction.
    """
    eta = n_i / n_t
    along = eta * cos_i - cos_t
    return Vector(
        eta * direction.x + along * normal.x,
        eta * direction.y + along * normal.y,
        eta * direction.z + along * normal.z,
    )


@register_jitable(forceinline=True)
def unit(direction: Vector) -> Vector:
    r"""Return a direction without what rounding has added to its length, of nearly 1.

    .. math:: \hat v = \tfrac12 (3 - |v|^2)\, v

    One step of Newton's for :math:`1 / |v|`: an error δ of the length becomes one of about δ².
    """
    x, y, z = direction.x, direction.y, direction.z
    scale = 1.5 - 0.5 * (x * x + y * y + z * z)
    return Vector(scale * x, scale * y, scale * z)


@register_jitable(forceinline=True)
def fresnel(n_i: float, n_t: float, cos_i: float, cos_t: float) -> tuple[float, float]:
    r"""Return the amplitude coefficients of reflection and transmission for unpolarised light.

    .. math::
        r = \pm\sqrt{\tfrac12 (r_\parallel^2 + r_\perp^2)}, \quad
        t = \sqrt{\tfrac12 (t_\parallel^2 + t_\perp^2)}

    (thesis §4.3.2); r is negative for :math:`n_t > n_i`. Below the critical angle only: beyond it
    r = 1 and nothing is transmitted. By Snell's law the differences in r are, without cancelling
    where the indices are nearly equal,

    .. math::
        r_\perp = \frac{(n_i - n_t)(n_i + n_t)}{(n_i\cos\theta_i + n_t\cos\theta_t)^2}, \quad
        r_\parallel = \frac{(n_t - n_i)(n_t + n_i)(\cos^2\theta_i + \cos^2\theta_t - 1)}
                           {(n_t\cos\theta_i + n_i\cos\theta_t)^2}

    Parameters
    ----------
    n_i, n_t : float
        Refractive indices on the side of incidence and on the other.
    cos_i, cos_t : float
        Cosines of the angles of incidence and refraction, `cos_i` > 0, `cos_t` ≥ 0.

    Returns
    -------
    r, t : float
        Factors on the amplitude. Energy: r² + (n_t cos_t)/(n_i cos_i) t² = 1.
    """
    over_parallel = 1 / (n_t * cos_i + n_i * cos_t)
    over_perpendicular = 1 / (n_i * cos_i + n_t * cos_t)
    contrast = (n_i - n_t) * (n_i + n_t)
    brewster = cos_i * cos_i + cos_t * cos_t - 1  # zero where nothing of it is reflected
    r_parallel = contrast * brewster * (over_parallel * over_parallel)
    r_perpendicular = contrast * (over_perpendicular * over_perpendicular)
    t_parallel = 2 * n_i * cos_i * over_parallel
    t_perpendicular = 2 * n_i * cos_i * over_perpendicular
    r = math.sqrt(0.5 * (r_parallel * r_parallel + r_perpendicular * r_perpendicular))
    t = math.sqrt(0.5 * (t_parallel * t_parallel + t_perpendicular * t_perpendicular))
    return (-r if n_t > n_i else r), t
