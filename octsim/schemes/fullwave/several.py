r"""The field of several parallel cylinders, each with its own waves: one linear system.

.. math:: b_c = T_c \Big(a_c + \sum_{c'} R_{cc'} b_{c'}\Big)

of all orders of both signs, as nothing of it need be symmetric in x, for each k and k_y > 0; in y
it is, as for one cylinder.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.optics.pupil import Pupil
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.illumination import Wavefront, illumination
from octsim.schemes.fullwave.neighbours import (
    Between,
    Step,
    back_to_itself,
    between,
    to_another,
    write,
)
from octsim.schemes.fullwave.operators import Operators, along_nodes
from octsim.schemes.fullwave.orders import Orders
from octsim.schemes.fullwave.shells import scattering_of
from octsim.schemes.fullwave.slab import parities

Array = NDArray[Any]
_SIGN = ((-1, 1), (1, -1))
"""What −k_y makes of E_y and H_y of light polarised across, and along."""
_ITERATIONS = 60
_TURNS = 1 / 16
"""Nodes between cylinders, over those of one's own, by which there are more for each k times the
distance across."""


class Lights(NamedTuple):
    """What lights the cylinders, and is detected."""

    pupil: Pupil
    aperture: float
    focus: float
    wavefront: Wavefront | None


class Collected(NamedTuple):
    """What the detector collects of cylinders, not over the norm yet."""

    terms: Array
    """Of all of it, of the near sides, and of the far sides, (3, 2, K)."""
    multiplications: float
    """Complex ones that it took, about."""


class Together(NamedTuple):
    """What neither focus nor pupil matters to, at K wavenumbers and Y components k_y > 0."""

    along: NDArray[np.float64]
    """k_y / k, (Y,)."""
    along_weight: NDArray[np.float64]
    waves: list[int]
    """Largest order of each cylinder."""
    matrices: list[list[Array]]
    """T of each, its terms, (K, Y, 2, 2, 2M + 1)."""
    reached: list[list[list[Between]]]
    """At each wavenumber, of each cylinder: what it gets from each."""
    multiplications: float
    """Complex ones that it took, about."""


def several(
    cylinders: tuple[CylinderOnPlane, ...],
    lights: Lights,
    k: NDArray[np.float64],
    orders: Orders,
    tolerance: float,
    operators: Operators,
) -> Collected:
    """Return what the detector collects of cylinders that scatter to each other.

    Parameters
    ----------
    cylinders : tuple of CylinderOnPlane
        Among the same planes.
    lights : Lights
    k : ndarray, shape (K,)
        Wavenumbers, 1/µm.
    orders : Orders
        Of the largest cylinder.
    tolerance : float
        Of what goes to and fro.
    operators : Operators
        Those kept.
    """
    kept = operators.kept(
        (cylinders, lights.aperture, k.tobytes(), orders._replace(across=0)),
        lambda: together(cylinders, lights.aperture, k, orders),
    )
    along, waves = kept.along, kept.waves
    lit = [
        _regular(one, lights, along, k, m, orders) for one, m in zip(cylinders, waves, strict=True)
    ]
    epsilon = cylinders[0].n_water ** 2
    measure = kept.along_weight * 2 / (np.pi * (epsilon - along**2))
    collected = np.zeros((3, 2, k.size), np.complex128)
    taken = kept.multiplications
    for number in range(k.size):
        regular = np.concatenate([_flat(one[:, number]) for one in lit], axis=-1)
        whole = [t[0][number] for t in kept.matrices]
        back = _whole_matrix(kept.reached[number], waves)
        incoming, steps = _incoming(back, whole, regular, tolerance)
        taken += along.size * steps * back.shape[-1] ** 2
        place = 0
        for one, t, m in zip(lit, kept.matrices, waves, strict=True):
            width = 2 * (2 * m + 1)
            a = incoming[..., place : place + width].reshape(2, along.size, 2, 2 * m + 1)
            place += width
            turn = np.where(np.arange(-m, m + 1) % 2, -1.0, 1.0)
            for term, matrix in enumerate(t):
                b = np.einsum("yijm,pyjm->pyim", matrix[number], a)
                for polarisation, (of_e, of_h) in enumerate(_SIGN):
                    # the detected mode's, at −m
                    e, h = (part[:, ::-1] for part in one[polarisation, number].swapaxes(0, 1))
                    found = (
                        of_e * epsilon * e * b[polarisation, :, 0]
                        - of_h * h * b[polarisation, :, 1]
                    )
                    collected[term, polarisation, number] += (
                        (found * turn).sum(-1) * measure
                    ).sum()
    return Collected(collected, taken)


def together(
    cylinders: tuple[CylinderOnPlane, ...],
    aperture: float,
    k: NDArray[np.float64],
    orders: Orders,
) -> Together:
    """Return how cylinders scatter, and what goes between them; parameters as of `several`."""
    along, weight = along_nodes(aperture, orders.along)
    waves = _waves_of_each(cylinders, orders.waves)
    matrices = [
        [both_signs(t) for t in scattering_of(one, along, k, m)]
        for one, m in zip(cylinders, waves, strict=True)
    ]
    reached = [_reached(cylinders, along, one, waves, orders) for one in k.tolist()]
    # each of the light that planes send, times its powers, in six sums
    sums = 8 * 4 * max(waves) * orders.contour * len(cylinders) ** 2
    return Together(along, weight, waves, matrices, reached, float(along.size * k.size * sums))


def _waves_of_each(cylinders: tuple[CylinderOnPlane, ...], waves: int) -> list[int]:
    """Return the largest order of each, M of the largest."""
    sizes = [one.radius * one.largest_index for one in cylinders]
    largest = max(sizes)
    # in proportion as far as possible, and never too few for a thin one
    return [
        min(waves, math.ceil(waves * size / largest + (1 - size / largest) * 6)) for size in sizes
    ]


def _regular(
    scene: CylinderOnPlane, lights: Lights, along: NDArray[np.float64], k: NDArray[np.float64],
    waves: int, orders: Orders,
) -> Array:  # fmt: skip
    """Return the pupil's light about a cylinder's axis, (2 polarisations, K, Y, 2, 2M + 1)."""
    found = np.zeros((2, k.size, along.size, 2, 2 * waves + 1), np.complex128)
    for lit in illumination(
        scene, lights.pupil, lights.aperture, lights.focus, along, k, waves, orders.across,
        lights.wavefront,
    ):  # fmt: skip
        for at, (part, parity) in enumerate(zip((lit.e, lit.h), parities(lit.mirror), strict=True)):
            found[lit.polarisation, :, :, at, waves:] += part
            found[lit.polarisation, :, :, at, :waves] += parity * part[..., :0:-1]
    return found


def both_signs(matrix: Array) -> Array:
    """Return T of orders −M … M, (K, Y, 2, 2, 2M + 1): light along turns the other way for −m."""
    mirrored = matrix[..., :0:-1].copy()
    mirrored[0, 1] *= -1
    mirrored[1, 0] *= -1
    return np.moveaxis(np.concatenate([mirrored, matrix], axis=-1), (0, 1), (2, 3))


def _reached(
    cylinders: tuple[CylinderOnPlane, ...], along: NDArray[np.float64], k: float,
    waves: list[int], orders: Orders,
) -> list[list[Between]]:  # fmt: skip
    """Return what each cylinder gets of the outgoing waves of each, itself as well."""
    number = len(cylinders)
    found: dict[tuple[int, int], Between] = {}
    for to in range(number):
        own = back_to_itself(cylinders[to], along, k, waves[to], orders.contour)
        found[to, to] = between(Step(cylinders[to], cylinders[to]), own, along, k, 2 * waves[to])
        for of in range(to):
            step, farthest = Step(cylinders[of], cylinders[to]), waves[to] + waves[of]
            nodes = math.ceil(orders.contour * (1 + _TURNS * k * abs(step.across)))
            by = to_another(step, along, k, farthest, nodes)
            found[to, of] = between(step, by, along, k, farthest)
            found[of, to] = found[to, of].back()
    return [[found[to, of] for of in range(number)] for to in range(number)]


def _whole_matrix(reached: list[list[Between]], waves: list[int]) -> Array:
    """Return R from all outgoing waves to all regular ones, (Y, N, N)."""
    sizes = [2 * (2 * m + 1) for m in waves]
    ends = np.cumsum([0, *sizes])
    found = np.empty((len(reached[0][0].by_sum), ends[-1], ends[-1]), np.complex128)
    for to, row in enumerate(reached):
        for of, one in enumerate(row):
            part = found[:, ends[to] : ends[to + 1], ends[of] : ends[of + 1]]
            write(part, one, waves[to], waves[of])
    return found


def _flat(waves: Array) -> Array:
    return waves.reshape(*waves.shape[:-2], -1)


def _incoming(
    between: Array, whole: list[Array], regular: Array, tolerance: float
) -> tuple[Array, float]:
    """Return all regular waves (2, Y, N), a + R b, and the matrix products that it took.

    Parameters
    ----------
    between : ndarray, shape (Y, N, N)
        R.
    whole : list of ndarray, shape (Y, 2, 2, 2M + 1)
        T of each cylinder.
    regular : ndarray, shape (2, Y, N)
        Of both polarisations.
    tolerance : float
    """
    light = np.moveaxis(regular, 0, -1)
    first = _scattered(whole, light)
    b, before = first, np.inf
    steps, settled = 0.0, False
    for _ in range(_ITERATIONS):
        following = first + _scattered(whole, between @ b)
        change = float(np.abs(following - b).max())
        b, steps = following, steps + 2
        settled = change <= tolerance * float(np.abs(b).max())
        if settled or not change < before:
            break
        before = change
    if not settled:
        b, steps = _by_elimination(between, whole, first), steps + between.shape[-1] / 3
    return np.moveaxis(light + between @ b, -1, 0), steps


def _scattered(whole: list[Array], light: Array) -> Array:
    """Return T of each cylinder times regular waves (Y, N, P)."""
    found, place = np.empty_like(light), 0
    for t in whole:
        half = t.shape[-1]
        e, h = (light[:, place + i * half : place + (i + 1) * half] for i in (0, 1))
        for i in (0, 1):
            part = t[:, i, 0, :, np.newaxis] * e + t[:, i, 1, :, np.newaxis] * h
            found[:, place + i * half : place + (i + 1) * half] = part
        place += 2 * half
    return found


def _by_elimination(between: Array, whole: list[Array], first: Array) -> Array:
    """Return b of (1 − T R) b = T a, (Y, N, P)."""
    t = in_blocks(whole)
    # unknowns are b over the root of T, which falls with the order as fast as R grows
    scale = np.sqrt(np.abs(t).max(axis=(0, 2)))
    inverse = np.divide(1.0, scale, out=np.zeros_like(scale), where=scale > 0)[:, np.newaxis]
    system = (inverse * t) @ (between * scale)
    found: Array = np.linalg.solve(np.eye(system.shape[-1]) - system, inverse * first)
    found *= scale[:, np.newaxis]
    return found


def in_blocks(whole: list[Array]) -> Array:
    """Return T of all cylinders as matrices (Y, N, N)."""
    sizes = [2 * t.shape[-1] for t in whole]
    found = np.zeros((len(whole[0]), sum(sizes), sum(sizes)), np.complex128)
    place = 0
    for t, size in zip(whole, sizes, strict=True):
        half = size // 2
        order = np.arange(half)
        for i in (0, 1):
            for j in (0, 1):
                found[:, place + i * half + order, place + j * half + order] = t[:, i, j]
        place += size
    return found
