"""Counted rays whose way or weight depends on the wavenumber: traced at few, summed at all.

What a ray's way gives (where it leaves the focal plane and the objective, its optical path, its
amplitude) is smooth over the wavenumber as long as it meets the same surfaces, and interpolated.
Whether it is detected is not, and is judged after that. For rays that do not meet the same surfaces
at all nodes, or whose interpolation is not close enough, the band is halved, until every one of its
wavenumbers is traced.
"""

import numpy as np
from numpy.typing import NDArray

from octsim.optics.detector import RIM, Outcome
from octsim.optics.scene import Scene
from octsim.schemes.band_nodes import nodes_within, to_coefficients
from octsim.schemes.light import AccuracyStatus, Light, Optics, Options, Sampled
from octsim.schemes.ray_trees import dropped_field
from octsim.schemes.returned_rays import (
    FIRST_FIELD,
    LENGTH,
    RIM_SQUARED,
    Returned,
    Spiral,
    X,
    Y,
    weights,
)
from octsim.schemes.track_sums import Fields, Floats, Tracks, fields_of, summed, weights_of

_NODES, _NODES_OF_PART = 9, 7
_FEW = 32
"""Wavenumbers of which each is traced, as that does not take long."""
_ROWS = 3
"""Rows of a table in a part of the band, at most."""
_CLOSE = 2e-10
"""Error of a ray's field by interpolation, over the largest field of one, that is close enough."""
_FALL = 0.07  # of coefficients, from one to the next, at most
_CURVED = 0.25
"""How far from a straight line between nodes a ray's place may be, over their distance."""
Pairs = frozenset[tuple[int, int]]
"""Numbers of launched rays, and codes of light paths that they take."""


def sampled_spiral(
    optics: Optics, options: Options, scene: Scene, focus: float, lengths: bool
) -> Sampled:
    """Return the light of a spiral of rays, with its field at the samples of the band.

    Parameters
    ----------
    optics, options, scene, focus, lengths
        As `octsim.schemes.returned_rays.Spiral` takes them.
    """
    spiral, k = Spiral(optics, options, scene, focus, lengths), optics.wavenumber
    middle = float(k[-1] + k[0]) / 2
    lights, every = [], []
    for share in spiral.shares(_NODES if optics.way_varies else 1):
        found = spiral.at(middle, share)
        if optics.way_varies and k.size <= _FEW:
            fields = _one_by_one(spiral, k, share, frozenset())
        elif optics.way_varies:
            fields = _over_band(spiral, k, share, frozenset(), _NODES)
        else:
            tracks = Tracks(found.ray, found.path, found.numbers[:, np.newaxis])
            fields = summed(spiral, tracks, k)
        lights.append(_middle_light(spiral, found, middle, found.segments + fields.segments))
        every.append(fields)
    fields, light = _together(every), _all_light(lights, options)
    rough = float(np.abs(fields.rough - fields.values).max())
    return Sampled(light, k, fields.values, rough + light.missing)


def _over_band(
    spiral: Spiral, k: Floats, only: NDArray[np.int64] | None, known: Pairs, number: int
) -> Fields:
    """Return the fields of rays at wavenumbers (K,), but of those on paths that are known.

    The rays are all, or of some numbers; they are traced at so many nodes at least.
    """
    if k.size <= number:
        return _one_by_one(spiral, k, only, known)
    if spiral.scene.rows_within(k[0], k[-1]) > _ROWS:
        # a table may turn between nodes that are too far apart to see it
        low_high = np.array_split(k, 2)
        return _joined([_over_band(spiral, part, only, known, number) for part in low_high])
    at = nodes_within(k[0], k[-1], number)
    traced = [_unknown(spiral.at(one, only), known) for one in at.tolist()]
    tracks, apart = _tracks(spiral, traced, k[-1])
    whole = summed(spiral, tracks, k)
    parts = [whole._replace(segments=sum(one.segments for one in traced))]
    if apart.size:
        now = known | frozenset(zip(tracks.ray.tolist(), tracks.path.tolist(), strict=True))
        halves = [
            _over_band(spiral, part, apart, now, _NODES_OF_PART) for part in np.array_split(k, 2)
        ]
        parts.append(_joined(halves))
    return _together(parts)


