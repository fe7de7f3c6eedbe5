r"""Fields as vectors in space: at an interface, and into and out of an objective.

Fields are :math:`e^{-i\omega t}`. An interface treats the part of a field along
:math:`\hat s = \hat v_i \times \hat n / \sin\theta_i` and that along
:math:`\hat p = \hat v \times \hat s` each in its own way; each of the three rays has its own p.
Written out, nothing is left of s and p but the normal and the directions, and no division by
:math:`\sin\theta_i`: at normal incidence, where s can be any direction, nothing is special.
"""

import math
from typing import NamedTuple

from numba.extending import register_jitable

from octsim.optics.interface import Vector, cos_transmitted_squared


class Field(NamedTuple):
    """A complex vector in space."""

    real: Vector
    imag: Vector


class Coefficients(NamedTuple):
    """What an interface does to the amplitudes of fields."""

    r_s: complex
    r_p: complex
    t_s: complex
    t_p: complex
    tilt: complex
    r"""What turns the p parts with their rays,
    :math:`\cos\theta_i (r_s + r_p) / \sin^2\theta_i
    = (t_s \cos\theta_i - t_p \cos\theta_t) / \sin^2\theta_i`."""


@register_jitable(forceinline=True)
def cos_transmitted(n_i: float, n_t: float, cos_i: float) -> complex:
    r"""Return the cosine of the angle of refraction, also beyond the critical angle.

    .. math:: \cos\theta_t = i \sqrt{\sin^2\theta_t - 1}

    there, by which fields :math:`e^{-i\omega t}` fade away from the interface.
    """
    squared = cos_transmitted_squared(n_i, n_t, cos_i)
    return complex(math.sqrt(max(squared, 0.0)), math.sqrt(max(-squared, 0.0)))


@register_jitable(forceinline=True)
def _inverse(z: complex) -> complex:
    """Return 1 / z, without the choices of a division that minds the largest of numbers."""
    over = 1 / (z.real * z.real + z.imag * z.imag)
    return complex(z.real * over, -z.imag * over)


@register_jitable(forceinline=True)
def coefficients(n_i: float, n_t: float, cos_i: float, cos_t: complex) -> Coefficients:
    r"""Return the amplitude coefficients of an interface.

    .. math::
        r_s = \frac{n_i\cos\theta_i - n_t\cos\theta_t}{n_i\cos\theta_i + n_t\cos\theta_t}, \quad
        r_p = \frac{n_t\cos\theta_i - n_i\cos\theta_t}{n_t\cos\theta_i + n_i\cos\theta_t}, \quad
        t_s = \frac{2 n_i\cos\theta_i}{n_i\cos\theta_i + n_t\cos\theta_t}, \quad
        t_p = \frac{2 n_i\cos\theta_i}{n_t\cos\theta_i + n_i\cos\theta_t}

    (Hecht, Optics, §4.6; :math:`r_p = -r_s` at normal incidence). Small differences are taken
    without cancelling, :math:`r_s` as in `octsim.optics.interface.fresnel`, and :math:`r_p` from

    .. math:: \frac{\cos\theta_i (r_s + r_p)}{\sin^2\theta_i} =
              \frac{2 n_i\cos\theta_i (n_i - n_t)(n_i + n_t)}
              {n_t (n_i\cos\theta_i + n_t\cos\theta_t)(n_t\cos\theta_i + n_i\cos\theta_t)}

    Parameters
    ----------
    n_i, n_t : float
        Refractive indices on the side of incidence and on the other.
    cos_i : float
        Cosine of the angle of incidence, > 0.
    cos_t : complex
        That of refraction, from `cos_transmitted`.

    Returns
    -------
    Coefficients
        Energy: :math:`|r|^2 + n_t \Re\cos\theta_t / (n_i\cos\theta_i) |t|^2 = 1`. Beyond the
        critical angle :math:`|r| = 1`, and t is that of the field at the interface, which no ray
        follows.
    """
    # part by part: a product of a real and a complex number would be one of two complex ones
    over_s = _inverse(complex(n_i * cos_i + n_t * cos_t.real, n_t * cos_t.imag))
    over_p = _inverse(complex(n_t * cos_i + n_i * cos_t.real, n_i * cos_t.imag))
    squared, both = over_s * over_s, over_s * over_p
    contrast, through = (n_i - n_t) * (n_i + n_t), 2 * n_i * cos_i
    of_tilt, over_cos = through * contrast / n_t, (1 - cos_i) * (1 + cos_i) / cos_i
    tilt = complex(of_tilt * both.real, of_tilt * both.imag)
    # without cancelling; where r is large the plain form keeps the energy to the last digit
    r_s = complex(contrast * squared.real, contrast * squared.imag)
    r_p = complex(over_cos * tilt.real - r_s.real, over_cos * tilt.imag - r_s.imag)
    small = r_s.real * r_s.real + r_s.imag * r_s.imag < 0.0625
    plain_s = complex(n_i * cos_i - n_t * cos_t.real, -n_t * cos_t.imag) * over_s
    plain_p = complex(n_t * cos_i - n_i * cos_t.real, -n_i * cos_t.imag) * over_p
    return Coefficients(
        complex(r_s.real if small else plain_s.real, r_s.imag if small else plain_s.imag),
        complex(r_p.real if small else plain_p.real, r_p.imag if small else plain_p.imag),
        complex(through * over_s.real, through * over_s.imag),
        complex(through * over_p.real, through * over_p.imag),
        tilt,
    )


