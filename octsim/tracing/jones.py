"""Rays that carry fields: of two orthogonal polarisations of the light that goes in."""

import math

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.optics.interface import Vector, unit
from octsim.optics.intersection import plane_normal
from octsim.optics.vectorial import (
    Field,
    coefficients,
    cos_transmitted,
    enter_objective,
    leave_objective,
    reflect_field,
    transmit_field,
)
from octsim.tracing.carry import Carry
from octsim.tracing.faces import Faces, Kind, is_flat
from octsim.tracing.kernel import make_tree
from octsim.tracing.lanes import CARRIED, LANES, Block, Lanes, direction, position
from octsim.tracing.meet import axis_of, normal_from

SIZE = 12
"""Numbers of a ray: x, y and z of its field, of each the light that went in along x and y, of each
a real and an imaginary part."""
# all places are constants where they are used: the compiler does not see through a function's
# argument that stores to several places do not overlap
_XX, _XX_IMAG, _XY, _XY_IMAG = (CARRIED + c * LANES for c in range(4))
_YX, _YX_IMAG, _YY, _YY_IMAG = (CARRIED + c * LANES for c in range(4, 8))
_ZX, _ZX_IMAG, _ZY, _ZY_IMAG = (CARRIED + c * LANES for c in range(8, 12))


@register_jitable(forceinline=True)
def _fields(block: Block, i: int) -> tuple[Field, Field]:
    """Return the fields of lane i, of light that went in along x and along y."""
    return (
        Field(
            Vector(block[_XX + i], block[_YX + i], block[_ZX + i]),
            Vector(block[_XX_IMAG + i], block[_YX_IMAG + i], block[_ZX_IMAG + i]),
        ),
        Field(
            Vector(block[_XY + i], block[_YY + i], block[_ZY + i]),
            Vector(block[_XY_IMAG + i], block[_YY_IMAG + i], block[_ZY_IMAG + i]),
        ),
    )


@register_jitable(forceinline=True)
def _fill(block: Block, i: int, x: Field, y: Field) -> None:
    """Have lane i carry the fields of light that went in along x and along y."""
    block[_XX + i], block[_XX_IMAG + i] = x.real.x, x.imag.x
    block[_XY + i], block[_XY_IMAG + i] = y.real.x, y.imag.x
    block[_YX + i], block[_YX_IMAG + i] = x.real.y, x.imag.y
    block[_YY + i], block[_YY_IMAG + i] = y.real.y, y.imag.y
    block[_ZX + i], block[_ZX_IMAG + i] = x.real.z, x.imag.z
    block[_ZY + i], block[_ZY_IMAG + i] = y.real.z, y.imag.z


@register_jitable(forceinline=True)
def _launch(block: Block, i: int) -> None:
    none = Vector(0.0, 0.0, 0.0)
    x, y = enter_objective(direction(block, i))
    _fill(block, i, Field(x, none), Field(y, none))


@register_jitable(forceinline=True)
def _move(
    _faces: Faces, _region: int, block: Block, i: int, _distance: float, to: Block, k: int
) -> None:
    x, y = _fields(block, i)
    _fill(to, k, x, y)


@register_jitable(forceinline=True)
def _split_lane(
    n_i: float, n_t: float, met: Block, i: int, normal: Vector, cos_i: float, beyond: Block
) -> None:
    along = direction(met, i)
    by = coefficients(n_i, n_t, cos_i, cos_transmitted(n_i, n_t, cos_i))
    x, y = _fields(met, i)
    through_x = transmit_field(x, along, normal, by)
    through_y = transmit_field(y, along, normal, by)
    _fill(beyond, i, through_x, through_y)
    back_x = reflect_field(x, along, normal, cos_i, by)
    back_y = reflect_field(y, along, normal, cos_i, by)
    _fill(met, i, back_x, back_y)


@register_jitable(forceinline=True)
def split(
    faces: Faces, f: int, met: Block, n: int, cos_i: Lanes, _cos_t: Lanes, beyond: Block
) -> None:
    """Split the fields of n lanes at the face that they have met.

    Its name is that of the block's own split, for the compiler: a tree has what is called so
    optimised by itself too, without which these loops would not be computed in lanes.
    """
    kind, shape = faces.kind[f], faces.shape[f]
    n_i, n_t = faces.n_i[f], faces.n_t[f]
    if is_flat(kind):
        normal = plane_normal(kind == Kind.PLANE_FROM_ABOVE)
        for i in range(n):
            _split_lane(n_i, n_t, met, i, normal, cos_i[i], beyond)
    else:
        axis = axis_of(faces, f)
        curvature = (1.0 if kind == Kind.CYLINDER_FROM_OUTSIDE else -1.0) / shape[2]
        for i in range(n):
            normal = unit(normal_from(axis, curvature, position(met, i)))
            _split_lane(n_i, n_t, met, i, normal, cos_i[i], beyond)


@register_jitable(forceinline=True)
def _strength(block: Block, i: int) -> float:
    squared = 0.0
    for c in range(SIZE):
        squared += block[CARRIED + c * LANES + i] * block[CARRIED + c * LANES + i]
    return math.sqrt(0.5 * squared)


FIELD = Carry(SIZE, _launch, _move, split, _strength)
"""The fields of light that goes in along x and along y, relative to those at launch."""
trace_fields = make_tree(FIELD)
"""The tree of polarised light."""


def jones_of(
    carried: NDArray[np.float64], vx: NDArray[np.float64], vy: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Return the Jones matrices of rays that arrive, behind the objective.

    Parameters
    ----------
    carried : ndarray, shape (12, D)
        What they carry, of a tree of `FIELD`.
    vx, vy : ndarray, shape (D,)
        Their unit directions; they head down.

    Returns
    -------
    ndarray, shape (D, 2, 2)
        Detected x and y, in the laboratory, of light that went in along x and along y.
    """
    parts = carried.reshape(3, 2, 2, -1)  # component, input, part, ray
    fields = parts[:, :, 0] + 1j * parts[:, :, 1]
    vz = -np.sqrt(1 - vx * vx - vy * vy)
    detected = leave_objective(Vector(vx, vy, vz), Vector(*fields))  # type: ignore[arg-type]
    return np.stack(detected).transpose(2, 0, 1).copy()
