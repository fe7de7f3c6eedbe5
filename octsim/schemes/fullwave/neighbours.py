r"""Several parallel cylinders: what the waves of one are about the axis of another.

Straight on, by Graf's addition theorem (κ, d and φ of the step from the one axis to the other),

.. math:: a_m = \sum_{m'} H_{m'-m}(\kappa d)\, e^{i (m' - m) \phi}\, b_{m'},

and through the planes, as `slab` has it for one cylinder, with :math:`e^{i k_x X}` of the step X
across. Light that goes far across is a sum over real k_x but for a detour below what is singular
there; light that comes back to its own cylinder takes the contour of `coupling`.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import hankel1

from octsim.schemes.fullwave.coupling import contour
from octsim.schemes.fullwave.cylinder_on_plane import CylinderOnPlane
from octsim.schemes.fullwave.gauss_legendre import gauss_legendre
from octsim.schemes.fullwave.stacks import Pair, above_water, below_water, conical

Array = NDArray[Any]
_DEEPEST = 0.35
"""Of the detour below the singularities, over k."""
_GROWTH = 2.5
"""Exponent that e^{ikX} may grow by on it."""
_BEYOND = 1.1
"""Where it ends, over the largest index."""
_FALL = 36.0
_FAR = np.linspace(0.02, 12, 600)


class Wavevectors(NamedTuple):
    """Of plane waves on a contour, for each of Y components k_y, over k: (Y, B) each."""

    across: Array
    here: Array
    """k_z upwards."""
    weight: Array
    """dβ over π."""


class Step(NamedTuple):
    """From the axis of a cylinder that scatters to that of one that is reached, µm."""

    of: CylinderOnPlane
    to: CylinderOnPlane

    @property
    def across(self) -> float:
        """Along x."""
        return self.to.offset - self.of.offset

    @property
    def up(self) -> float:
        """Along z."""
        return self.to.height - self.of.height


def straight(
    step: Step, along: NDArray[np.float64], k: float, waves_to: int, waves_of: int
) -> Array:
    """Return what reaches one cylinder straight from another, (Y, 2M + 1, 2M′ + 1)."""
    kappa = k * np.sqrt(step.of.n_water**2 - along**2)
    distance = np.hypot(step.across, step.up)
    turn = np.arctan2(step.up, step.across)
    both = waves_to + waves_of
    order = np.arange(-both, both + 1)
    every = hankel1(order, kappa[:, np.newaxis] * distance) * np.exp(1j * order * turn)
    to, of = np.arange(-waves_to, waves_to + 1), np.arange(-waves_of, waves_of + 1)
    found: Array = every[:, of - to[:, np.newaxis] + both]
    return found


def through_planes(
    step: Step, by: Wavevectors, along: NDArray[np.float64], k: float, waves_to: int, waves_of: int
) -> Array:
    """Return what planes send from one cylinder to another, (Y, 2, 2M + 1, 2, 2M′ + 1)."""
    scene, epsilon = step.of, step.of.n_water**2
    sideways = along[:, np.newaxis] + 0j
    squared = by.across**2 + sideways**2
    below = below_water(scene, squared, np.array(k))
    h_of, h_to = step.of.height, step.to.height
    sine = by.across / np.sqrt(epsilon - along**2)[:, np.newaxis]
    # e^{iβ} = cos β + i sin β
    turn = by.here / np.sqrt(epsilon - along**2)[:, np.newaxis] + 1j * sine
    size = by.weight * np.exp(1j * k * by.across * step.across)

    def travel(height: float) -> Array:
        found: Array = np.exp(1j * k * height * by.here)
        return found

    def part(light: Pair, height: float, to_up: bool, of_up: bool) -> Array:
        sent = (light[0] * travel(height), light[1] * travel(height))
        turned = to_up != of_up
        r = conical(sent, sideways, by.across, by.here, epsilon, turned, of_up)
        # of what goes up e^{−imβ}, of what comes up e^{imβ}; (−1)^m times the other downwards
        to = _powers(turn if to_up else -1 / turn, waves_to)
        of = _powers(1 / turn if of_up else -turn, waves_of)
        return _sum_over(to, [[r.ee * size, r.eh * size], [r.he * size, r.hh * size]], of)

    if not scene.above:
        return part(below, h_of + h_to, to_up=True, of_up=False)
    above, room = above_water(scene, squared, np.array(k)), scene.room
    often = [1 / (1 - b * a * travel(2 * room)) for b, a in zip(below, above, strict=True)]
    once_below, once_above, both = (
        (of_s * often[0], of_p * often[1])
        for of_s, of_p in (below, above, (below[0] * above[0], below[1] * above[1]))
    )
    found: Array = (
        part(once_below, h_of + h_to, to_up=True, of_up=False)
        + part(both, 2 * room + h_to - h_of, to_up=True, of_up=True)
        + part(once_above, 2 * room - h_to - h_of, to_up=False, of_up=True)
        + part(both, 2 * room - h_to + h_of, to_up=False, of_up=False)
    )
    return found


def back_to_itself(
    scene: CylinderOnPlane, along: NDArray[np.float64], k: float, waves: int, nodes: int
) -> Wavevectors:
    """Return the plane waves by which a cylinder's light comes back to it."""
    kappa = np.sqrt(scene.n_water**2 - along**2)
    heights = [k * kappa[[0, -1]] * scene.height]
    if scene.above:
        heights.append(k * kappa[[0, -1]] * (scene.room - scene.height))
    heights_of = np.concatenate(heights)
    path = contour(nodes, np.full(heights_of.shape, waves), heights_of)
    angle = np.concatenate([-path.angle[::-1], path.angle])
    weight = np.concatenate([path.weight[::-1], path.weight]) / np.pi
    size = kappa[:, np.newaxis]
    return Wavevectors(
        size * np.sin(angle), size * np.cos(angle), np.broadcast_to(weight, (along.size, len(angle)))
    )


