r"""A cylinder in shells: which waves it scatters of those that reach it.

In each shell the field is :math:`F = c J(\kappa r) + d H(\kappa r)`, and within the core J alone.
What holds for F and its derivative F′ (by the argument) at a radius,

.. math:: p F + q F' = 0,

with 2 × 2 matrices p and q for :math:`(E_y, Z_0 H_y)`, is found from the core outwards. It is
homogeneous, and what it says of waves that grow outwards is kept as it grows: no function of high
order needs to be more than in proportion to its like. Over a surface :math:`(E_\phi, H_\phi)` are
continuous,

.. math:: G = \alpha F + S F', \quad S = \frac1\kappa
    \begin{pmatrix} 0 & 1 \\ -\varepsilon & 0 \end{pmatrix}.
"""

from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.schemes.fullwave.bessel import Cylindrical, Kinds, kinds
from octsim.schemes.fullwave.cylinder import (
    UNIT,
    Interface,
    Scattering,
    Side,
    debye_terms,
    interface,
    scattering,
    side_of,
)
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.orders import waves_along
from octsim.schemes.fullwave.two_by_two import matrix, solved, times

Array = NDArray[Any]
_AT_ONCE = 2000
"""Matrices."""


class _Surface(NamedTuple):
    """One of a cylinder's, and the waves on both sides of it."""

    outside: Side
    inside: Side
    around: Kinds
    """Outside."""
    within: Kinds
    """Inside."""


