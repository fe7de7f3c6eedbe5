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
_MORE_NODES = 2.5
"""Of a contour between cylinders, over those of one cylinder's own."""


class Lights(NamedTuple):
    """What lights the cylinders, and is detected."""

    pupil: Pupil
    aperture: float
    focus: float
    wavefront: Wavefront | None


class Several(NamedTuple):
    """What is collected of cylinders, not over the norm yet: T, near sides and far sides, and what
    it took."""

    terms: Array
    """(3, 2, K)."""
    multiplications: float


def several(
    cylinders: tuple[CylinderOnPlane, ...],
    lights: Lights,
    k: NDArray[np.float64],
    orders: Orders,
    tolerance: float,
) -> Several:
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
    lit = [_regular(one, lights, along, k, m, orders) for one, m in zip(cylinders, waves, strict=True)]
    matrices = [
        [_both_signs(t) for t in scattering_of(one, along, k, m)]
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
                    found = of_e * epsilon * e * b[polarisation, :, 0] - of_h * h * b[polarisation, :, 1]
                    collected[term, polarisation, number] += ((found * turn).sum(-1) * measure).sum()
    return Several(collected, taken)


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


def _both_signs(matrix: Array) -> Array:
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
    nodes = math.ceil(_MORE_NODES * orders.contour)
    rows = []
    for to, waves_to in zip(cylinders, waves, strict=True):
        row = []
        for of, waves_of in zip(cylinders, waves, strict=True):
            step = Step(of, to)
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
    t = _blocks(whole)
    # unknowns are b over the root of T, which falls with the order as fast as R grows
    scale = np.sqrt(np.abs(t).max(axis=(0, 2)))
    inverse = np.divide(1.0, scale, out=np.zeros_like(scale), where=scale > 0)
    system = (inverse[:, np.newaxis] * t) @ (between * scale)
    right = np.moveaxis(((inverse[:, np.newaxis] * t) @ np.moveaxis(regular, 0, -1)), -1, 0)
    b, before = right, np.inf
    steps, settled = 0.0, False
    for _ in range(_ITERATIONS):
        following = right + np.moveaxis(system @ np.moveaxis(b, 0, -1), -1, 0)
        change = float(np.abs((following - b) * scale).max())
        b, steps = following, steps + 2
        settled = change <= tolerance * float(np.abs(b * scale).max())
        if settled or not change < before:
            break
        before = change
    if not settled:
        size = system.shape[-1]
        solved = np.linalg.solve(np.eye(size) - system, np.moveaxis(right, 0, -1))
        b, steps = np.moveaxis(solved, -1, 0), steps + size / 3
    return regular + np.moveaxis(between @ np.moveaxis(b * scale, 0, -1), -1, 0), steps


def _blocks(whole: list[Array]) -> Array:
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
