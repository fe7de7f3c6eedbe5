"""Rays that come back from a scene, found once, and what detectors of any falloff make of them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.config.scheme import options_of
from octsim.instrument.build import optics_of, scene_of
from octsim.schemes.band_nodes import nodes_within, to_coefficients
from octsim.schemes.field_sum import field, intensity_of
from octsim.schemes.light import Field, Optics
from octsim.schemes.reference_arm import with_reference
from octsim.schemes.returned_rays import FIRST_FIELD, LENGTH, Returned, Spiral, X, Y, weights

Array = NDArray[np.float64]
LARGER = 1e-3
"""µm; what the diameter grows by as rays enter and leave the detector (thesis §4.4)."""
OUTERMOST = 0.9
"""Part of the radius, beyond which detected rays are the outermost ones."""
_NODES = 9
"""Of the band, at which a falloff is known that depends on the wavenumber."""
_NOTHING = 1e-11
"""Of the largest amplitude: Chebyshev coefficients below that are left out."""


class Collected(NamedTuple):
    """What a detector collects of a diameter's rays."""

    intensity: Array
    """(K,)."""
    swapped: Array
    """Of the same rays, but for those that leave the detector, and with those that enter it, as
    the diameter grows by `LARGER`; (K,)."""
    rays: int
    """That are detected."""
    effective_rays: float
    r""":math:`(\sum |E|)^2 / \sum E^2`, in the middle of the band: of rays of one amplitude their
    number."""
    outermost: float
    """Share of those beyond `OUTERMOST` in the sum of the amplitudes."""
    edge_rays: int
    """That enter or leave."""
    edge_amplitude: float
    """Sum of their amplitudes, over that of the detected rays."""


def returned(config: Config, optics: Sequence[Optics], diameter: float, focus: float) -> Returned:
    """Return the rays of a diameter at a focus (µm) that any of some detectors may collect."""
    # found by the detector that reaches farthest
    band = optics[0].band
    farthest = max(optics, key=lambda one: one.effects.falloff.reach(band[0]) * one.detector.radius)
    spiral = Spiral(farthest, options_of(config), scene_of(config, diameter), focus, lengths=False)
    return spiral.at(sum(band) / 2)


def collected(optics: Optics, now: Returned, larger: Returned) -> Collected:
    """Return what a detector makes of rays, and of the exchange with those of a larger diameter.

    Parameters
    ----------
    optics : Optics
        Of the detector.
    now, larger : Returned
        Rays of a diameter, and of one that is `LARGER` by that.
    """
    there, there_after = _detected(optics, now), _detected(optics, larger)
    one, other = _common(now, larger)
    # of a ray that takes a path at one of the diameters alone it is not the detector's edge
    leave = one[there[one] & ~there_after[other]]
    enter = other[~there[one] & there_after[other]]
    inside, left, entered = (
        _Rays.of(optics, found.numbers[:, which])
        for found, which in ((now, np.flatnonzero(there)), (now, leave), (larger, enter))
    )
    values = inside.field(optics.wavenumber)
    exchanged = entered.field(optics.wavenumber) - left.field(optics.wavenumber)
    amplitude = inside.middle
    whole = float(amplitude.sum())
    reach = optics.effects.falloff.reach(optics.band[0]) * optics.detector.radius
    some = whole if whole > 0 else np.nan
    return Collected(
        _intensity(optics, values), _intensity(optics, values + exchanged), amplitude.size,
        float(whole**2 / (amplitude**2).sum()) if whole > 0 else 0.0,
        float(amplitude[inside.place > OUTERMOST * reach].sum() / some),
        leave.size + enter.size, float((left.middle.sum() + entered.middle.sum()) / some),
    )  # fmt: skip


class _Rays(NamedTuple):
    """Rays with the amplitudes that a detector gives them, D of them."""

    coefficients: Array
    """Chebyshev coefficients of the amplitude over the band, (M, D); one, where it is the same."""
    length: Array
    """Optical path length, (D,), µm."""
    place: Array
    """Distance from the axis in the focal plane, (D,), µm."""

    @classmethod
    def of(cls, optics: Optics, numbers: Array) -> "_Rays":
        """Return rays with numbers (Q, D), as `Returned` has them, with a detector's amplitudes."""
        at = _middle(optics)
        if optics.varies:
            at = nodes_within(*optics.band, _NODES)
        repeated = np.broadcast_to(
            numbers[:, np.newaxis], (numbers.shape[0], at.size, numbers.shape[1])
        )
        amplitude = numbers[FIRST_FIELD] * weights(optics, repeated, at)
        if optics.varies:
            amplitude = to_coefficients(_NODES) @ amplitude
        return cls(amplitude, numbers[LENGTH], np.hypot(numbers[X], numbers[Y]))

    @property
    def middle(self) -> Array:
        """Magnitude of the amplitude in the middle of the band, (D,)."""
        return np.asarray(np.abs(chebyshev.chebval(0.0, self.coefficients)))

    def field(self, k: Array) -> NDArray[np.complex128]:
        """Return their field at the samples of the band, (K,), 1/µm."""
        every = [np.ones(self.length.size, bool)]
        if len(self.coefficients) > 1:
            least = _NOTHING * np.abs(self.coefficients).max(initial=0.0)
            every = [np.abs(row) > least for row in self.coefficients]
        parts = [
            field(row[which], self.length[which], k)
            for row, which in zip(self.coefficients, every, strict=True)
        ]
        shapes = chebyshev.chebvander(np.linspace(-1, 1, k.size), len(parts) - 1).T
        return np.asarray((shapes * np.stack(parts)).sum(axis=0))


def _middle(optics: Optics) -> Array:
    """Return the wavenumber in the middle of the band, (1,), 1/µm."""
    return np.array([sum(optics.band) / 2])


def _detected(optics: Optics, found: Returned) -> NDArray[np.bool_]:
    """Return which rays are detected, (D,): the same ones at all wavenumbers."""
    weight = weights(optics, found.numbers[:, np.newaxis], _middle(optics))[0]
    return np.asarray(weight * found.numbers[FIRST_FIELD] != 0)


def _intensity(optics: Optics, values: NDArray[np.complex128]) -> Array:
    whole = Field(values[np.newaxis], 0.0)
    arm = optics.effects.reference
    return intensity_of(with_reference(whole, arm, optics.wavenumber).values[0])


def _common(one: Returned, other: Returned) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the places of the rays that take the same path in both."""
    codes = np.unique(np.concatenate([one.path, other.path]))
    keys = [found.ray * codes.size + np.searchsorted(codes, found.path) for found in (one, other)]
    _, first, second = np.intersect1d(keys[0], keys[1], assume_unique=True, return_indices=True)
    return first, second


def optics_by(configs: Sequence[Config]) -> list[Optics]:
    """Return the optics of configs that differ in their detectors alone."""
    return [optics_of(config) for config in configs]
