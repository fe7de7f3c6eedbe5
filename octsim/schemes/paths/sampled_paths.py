"""Light paths whose ways or weights depend on the wavenumber, or of polarised light: their field.

At a few nodes of a band all paths are integrated anew. Between them a path's field, without the
phase of its mean optical path, is a polynomial in the wavenumber; where it is none, the band is
halved.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from octsim.optics.polarisation import jones_rows
from octsim.optics.scene import Scene
from octsim.schemes.band_nodes import nodes_within, to_coefficients
from octsim.schemes.field_sum import relative_error
from octsim.schemes.light import AccuracyStatus, Light, Optics, Sampled, attenuated
from octsim.schemes.paths.path_sum import field_of_paths
from octsim.schemes.paths.weighed import Followed, Weighed, are_weighed, followed, weighed
from octsim.schemes.tables_of_indices import phase_left_out
from octsim.tracing.light_paths import first_rays

_FASTEST, _SLOWEST = 0.003, 0.97  # fall of coefficients, from two to the next two
_FEWEST = 5  # nodes of a part of the band
_NOISY = 4.0
"""Coefficients below as many times the error at nodes may be nothing else."""
_PHASE_DEGREE = 2
_ATTEMPTS, _BETTER = 3, 0.1
"""Integrals of one node, at most, and how much smaller the error of the next one is."""
_FOR_PEAK = 64
"""Wavenumbers at which the largest field is looked for."""
_HALF = 0.5  # of the accuracy, for the nodes and for what is between them

Result = TypeVar("Result")


class _Node(NamedTuple):
    """The fields of P light paths at one wavenumber."""

    light: Light
    k: float
    codes: NDArray[np.int64]
    fields: NDArray[np.complex128]
    """(C, P)."""
    length: NDArray[np.float64]
    """Mean optical path, (P,), µm."""
    errors: NDArray[np.float64]
    """Of the fields, (P,)."""

    @property
    def error(self) -> float:
        """Of the whole field."""
        return float(self.errors.sum()) + self.light.missing


@dataclass(frozen=True)
class _Point:
    """A point whose light depends on the wavenumber."""

    optics: Optics
    scene: Scene
    focus: float
    lengths: bool

    def followed_at(self, k: float, accuracy: float) -> Followed:
        """Return its rays at a wavenumber; the same for all, where their ways are the same."""
        return self._followed(k if self.optics.way_varies else sum(self.optics.band) / 2, accuracy)

    @cached_property
    def _followed(self) -> Callable[[float, float], Followed]:
        return cache(lambda k, accuracy: followed(
            self.optics, self.scene, self.focus, k, accuracy, self.lengths
        ))  # fmt: skip


def _reached(
    accuracy: float, first: float, find: Callable[[float], tuple[Result, float]]
) -> tuple[Result, float]:
    """Ask for less and less error until what is found is accurate; return it, and its error."""
    asked = first
    for _ in range(_ATTEMPTS):
        found, error = find(asked)
        if error <= accuracy:
            break
        asked *= _BETTER
    return found, error


def light_of_paths(
    optics: Optics, scene: Scene, focus: float, accuracy: float, lengths: bool
) -> Light:
    """Return the rays of a point that serve all wavenumbers, with the weights of all effects."""
    middle, some = sum(optics.band) / 2, np.linspace(*optics.band, _FOR_PEAK)

    def find(asked: float) -> tuple[Light, float]:
        rays = followed(optics, scene, focus, middle, asked, lengths)
        light = weighed(optics, scene, rays, middle).light
        if not are_weighed(optics):
            return light, 0.0  # but for the error that the integration knows of
        found = field_of_paths(
            light.path, light.amplitude, light.rough_amplitude, light.optical_path_length,
            light.missing, some, asked,
        )  # fmt: skip
        return light, relative_error(float(np.abs(found.values).max(initial=0.0)), found.error)

    light, error = _reached(accuracy, accuracy, find)
    return light._replace(status=_worst([light.status], error, accuracy))


def sampled_paths(
    optics: Optics, scene: Scene, focus: float, accuracy: float, lengths: bool
) -> Sampled:
    """Return the light of a point with its field at the samples of the band.

    Parameters
    ----------
    optics : Optics
    scene : Scene
    focus : float
        Height of the focus at the reference, µm.
    accuracy : float
        Error that is allowed of the intensity: max |ΔI| / max I over the band.
    lengths : bool
        Whether a region takes light.
    """
    if not optics.varies:
        return _of_one_node(optics, scene, focus, accuracy, lengths)
    point = _Point(optics, scene, focus, lengths)

    def find(asked: float) -> tuple[tuple[NDArray[np.complex128], float, list[Light]], float]:
        values, errors, lights = _over_band(point, optics.wavenumber, asked, 0.0)
        return (values, max(errors), lights), _relative_error(values, max(errors))

    (values, error, lights), relative = _reached(accuracy, _HALF * accuracy, find)
    statuses = [one.status for one in lights]
    light = lights[len(lights) // 2]._replace(
        segments=sum(one.segments for one in lights),
        status=_worst(statuses, relative, accuracy),
    )
    return Sampled(light, optics.wavenumber, values, error)


def _over_band(
    point: _Point, k: NDArray[np.float64], accuracy: float, scale: float
) -> tuple[NDArray[np.complex128], list[float], list[Light]]:
    """Return the fields at wavenumbers that are evenly spaced (C, K), their errors, and the light.

    A path whose light ceases to be detected somewhere in the band is no polynomial there: the band
    is halved until that matters no more. `scale` is the largest field that is known of elsewhere.
    """
    number = max(math.ceil(1 - 0.95 * math.log10(accuracy)), _FEWEST)
    if k.size <= number:
        each = [_node(point, one, accuracy) for one in k.tolist()]
        values = np.stack([one.fields.sum(axis=1) for one in each], axis=1)
        return values, [one.error for one in each], [one.light for one in each]
    off = phase_left_out(point.scene, point.optics.detector, point.focus, k[0], k[-1], number)
    if off > accuracy:
        return _in_halves(point, k, accuracy, scale)
    at = nodes_within(k[0], k[-1], number)
    each = [_node(point, one, accuracy) for one in at.tolist()]
    lights = [one.light for one in each]
    phase, slow, noise = _coefficients(each)
    sizes = np.abs(slow)
    left = _left_out(sizes, noise) + off * float(sizes.sum(axis=(0, 2)).max(initial=0.0))
    scale = max(scale, *(_size(one) for one in each))
    if relative_error(scale, left) > accuracy:
        values, errors, more = _in_halves(point, k, accuracy, scale)
        return values, errors, lights + more
    place = np.linspace(-1, 1, k.size)
    turned = np.exp(1j * chebyshev.chebval(place, phase))
    values = (chebyshev.chebval(place, slow) * turned).sum(axis=1)
    return values, [left + max(one.error for one in each)], lights


def _in_halves(
    point: _Point, k: NDArray[np.float64], accuracy: float, scale: float
) -> tuple[NDArray[np.complex128], list[float], list[Light]]:
    """Return what `_over_band` does, of one half of the band and then of the other."""
    first, second = (_over_band(point, part, accuracy, scale) for part in np.array_split(k, 2))
    values = np.concatenate((first[0], second[0]), axis=1)
    return values, first[1] + second[1], first[2] + second[2]


def _left_out(sizes: NDArray[np.float64], noise: NDArray[np.float64]) -> float:
    """Return what Chebyshev coefficients (M, C, P) of paths say of those that would follow.

    `noise` (P,) is what the fields at the nodes are off.
    """
    last, before = sizes[-2:].sum(axis=0), sizes[-4:-2].sum(axis=0)
    fall = np.clip(last / np.where(before > 0, before, 1), _FASTEST, _SLOWEST)
    left = 2 * last * fall / (1 - fall)
    # coefficients that noise makes do not fall, and say nothing of others
    left = np.where(last < _NOISY * noise, np.minimum(left, _NOISY * noise), left)
    # a faint path is there at some nodes only; what it can leave out is no more than all of it
    left = np.minimum(left, sizes.sum(axis=0)).sum(axis=-1)
    return float(left.max(initial=0.0))


def _of_one_node(
    optics: Optics, scene: Scene, focus: float, accuracy: float, lengths: bool
) -> Sampled:
    """Return the light of rays that are the same at all wavenumbers, in each detected field."""
    k, middle = optics.wavenumber, sum(optics.band) / 2

    def find(asked: float) -> tuple[Sampled, float]:
        rays = followed(optics, scene, focus, middle, asked, lengths)
        found = weighed(optics, scene, rays, middle)
        light = attenuated(found.light, scene, middle)
        values, error = [], 0.0
        for row in _rows(optics, found):
            parts = [
                field_of_paths(
                    light.path, light.amplitude * part, light.rough_amplitude * part,
                    light.optical_path_length, light.missing, k, asked,
                )
                for part in (row.real, row.imag)
            ]  # fmt: skip
            values.append(parts[0].values[0] + 1j * parts[1].values[0])
            error = max(error, float(np.hypot(parts[0].error, parts[1].error)))
        whole = np.stack(values)
        return Sampled(light, k, whole, error), _relative_error(whole, error)

    found, relative = _reached(accuracy, accuracy, find)
    rays = found.rays
    return found._replace(rays=rays._replace(status=_worst([rays.status], relative, accuracy)))


def _relative_error(values: NDArray[np.complex128], error: float) -> float:
    """Return the error of the intensity of fields (C, K), over its largest."""
    largest = float(np.sqrt((np.abs(values) ** 2).mean(axis=0).max(initial=0.0)))
    return relative_error(largest, error)


def _node(point: _Point, k: float, accuracy: float) -> _Node:
    optics, scene = point.optics, point.scene
    found = weighed(optics, scene, point.followed_at(k, accuracy), k)
    light = attenuated(found.light, scene, k)
    # the rays of a path stand together
    begin = first_rays(light.path)
    turned = np.exp(1j * k * light.optical_path_length) * _rows(optics, found)

    def of_paths(values: NDArray[Any]) -> NDArray[Any]:
        whole: NDArray[Any] = values[..., :0]
        return np.add.reduceat(values, begin, axis=-1) if begin.size else whole

    fields, size = of_paths(light.amplitude * turned), of_paths(np.abs(light.amplitude))
    rough = of_paths(light.rough_amplitude * turned)
    reach = of_paths(np.abs(light.amplitude) * light.optical_path_length)
    errors = np.abs(rough - fields).max(axis=0)
    return _Node(light, k, light.path[begin], fields, reach / np.where(size > 0, size, 1), errors)


def _size(node: _Node) -> float:
    return float(np.sqrt((np.abs(node.fields.sum(axis=1)) ** 2).mean()))


def _coefficients(
    each: Sequence[_Node],
) -> tuple[NDArray[np.float64], NDArray[np.complex128], NDArray[np.float64]]:
    """Return Chebyshev coefficients of each path's phase, (M, P), and slow field, (M, C, P).

    The last is the largest error of its field at the nodes, (P,).
    """
    codes = np.unique(np.concatenate([one.codes for one in each]))
    fields = np.zeros((len(each), each[0].fields.shape[0], codes.size), np.complex128)
    length, noise = np.full((len(each), codes.size), np.nan), np.zeros(codes.size)
    for node, one in enumerate(each):
        column = np.searchsorted(codes, one.codes)
        fields[node][:, column], length[node, column] = one.fields, one.length
        noise[column] = np.maximum(noise[column], one.errors)
    # where a path is too faint to be there, any length will do
    length = np.where(np.isnan(length), np.nanmean(length, axis=0), length)
    place, k = chebyshev.chebpts1(len(each)), np.array([one.k for one in each])
    # of a low degree: a mean length is known only as well as the integrals are
    phase = chebyshev.chebfit(place, k[:, np.newaxis] * length, _PHASE_DEGREE)
    turned = np.exp(-1j * chebyshev.chebval(place, phase)).T
    slow = fields * turned[:, np.newaxis]
    return phase, np.tensordot(to_coefficients(len(each)), slow, axes=1), noise


def _rows(optics: Optics, found: Weighed) -> NDArray[np.complex128]:
    """Return what rays have in each detected field over their amplitudes, (C, D)."""
    if not optics.effects.vectorial:
        return found.fields[:1]
    return jones_rows(optics.polarisation, optics.azimuth) @ found.fields


def _worst(statuses: Sequence[AccuracyStatus], error: float, accuracy: float) -> AccuracyStatus:
    """Return the status of all nodes together, and of the whole's error."""
    amiss = [one for one in statuses if one != AccuracyStatus.REACHED]
    if amiss:
        return amiss[0]
    return AccuracyStatus.REACHED if error <= accuracy else AccuracyStatus.NOT_REACHED
