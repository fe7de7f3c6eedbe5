"""Sums of the fields of rays over a band, from polynomials of what they have there.

Rays that are detected all over the band, or nowhere, have a field that is smooth in the wavenumber:
those of one light path are summed at a few nodes, without the phase of their mean optical path, and
interpolated. Others, at an edge somewhere in the band, are summed at every wavenumber.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from octsim.optics.detector import RIM
from octsim.schemes.band_nodes import nodes_within, to_coefficients
from octsim.schemes.returned_rays import FIRST_FIELD, LENGTH, RIM_SQUARED, Spiral, X, Y, weights
from octsim.tracing.light_paths import first_rays

_AT_ONCE = 2_000_000  # numbers
_NEAR_AN_EDGE = 0.5  # of how much a distance varies from node to node, within which it may be met
_MOST_NODES = 100
"""At which fields are summed, before they are summed at every wavenumber."""

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]


class Tracks(NamedTuple):
    """What rays have over a band, for those that take the same path at each node: D of them."""

    ray: NDArray[np.int64]
    path: NDArray[np.int64]
    coefficients: Floats
    """Of Chebyshev's polynomials over the band, (Q, M, D)."""

    def some(self, wanted: NDArray[np.bool_] | NDArray[np.int64]) -> "Tracks":
        """Return some of them."""
        return Tracks(self.ray[wanted], self.path[wanted], self.coefficients[..., wanted])

    def at(self, place: Floats) -> Floats:
        """Return their numbers (Q, K, D) at places −1 … 1 of the band (K,)."""
        return chebyshev.chebvander(place, self.coefficients.shape[1] - 1) @ self.coefficients


class Fields(NamedTuple):
    """Fields of rays at wavenumbers (C, K), those by a rougher rule, and segments traced."""

    values: Complexes
    rough: Complexes
    segments: int


