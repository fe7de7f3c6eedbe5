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
    Step,
    back_to_itself,
    straight,
    through_planes,
    to_another,
)
from octsim.schemes.fullwave.operators import along_nodes
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


def several(
    cylinders: tuple[CylinderOnPlane, ...],
    lights: Lights,
    k: NDArray[np.float64],
    orders: Orders,
    tolerance: float,
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
    """
    along, weight = along_nodes(lights.aperture, orders.along)
    waves = _waves_of_each(cylinders, orders.waves)
    lit = [
        _regular(one, lights, along, k, m, orders) for one, m in zip(cylinders, waves, strict=True)
    ]
    matrices = [
        [both_signs(t) for t in scattering_of(one, along, k, m)]
        for one, m in zip(cylinders, waves, strict=True)
    ]
    epsilon = cylinders[0].n_water ** 2
    measure = weight * 2 / (np.pi * (epsilon - along**2))
    collected = np.zeros((3, 2, k.size), np.complex128)
    taken = 0.0
    for number, wavenumber in enumerate(k.tolist()):
        between = _between(cylinders, along, wavenumber, waves, orders)
        regular = np.concatenate([_flat(one[:, number]) for one in lit], axis=-1)
        whole = [t[0][number] for t in matrices]
        incoming, steps = _incoming(between, whole, regular, tolerance)
        size = between.shape[-1]
        taken += along.size * (steps * size**2 + 4 * size**2 * orders.contour)
        place = 0
        for one, t, m in zip(lit, matrices, waves, strict=True):
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


def _between(
    cylinders: tuple[CylinderOnPlane, ...], along: NDArray[np.float64], k: float,
    waves: list[int], orders: Orders,
) -> Array:  # fmt: skip
    """Return R from all outgoing waves to all regular ones, (Y, N, N)."""
    rows = []
    for to, waves_to in zip(cylinders, waves, strict=True):
        row = []
        for of, waves_of in zip(cylinders, waves, strict=True):
            step = Step(of, to)
            nodes = math.ceil(orders.contour * (1 + _TURNS * k * abs(step.across)))
            by = (
                back_to_itself(of, along, k, waves_of, orders.contour)
                if of is to
                else to_another(step, along, k, waves_to + waves_of, nodes)
            )
            part = through_planes(step, by, along, k, waves_to, waves_of)
            if of is not to:
                direct = straight(step, along, k, waves_to, waves_of)
                part[:, 0, :, 0] += direct
                part[:, 1, :, 1] += direct
            row.append(part.reshape(along.size, 2 * (2 * waves_to + 1), -1))
        rows.append(np.concatenate(row, axis=-1))
    return np.concatenate(rows, axis=-2)


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