def scattering_of(
    scene: CylinderOnPlane, along: NDArray[np.float64], k: NDArray[np.float64], waves: int
) -> Scattering:
    """Return the matrices of a cylinder, with shells or without, (2, 2, K, Y, M + 1).

    Parameters are those of `octsim.schemes.fullwave.cylinder.scattering`.
    """
    if not scene.shells:
        return scattering(scene, along, k, waves)
    # a part of the wavenumbers at a time, so that what is worked with stays in fast memory
    step = max(1, _AT_ONCE // (along.size * (waves + 1)))
    with np.errstate(over="ignore", invalid="ignore", divide="ignore", under="ignore"):
        surfaces = _surfaces(scene, along, k, waves)
        parts = [
            _matrices([_part(one, slice(begin, begin + step)) for one in surfaces])
            for begin in range(0, k.size, step)
        ]
    kept = np.arange(waves + 1) <= waves_along(scene, along, k, waves)[..., np.newaxis]
    # functions of high orders leave what a number can be, deep within
    found = (np.concatenate(each, axis=2) for each in zip(*parts, strict=True))
    return Scattering(*(np.where(kept & np.isfinite(one), one, 0) for one in found))


def _matrices(surfaces: list[_Surface]) -> Scattering:
    p, q = _condition(surfaces)
    outer = surfaces[0].around
    whole = -solved(_left(p, q, outer.outgoing), _left(p, q, outer.regular))
    return Scattering(whole, *_debye(surfaces))


def _surfaces(
    scene: CylinderOnPlane, along: NDArray[np.float64], k: NDArray[np.float64], waves: int
) -> list[_Surface]:
    """Return the surfaces, outside in."""
    core = complex(scene.n_neuron, scene.kappa) if scene.kappa else scene.n_neuron
    indices = (scene.n_water, *(shell.n for shell in scene.shells), core)
    inwards = accumulate((-shell.thickness for shell in scene.shells), initial=scene.radius)
    sides, sizes = [], []
    for radius, *media in zip(inwards, indices[:-1], indices[1:], strict=True):
        for n in media:
            sides.append(side_of(n, along, k, waves, radius))
            sizes.append(radius * k[:, np.newaxis] * sides[-1].kappa)
    both = zip(sides, _kinds(sizes, waves), strict=True)
    return [
        _Surface(outside, inside, around, within)
        for (outside, around), (inside, within) in zip(both, both, strict=True)
    ]


def _kinds(sizes: list[Array], waves: int) -> list[Kinds]:
    """Return the functions of several arguments; of all that are real at once, for speed."""
    real = [number for number, size in enumerate(sizes) if np.isrealobj(size)]
    found = {n: kinds(sizes[n], waves) for n in range(len(sizes)) if n not in real}
    if real:
        every = kinds(np.stack([sizes[number] for number in real]), waves)
        for place, number in enumerate(real):
            found[number] = Kinds(*(_each(kind, place) for kind in every))
    return [found[number] for number in range(len(sizes))]


def _each(one: Cylindrical, part: Any) -> Cylindrical:
    return Cylindrical(one.value[part], one.slope[part])


def _part(surface: _Surface, part: slice) -> _Surface:
    """Return a surface at some of the wavenumbers."""
    outside, inside = (side._replace(skew=side.skew[part]) for side in surface[:2])
    around, within = (Kinds(*(_each(kind, part) for kind in kinds)) for kinds in surface[2:])
    return _Surface(outside, inside, around, within)


def _condition(surfaces: list[_Surface]) -> tuple[Array, Array]:
    """Return p and q around the outermost surface."""
    core = surfaces[-1].within.regular
    p, q = _regular(core)
    for number in range(len(surfaces) - 1, -1, -1):
        here = surfaces[number]
        p, q = _across(p, q, here.inside, here.outside)
        if number:
            further = surfaces[number - 1].within
            p, q = _outwards(p, q, here.around, further)
        p, q = _of_size_one(p, q)
    return p, q


def _regular(one: Cylindrical) -> tuple[Array, Array]:
    """Return the condition that the field is J: J F′ = J′ F."""
    nothing = np.zeros_like(one.value)
    return (
        matrix(-one.slope, nothing, nothing, -one.slope),
        matrix(one.value, nothing, nothing, one.value),
    )


def _across(p: Array, q: Array, inside: Side, outside: Side) -> tuple[Array, Array]:
    """Return the condition on the other side of a surface: S and α are other ones there."""
    ratio = (inside.kappa / outside.kappa)[:, np.newaxis]
    # q S₃⁻¹ S₂
    turned = np.stack((q[:, 0] * (outside.n**2 / inside.n**2 * ratio), q[:, 1] * ratio), axis=1)
    inverse = inside.kappa[:, np.newaxis]
    # q S₃⁻¹, of which the difference of α is taken
    by_field = np.stack((q[:, 1] * inverse, q[:, 0] * (-inverse / inside.n**2)), axis=1)
    return p + by_field * (outside.skew - inside.skew), turned


def _outwards(p: Array, q: Array, near: Kinds, far: Kinds) -> tuple[Array, Array]:
    """Return the condition at the outer radius of a shell from that at its inner one.

    (F, F′) there is, but for a factor, the cross products of J and H, here and there.
    """
    (j_1, of_j_1), (j_2, of_j_2) = (_scaled(kind.regular) for kind in (near, far))
    (h_1, of_h_1), (h_2, of_h_2) = (_scaled(_other(kind)) for kind in (near, far))
    # of J inside and H outside there is as much less than of the others as their sizes differ
    less = np.ldexp(1.0, np.clip(of_j_1 + of_h_2 - of_h_1 - of_j_2, -1100, 1000))
    a = less * (j_1.value * h_2.slope) - h_1.value * j_2.slope
    b = h_1.value * j_2.value - less * (j_1.value * h_2.value)
    c = less * (j_1.slope * h_2.slope) - h_1.slope * j_2.slope
    d = h_1.slope * j_2.value - less * (j_1.slope * h_2.value)
    outer = p * a + q * c, p * b + q * d
    # where nothing of the inside is felt, the field is regular
    alone = _regular(j_2)
    size = sum(np.abs(one).sum(axis=(0, 1)) for one in outer)
    felt = np.isfinite(size) & (size > 0)
    return np.where(felt, outer[0], alone[0]), np.where(felt, outer[1], alone[1])


def _other(kind: Kinds) -> Cylindrical:
    """Return a second solution: H, or where all is real, Y."""
    if np.isrealobj(kind.regular.value):
        return Cylindrical(kind.outgoing.value.imag, kind.outgoing.slope.imag)
    return kind.outgoing


def _scaled(one: Cylindrical) -> tuple[Cylindrical, NDArray[np.int64]]:
    """Return a function over its size, a power of two, and that power."""
    _, exponent = np.frexp(np.hypot(np.abs(one.value), np.abs(one.slope)))
    power = exponent.astype(np.int64)
    half = np.ldexp(1.0, -(power // 2))
    rest = np.ldexp(1.0, -(power - power // 2))
    return Cylindrical(one.value * half * rest, one.slope * half * rest), power


def _of_size_one(p: Array, q: Array) -> tuple[Array, Array]:
    """Return a condition over its size, by a power of two."""
    _, exponent = np.frexp(np.maximum(np.abs(p).max(axis=(0, 1)), np.abs(q).max(axis=(0, 1))))
    scale = np.ldexp(1.0, -exponent)
    return p * scale, q * scale


def _left(p: Array, q: Array, one: Cylindrical) -> Array:
    """Return what a wave leaves of a condition that it does not meet."""
    found: Array = p * one.value + q * one.slope
    return found


def _debye(surfaces: list[_Surface]) -> tuple[Array, Array]:
    """Return the terms p = 0, with diffraction, and p = 2, all shells taken for one surface.

    What it reflects and lets through, from outside and from inside, is found from the innermost
    surface on, with all that goes to and fro in the shells.
    """
    outside, inside, into, out = interface(*surfaces[-1])
    for number in range(len(surfaces) - 2, -1, -1):
        near, beyond = surfaces[number], surfaces[number + 1]
        # waves that go in, and out, from one surface to the other
        inwards = beyond.around.incoming.value / near.within.incoming.value
        outwards = near.within.outgoing.value / beyond.around.outgoing.value
        r_outside, r_inside, t_into, t_out = interface(*near)
        back = outside * (inwards * outwards)
        fro = solved(UNIT - times(r_inside, back), t_into)
        to = times(t_out, solved(UNIT - times(back, r_inside), out * outwards))
        passed = times(into, solved(UNIT - times(r_inside, back), times(r_inside, out)))
        outside = r_outside + times(times(t_out, back), fro)
        inside = inside + passed * (inwards * outwards)
        into, out = times(into, fro) * inwards, to
    whole = Interface(outside, inside, into, out)
    return debye_terms(whole, surfaces[0].around, surfaces[-1].within)