def _together(parts: list[Fields]) -> Fields:
    """Return the fields of some rays and of others as those of all."""
    return Fields(
        sum((one.values for one in parts[1:]), parts[0].values),
        sum((one.rough for one in parts[1:]), parts[0].rough),
        sum(one.segments for one in parts),
    )


def _all_light(parts: list[Light], options: Options) -> Light:
    """Return the light of one share of rays after the other as that of all."""
    light = parts[0]
    if len(parts) > 1:
        ways = [one.lengths for one in parts if one.lengths is not None]
        light = light._replace(
            path=np.concatenate([one.path for one in parts]),
            amplitude=np.concatenate([one.amplitude for one in parts]),
            rough_amplitude=np.concatenate([one.rough_amplitude for one in parts]),
            optical_path_length=np.concatenate([one.optical_path_length for one in parts]),
            lengths=np.concatenate(ways, axis=1) if ways else None,
            segments=sum(one.segments for one in parts),
            outcomes=np.sum([one.outcomes for one in parts if one.outcomes is not None], axis=0),
        )
    assert light.outcomes is not None
    return light._replace(missing=dropped_field(light.outcomes, options))


def _joined(parts: list[Fields]) -> Fields:
    """Return fields of one part of a band after the other as those of all of it."""
    return Fields(
        np.concatenate([one.values for one in parts], axis=1),
        np.concatenate([one.rough for one in parts], axis=1),
        sum(one.segments for one in parts),
    )


def _unknown(found: Returned, known: Pairs) -> Returned:
    """Return the rays that come back on paths that are not known."""
    if not known:
        return found
    pairs = zip(found.ray.tolist(), found.path.tolist(), strict=True)
    new = np.array([pair not in known for pair in pairs], bool)
    return found._replace(ray=found.ray[new], path=found.path[new], numbers=found.numbers[:, new])


def _possible(spiral: Spiral, numbers: Floats) -> NDArray[np.bool_]:
    """Return which rays (Q, M, D) may be detected at or between nodes, by straight lines."""
    reach = (
        spiral.optics.effects.falloff.reach(spiral.optics.band[0]) * spiral.optics.detector.radius
    )
    place, rim = numbers[X] + 1j * numbers[Y], np.sqrt(numbers[RIM_SQUARED])
    if numbers.shape[1] == 1:
        near, within = np.abs(place), rim
    else:
        step = np.diff(place, axis=0)
        length = np.abs(step)
        # where between two nodes the line is closest to the axis
        squared = np.where(length > 0, length, 1) ** 2
        along = -(place[:-1] * step.conj()).real / squared
        near = np.abs(place[:-1] + along.clip(0, 1) * step) - _CURVED * length
        within = np.minimum(rim[:-1], rim[1:]) - _CURVED * np.abs(np.diff(rim, axis=0))
    found: NDArray[np.bool_] = (near.min(axis=0) < reach) & (within.min(axis=0) < 1.001)
    return found


