r"""Several parallel cylinders: what the waves of one are about the axis of another.

Straight on, by Graf's addition theorem (κ, d and φ of the step from the one axis to the other),

.. math:: a_m = \sum_{m'} H_{m'-m}(\kappa d)\, e^{i (m' - m) \phi}\, b_{m'},

and through the planes, as `slab` has it for one cylinder, with :math:`e^{i k_x X}` of the step X
across. Light that goes far across is a sum over real k_x but for a detour below what is singular
there; light that comes back to its own cylinder takes the contour of `coupling`.

All of these depend on m and m′ by their sum, light that planes turn back, or by their difference:

.. math:: a_m = \sum_{m'} \left[ (-1)^{m'} S_{m+m'} + D_{m-m'} \right] b_{m'}.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
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
    """Of the plane waves of k_x > 0 on a contour, for Y components k_y, over k: (Y, B) each.

    Those of k_x < 0 are their mirror images.
    """

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


class Between(NamedTuple):
    """What outgoing waves of one cylinder are about another's axis, of Y components k_y.

    (Y, 2, 2, 2L + 1) each: to E_y and H_y, of E_y and H_y, for −L … L with L = M + M′.
    """

    by_sum: Array
    """S_{m+m′}."""
    by_difference: Array
    """D_{m−m′}."""

    def back(self) -> "Between":
        """Return what the other one's waves are about the axis of the first: by reciprocity."""
        mirrored = self.by_sum[..., ::-1].copy()
        mirrored[:, 0, 1] *= -1
        mirrored[:, 1, 0] *= -1
        return Between(mirrored, self.by_difference * _turns(self.by_difference.shape[-1] // 2))


def between(
    step: Step, by: Wavevectors, along: NDArray[np.float64], k: float, farthest: int
) -> Between:
    """Return what goes from one cylinder to another, or through planes back to the same.

    Parameters
    ----------
    step : Step
    by : Wavevectors
        Of the light that planes send.
    along : ndarray, shape (Y,)
        Components k_y / k.
    k : float
        Wavenumber, 1/µm.
    farthest : int
        L, the sum of the largest orders of both.
    """
    found = through_planes(step, by, along, k, farthest)
    if step.of is not step.to:
        direct = straight(step, along, k, farthest)
        for part in (0, 1):
            found.by_difference[:, part, part] += direct
    return found


def write(found: Array, waves: Between, to: int, of: int) -> None:
    """Write R of orders −M … M to, of orders −M′ … M′, into (Y, 2 (2M + 1), 2 (2M′ + 1))."""
    farthest, size_to, size_of = waves.by_sum.shape[-1] // 2, 2 * to + 1, 2 * of + 1
    signs = _turns(farthest)[farthest - of : farthest + of + 1]
    # m + m′ rises with both, m − m′ falls with m′
    middle = slice(farthest - to - of, farthest + to + of + 1)
    rising = sliding_window_view(waves.by_sum[..., middle], size_of, axis=-1)
    falling = sliding_window_view(waves.by_difference[..., middle], size_of, axis=-1)[..., ::-1]
    for i, j in np.ndindex(2, 2):
        part = found[:, i * size_to : (i + 1) * size_to, j * size_of : (j + 1) * size_of]
        np.multiply(rising[:, i, j], signs, out=part)
        part += falling[:, i, j]


def straight(step: Step, along: NDArray[np.float64], k: float, farthest: int) -> Array:
    """Return D of what reaches one cylinder straight from another, (Y, 2L + 1)."""
    kappa = k * np.sqrt(step.of.n_water**2 - along**2)
    distance = np.hypot(step.across, step.up)
    turn = np.arctan2(step.up, step.across)
    order = np.arange(farthest + 1)
    positive = hankel1(order, kappa[:, np.newaxis] * distance)
    # H_{−m} = (−1)^m H_m
    every = np.concatenate([positive[:, :0:-1], positive], axis=1)
    order = np.arange(-farthest, farthest + 1)
    signs = np.where(order > 0, _turns(farthest), 1.0)
    found: Array = every * signs * np.exp(-1j * order * turn)
    return found


def through_planes(
    step: Step, by: Wavevectors, along: NDArray[np.float64], k: float, farthest: int
) -> Between:
    """Return what planes send from one cylinder to another; parameters are those of `between`."""
    scene, epsilon = step.of, step.of.n_water**2
    sideways = along[:, np.newaxis] + 0j
    squared = by.across**2 + sideways**2
    below = below_water(scene, squared, np.array(k))
    h_of, h_to = step.of.height, step.to.height
    # e^{iβ} = cos β + i sin β
    turn = (by.here + 1j * by.across) / np.sqrt(epsilon - along**2)[:, np.newaxis]
    aside = np.exp(1j * k * by.across * step.across)
    turns = _turns(farthest)

    def part(light: Pair, height: float, turned: bool, of_up: bool) -> Array:
        r = conical(light, sideways, by.across, by.here, epsilon, turned, of_up)
        ee, eh, hh = (one * by.weight for one in (r.ee, r.eh, r.hh))
        # ahead, and the mirror image of what goes back, where k_x turns eh
        each = [one * aside for one in (ee, eh, hh)] + [one / aside for one in (ee, -eh, hh)]
        sums = _over_turns(turn, 1j * k * height * by.here, np.stack(each, axis=-1), farthest)
        ahead, aback = sums[:, :3], sums[:, 3:, ::-1]
        ee, eh, hh = np.moveaxis(ahead + aback, 1, 0)
        # what E makes of H is in proportion to what H makes of E
        he = (-epsilon if turned else epsilon) * eh
        return np.stack([np.stack([ee, eh], axis=1), np.stack([he, hh], axis=1)], axis=1)

    if not scene.above:
        by_sum = part(below, h_of + h_to, turned=True, of_up=False)
        return Between(by_sum, np.zeros_like(by_sum))
    above, room = above_water(scene, squared, np.array(k)), scene.room
    round_trip = np.exp(2j * k * room * by.here)
    often = [1 / (1 - b * a * round_trip) for b, a in zip(below, above, strict=True)]
    once_below, once_above, both = (
        (of_s * often[0], of_p * often[1])
        for of_s, of_p in (below, above, (below[0] * above[0], below[1] * above[1]))
    )
    # of what goes up e^{−imβ}, of what comes up e^{imβ}; (−1)^m times the other downwards
    from_above = part(once_above, 2 * room - h_to - h_of, turned=True, of_up=True)
    downwards = part(both, 2 * room - h_to + h_of, turned=False, of_up=False)
    return Between(
        part(once_below, h_of + h_to, turned=True, of_up=False) + turns * from_above[..., ::-1],
        part(both, 2 * room + h_to - h_of, turned=False, of_up=True) + turns * downwards[..., ::-1],
    )


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
    size = kappa[:, np.newaxis]
    return Wavevectors(
        size * np.sin(path.angle),
        size * np.cos(path.angle),
        np.broadcast_to(path.weight / np.pi, (along.size, nodes)),
    )


def to_another(
    step: Step, along: NDArray[np.float64], k: float, waves: int, nodes: int
) -> Wavevectors:
    """Return the plane waves by which a cylinder's light comes to another through planes."""
    scene = step.of
    indices = [
        scene.n_glass,
        scene.n_water,
        *(layer.n.real for layer in (*scene.films, *scene.above)),
    ]
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
    tail = Wavevectors(kappa * np.cosh(b) + 0j, 1j * kappa * np.sinh(b), -1j * span * w / 2 + 0 * b)
    across, here, weight = (np.concatenate(both, axis=1) for both in zip(first, tail, strict=True))
    return Wavevectors(across, here, weight / np.pi)


def _last(waves: int, height: float) -> float:
    """Return where waves that decay over a height are too little to count, b."""
    exponent = waves * _FAR - height * np.sinh(_FAR)
    counts = exponent > max(exponent.max(), 0.0) - _FALL
    return float(_FAR[min(np.flatnonzero(counts)[-1] + 1, len(_FAR) - 1)])


def _turns(farthest: int) -> NDArray[np.float64]:
    """Return (−1)^n for −L … L."""
    return np.where(np.arange(-farthest, farthest + 1) % 2, -1.0, 1.0)


def _over_turns(turn: Array, travel: Array, sizes: Array, farthest: int) -> Array:
    """Return the sums over plane waves of e^{inβ}, times travel and sizes: (Y, C, 2L + 1).

    Parameters
    ----------
    turn : ndarray, shape (Y, B)
        e^{iβ}, of which none is smaller than 1 by much.
    travel : ndarray, shape (Y, B)
        Exponent of what they are multiplied by.
    sizes : ndarray, shape (Y, B, C)
    farthest : int
        L.
    """
    powers = np.empty((2 * farthest + 1, *turn.shape), np.complex128)
    # from the largest one on, as the smallest may be too small to tell from 0
    powers[-1] = np.exp(farthest * np.log(turn) + travel)
    inverse = 1 / turn
    for n in range(2 * farthest, 0, -1):
        np.multiply(powers[n], inverse, out=powers[n - 1])
    found: Array = (powers.swapaxes(0, 1) @ sizes).swapaxes(1, 2)
    return found