def to_another(
    step: Step, along: NDArray[np.float64], k: float, waves: int, nodes: int
) -> Wavevectors:
    """Return the plane waves by which a cylinder's light comes to another through planes."""
    scene = step.of
    indices = [scene.n_glass, scene.n_water, *(layer.n.real for layer in (*scene.films, *scene.above))]
    end = _BEYOND * max(indices)
    kappa = np.sqrt(scene.n_water**2 - along**2)[:, np.newaxis]
    depth = min(_DEEPEST, _GROWTH / max(k * abs(step.across), 1e-3))
    x, w = gauss_legendre(nodes)
    t, dt = end * (x + 1) / 2, end * w / 2
    shape = np.pi * t / end
    across = np.broadcast_to(t - 1j * depth * np.sin(shape), (along.size, nodes))
    slope = dt * (1 - 1j * depth * np.pi / end * np.cos(shape))
    here = np.sqrt(kappa**2 - across**2)
    # β's, of k_x = κ sin β
    first = Wavevectors(across, here, slope / here)
    # from there on light decays: k_x = κ cosh b
    start = np.arccosh(end / kappa)
    heights = [step.of.height + step.to.height]
    if scene.above:
        heights.append(2 * scene.room - heights[0])
    last = max(_last(waves, k * float(kappa.min()) * height) for height in heights)
    span = np.maximum(last - start, 0.5)
    b = start + span * (x + 1) / 2
    tail = Wavevectors(
        kappa * np.cosh(b) + 0j, 1j * kappa * np.sinh(b), -1j * span * w / 2 + 0 * b
    )
    ahead = [np.concatenate(both, axis=1) for both in zip(first, tail, strict=True)]
    return Wavevectors(
        np.concatenate([-ahead[0], ahead[0]], axis=1), np.concatenate([ahead[1]] * 2, axis=1),
        np.concatenate([ahead[2]] * 2, axis=1) / np.pi,
    )  # fmt: skip


def _last(waves: int, height: float) -> float:
    """Return where waves that decay over a height are too little to count, b."""
    exponent = waves * _FAR - height * np.sinh(_FAR)
    counts = exponent > max(exponent.max(), 0.0) - _FALL
    return float(_FAR[min(np.flatnonzero(counts)[-1] + 1, len(_FAR) - 1)])


def _powers(turn: Array, waves: int) -> Array:
    """Return the powers −M … M of e^{iβ} (Y, B): (Y, 2M + 1, B)."""
    order = np.arange(-waves, waves + 1)[:, np.newaxis]
    found: Array = turn[:, np.newaxis] ** order
    return found


def _sum_over(to: Array, by: list[list[Array]], of: Array) -> Array:
    """Return the sum over plane waves (Y, 2, 2M + 1, 2, 2M′ + 1)."""
    rows, columns = to.shape[1], of.shape[1]
    found = np.empty((len(to), 2, rows, 2, columns), np.complex128)
    for i in (0, 1):
        for j in (0, 1):
            found[:, i, :, j] = (to * by[i][j][:, np.newaxis]) @ of.swapaxes(1, 2)
    return found