def _tracks(
    spiral: Spiral, traced: list[Returned], largest_k: float
) -> tuple[Tracks, NDArray[np.int64]]:
    """Return the rays that can be interpolated, and the numbers of others that may be detected."""
    ray, path = (np.concatenate([one[column] for one in traced]) for column in (0, 1))
    codes, code = np.unique(path, return_inverse=True)
    # a number for each pair of ray and path
    every, place, counts = np.unique(
        ray * codes.size + code, return_inverse=True, return_counts=True
    )
    first = 0
    whole = np.full((len(traced[0].numbers), len(traced), len(every)), np.nan)
    for node, one in enumerate(traced):
        whole[:, node, place[first : first + one.ray.size]] = one.numbers
        first += one.ray.size
    every = np.stack((every // codes.size, codes[every % codes.size]), axis=1)
    throughout = counts == len(traced)
    some = whole[..., ~throughout]
    known = [some[..., i][:, ~np.isnan(some[X, :, i])] for i in range(some.shape[-1])]
    seen = [i for i, one in enumerate(known) if _possible(spiral, one[..., np.newaxis])[0]]
    numbers, pairs = whole[..., throughout], every[throughout]
    possible = _possible(spiral, numbers)
    numbers, pairs = numbers[..., possible], pairs[possible]
    coefficients = to_coefficients(len(traced)) @ numbers
    close = _close(spiral, numbers, coefficients, largest_k)
    return (
        Tracks(pairs[close, 0], pairs[close, 1], coefficients[..., close]),
        np.unique(np.concatenate((every[~throughout][seen, 0], pairs[~close, 0]))),
    )


def _close(
    spiral: Spiral, numbers: Floats, coefficients: Floats, largest_k: float
) -> NDArray[np.bool_]:
    """Return whether what the coefficients of rays leave out is little enough, (D,)."""
    # coefficients that follow are no larger than the last, which can be small by chance
    left = np.maximum(np.abs(coefficients[:, -1]), _FALL * np.abs(coefficients[:, -2]))
    own = slice(FIRST_FIELD, FIRST_FIELD + spiral.parts)
    field = np.abs(numbers[own]).max(axis=(0, 1), initial=0.0)
    off = left[own].sum(axis=0) + field * (
        largest_k * left[LENGTH] + 2 * (left[X] + left[Y]) / spiral.optics.detector.radius
    )
    close: NDArray[np.bool_] = off <= _CLOSE * spiral.brightest
    return close


def _one_by_one(spiral: Spiral, k: Floats, only: NDArray[np.int64] | None, known: Pairs) -> Fields:
    """Return the fields of rays that are traced at every wavenumber."""
    found, segments = [], 0
    for at in k:
        one = _unknown(spiral.at(float(at), only), known)
        found.append(fields_of(spiral, one.ray, one.numbers[:, np.newaxis], np.array([at])))
        segments += one.segments
    values, rough = zip(*found, strict=True)
    return Fields(np.concatenate(values, axis=1), np.concatenate(rough, axis=1), segments)


def light_of_spiral(
    optics: Optics, options: Options, scene: Scene, focus: float, lengths: bool
) -> Light:
    """Return the rays of a spiral that serve all wavenumbers, with the weights of all effects.

    Parameters are those of `sampled_spiral`.
    """
    spiral, middle = Spiral(optics, options, scene, focus, lengths), sum(optics.band) / 2
    lights = []
    for share in spiral.shares(1):
        found = spiral.at(middle, share)
        weight = weights(optics, found.numbers[:, np.newaxis], np.array([middle]))[0]
        ways = found.numbers[FIRST_FIELD + spiral.parts :] if lengths else None
        lights.append(_rays(spiral, found, found.numbers[FIRST_FIELD] * weight, ways))
    return _all_light(lights, options)


def _middle_light(spiral: Spiral, found: Returned, middle: float, segments: int) -> Light:
    """Return the rays at the middle of the band; of polarised light their magnitude."""
    weight = weights_of(spiral, found.numbers[:, np.newaxis], np.array([middle]))[0]
    fields = found.numbers[FIRST_FIELD : FIRST_FIELD + spiral.parts]
    amplitude = fields[0] * weight
    if spiral.optics.effects.vectorial:
        amplitude = np.sqrt((fields**2).sum(axis=0) / (spiral.parts / 2)) * weight
    return _rays(spiral, found, amplitude, None)._replace(segments=segments)


def _rays(spiral: Spiral, found: Returned, amplitude: Floats, ways: Floats | None) -> Light:
    kept = amplitude != 0
    outcomes = found.outcomes.copy()
    # what the trees accept, and the objective or the detector does not
    past = int((~kept & (found.numbers[RIM_SQUARED] > RIM**2)).sum())
    outcomes[[Outcome.DETECTED, Outcome.OFF_OBJECTIVE]] += [-int((~kept).sum()), past]
    outcomes[Outcome.OFF_DETECTOR] += int((~kept).sum()) - past
    even = found.ray % spiral.options["rays"] % 2 == 0
    return Light(
        found.path[kept], amplitude[kept], np.where(even, 2 * amplitude, 0.0)[kept],
        found.numbers[LENGTH][kept], 0.0, found.segments, AccuracyStatus.NOT_CONTROLLED,
        outcomes, ways if ways is None else ways[:, kept],
    )  # fmt: skip