def summed(spiral: Spiral, tracks: Tracks, k: Floats) -> Fields:
    """Return the fields of tracks over a band at wavenumbers that span it evenly, (K,)."""
    tracks = tracks.some(np.argsort(tracks.path, kind="stable"))
    half = (k[-1] - k[0]) / 2
    begin = first_rays(tracks.path)
    lengths = tracks.coefficients[LENGTH]
    turn = np.abs(lengths - _of_each(lengths, begin)).sum(axis=0).max(initial=0.0) * k[-1]
    # of e^(ix) over −turn … turn, as Bessel functions fall
    number = math.ceil(turn / k[-1] * half + 6 * turn ** (1 / 3) + 12)
    # an absorption line can be narrower than nodes are apart
    if spiral.scene.absorbs or not tracks.ray.size or number > min(_MOST_NODES, k.size // 2):
        return _at_each(spiral, tracks, k)
    inside, at_edge = _detected(spiral, tracks.at(chebyshev.chebpts1(number)))
    at_edges = _at_each(spiral, tracks.some(at_edge), k)
    smooth = _by_nodes(spiral, tracks.some(inside), k, number)
    return Fields(at_edges.values + smooth.values, at_edges.rough + smooth.rough, 0)


def _of_each(values: Floats, begin: NDArray[np.int64]) -> Floats:
    """Return the mean of a light path's rays for each of them, (..., D); paths begin at (P,)."""
    counts = np.diff(begin, append=values.shape[-1])
    return np.repeat(np.add.reduceat(values, begin, axis=-1) / counts, counts, axis=-1)


def _detected(spiral: Spiral, numbers: Floats) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which rays (Q, N, D) are detected all over the band, and which here and there.

    A falloff may have an edge where its core ends, too.
    """
    optics = spiral.optics
    place = np.hypot(numbers[X], numbers[Y]) / optics.detector.radius
    # interpolation can put what is near the axis a little below zero
    rim = np.sqrt(np.maximum(numbers[RIM_SQUARED], 0.0)) / RIM
    reach = optics.effects.falloff.reach(optics.band[0])
    inside = (place < reach).all(axis=0) & (rim <= 1).all(axis=0)
    at_edge = _meets(place, reach) | _meets(place, 1.0) | _meets(rim, 1.0)
    outside = (place.min(axis=0) > reach) | (rim.min(axis=0) > 1)
    return inside & ~at_edge, at_edge & ~(outside & ~_meets(place, reach) & ~_meets(rim, 1.0))


def _meets(distance: Floats, edge: float) -> NDArray[np.bool_]:
    """Return whether a distance (N, D) may be that of an edge at or between nodes."""
    near = _NEAR_AN_EDGE * np.abs(np.diff(distance, axis=0)).max(axis=0, initial=0.0)
    found = (distance.min(axis=0) - near <= edge) & (edge <= distance.max(axis=0) + near)
    met: NDArray[np.bool_] = found & (near > 0)
    return met


def _by_nodes(spiral: Spiral, tracks: Tracks, k: Floats, number: int) -> Fields:
    """Return the fields of rays that are smooth over a band, from those at a number of nodes."""
    if not tracks.ray.size:
        return _at_each(spiral, tracks, k)
    begin = first_rays(tracks.path)
    place, to = chebyshev.chebpts1(number), np.linspace(-1, 1, k.size)
    at = nodes_within(k[0], k[-1], number)
    counts = np.diff(begin, append=tracks.ray.size)
    mean = np.add.reduceat(tracks.coefficients[LENGTH], begin, axis=-1) / counts
    slow = np.array(tracks.at(place))
    slow[LENGTH] -= np.repeat(chebyshev.chebvander(place, len(mean) - 1) @ mean, counts, axis=-1)
    parts, even = _parts(spiral, tracks.ray, slow, at)
    sums = np.stack([np.add.reduceat(parts * one, begin, axis=-1) for one in (1.0, 2.0 * even)])
    there = chebyshev.chebvander(to, number - 1) @ (to_coefficients(number) @ sums)
    phase = k[:, np.newaxis] * (chebyshev.chebvander(to, len(mean) - 1) @ mean)
    values, rough = (there * (np.cos(phase) + 1j * np.sin(phase))).sum(axis=-1)
    return Fields(values, rough, 0)


def _at_each(spiral: Spiral, tracks: Tracks, k: Floats) -> Fields:
    """Return the fields of rays summed at every wavenumber."""
    place = np.linspace(-1, 1, k.size)
    step = max(1, _AT_ONCE // max(1, tracks.coefficients[:, 0].size))
    spans = [slice(begin, begin + step) for begin in range(0, k.size, step)]
    found = [fields_of(spiral, tracks.ray, tracks.at(place[span]), k[span]) for span in spans]
    values, rough = zip(*found, strict=True)
    return Fields(np.concatenate(values, axis=1), np.concatenate(rough, axis=1), 0)


def fields_of(
    spiral: Spiral, ray: NDArray[np.int64], numbers: Floats, k: Floats
) -> tuple[Complexes, Complexes]:
    """Return the detected fields (C, K) of rays with numbers (Q, K, D), and by a rougher rule."""
    parts, even = _parts(spiral, ray, numbers, k)
    return parts.sum(axis=-1), 2 * parts[..., even].sum(axis=-1)


def _parts(
    spiral: Spiral, ray: NDArray[np.int64], numbers: Floats, k: Floats
) -> tuple[Complexes, NDArray[np.bool_]]:
    """Return what each ray has in the detected fields, (C, K, D), and which the rougher rule has.

    Every second ray is a spiral of half the rays.
    """
    phase = k[:, np.newaxis] * numbers[LENGTH]
    turned = weights_of(spiral, numbers, k) * (np.cos(phase) + 1j * np.sin(phase))
    fields = numbers[FIRST_FIELD : FIRST_FIELD + spiral.parts]
    if spiral.optics.effects.vectorial:
        real, imaginary = np.split(fields, 2)
        fields = real + 1j * imaginary
    return fields * turned, ray % spiral.options["rays"] % 2 == 0


def weights_of(spiral: Spiral, numbers: Floats, k: Floats) -> Floats:
    """Return what weighs rays with numbers (Q, K, D): pupil, detector, and what regions take."""
    weight = weights(spiral.optics, numbers, k)
    if spiral.lengths:
        ways = numbers[FIRST_FIELD + spiral.parts :]
        weight = weight * spiral.scene.transmission(ways, k)
    return weight