@register_jitable(forceinline=True)
def _dot(a: Vector, b: Vector) -> float:
    return a.x * b.x + a.y * b.y + a.z * b.z


@register_jitable(forceinline=True)
def _sum(a: float, u: Vector, b: float, v: Vector) -> Vector:
    """Return a u + b v."""
    return Vector(a * u.x + b * v.x, a * u.y + b * v.y, a * u.z + b * v.z)


@register_jitable(forceinline=True)
def _less(u: Vector, a: float, v: Vector, b: float, w: Vector) -> Vector:
    """Return u − a v − b w."""
    return Vector(
        u.x - a * v.x - b * w.x,
        u.y - a * v.y - b * w.y,
        u.z - a * v.z - b * w.z,
    )


@register_jitable(forceinline=True)
def reflect_field(
    field: Field, direction: Vector, normal: Vector, cos_i: float, by: Coefficients
) -> Field:
    r"""Return the field of a reflected ray.

    .. math:: E_r = r_s (\hat s \cdot E) \hat s + r_p (\hat p_i \cdot E) \hat p_r
                  = r_s E - (\hat n \cdot E) \Big[ (r_s - r_p) \hat n
                  + \frac{\cos\theta_i (r_s + r_p)}{\sin^2\theta_i}
                  (\hat v_i + \cos\theta_i \hat n) \Big]

    as :math:`\hat v_i \cdot E = 0`.

    Parameters
    ----------
    field : Field
        Of the incident ray.
    direction, normal : Vector
        Unit vectors along the incident ray, and normal to the interface on its side.
    cos_i : float
        Cosine of the angle of incidence.
    by : Coefficients
        Of the interface.
    """
    r, tilt = by.r_s, by.tilt
    difference = by.r_s - by.r_p
    real, imag = _dot(normal, field.real), _dot(normal, field.imag)
    in_plane = _sum(1.0, direction, cos_i, normal)
    return Field(
        _less(
            _sum(r.real, field.real, -r.imag, field.imag),
            difference.real * real - difference.imag * imag, normal,
            tilt.real * real - tilt.imag * imag, in_plane,
        ),
        _less(
            _sum(r.real, field.imag, r.imag, field.real),
            difference.real * imag + difference.imag * real, normal,
            tilt.real * imag + tilt.imag * real, in_plane,
        ),
    )  # fmt: skip


@register_jitable(forceinline=True)
def transmit_field(field: Field, direction: Vector, normal: Vector, by: Coefficients) -> Field:
    r"""Return the field of a transmitted ray, below the critical angle: its factors are real.

    .. math:: E_t = t_s (\hat s \cdot E) \hat s + t_p (\hat p_i \cdot E) \hat p_t
                  = t_s E - \frac{t_s \cos\theta_i - t_p \cos\theta_t}{\sin^2\theta_i}
                  (\hat n \cdot E) \hat v_i

    Arguments as in `reflect_field`.
    """
    t, tilt = by.t_s.real, by.tilt.real
    return Field(
        _sum(t, field.real, -tilt * _dot(normal, field.real), direction),
        _sum(t, field.imag, -tilt * _dot(normal, field.imag), direction),
    )


@register_jitable(forceinline=True)
def enter_objective(direction: Vector) -> tuple[Vector, Vector]:
    r"""Return the fields that an objective makes of collimated light along x, and along y.

    .. math:: E = e - \frac{e \cdot \hat v}{1 + v_z} (\hat z + \hat v)

    The collimated light heads up; the least rotation from there to the ray's direction keeps the
    azimuthal part of a field and turns the radial one (Richards & Wolf 1959). Its amplitude stays.

    Parameters
    ----------
    direction : Vector
        Unit vector along the ray, which heads up.
    """
    v, over = direction, 1 / (1 + direction.z)
    mixed = -v.x * v.y * over
    return (
        Vector(1 - v.x * v.x * over, mixed, -v.x),
        Vector(mixed, 1 - v.y * v.y * over, -v.y),
    )


@register_jitable(forceinline=True)
def leave_objective(direction: Vector, field: Vector) -> tuple[float, float]:
    r"""Return the field along x and y, in the laboratory, that an objective makes of a ray's.

    .. math:: e = E - \frac{E_z}{1 - v_z} (\hat z - \hat v)

    As `enter_objective`, for light that returns: the least rotation from the ray's direction to
    straight down.

    Parameters
    ----------
    direction : Vector
        Unit vector along the ray, which heads down.
    field : Vector
        Its field; complex numbers will do too, and arrays of rays.
    """
    along = field.z / (1 - direction.z)
    return field.x + along * direction.x, field.y + along * direction.y
