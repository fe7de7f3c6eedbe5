"""The responses of one neuron: of its phases and of its spectrum, with their errors."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from octsim.config.models import Config
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.phase.derivatives import Array, derivative, stencil, wrapped
from octsim.phase.estimators.changes import likeliest_changes
from octsim.phase.noise import expected_counts, shot_noise
from octsim.studies.calibration.parameters import parameters_of
from octsim.studies.calibration.tolerances import moved, nodes_of
from octsim.studies.responses.observables import Observer, observer_of, side_advances
from octsim.studies.responses.quantities import Changed, Quantity, room_of, with_change

DRAWS = 400
"""Noisy spectra that the errors of phases are by: each is known to 3.5 %."""
TRIAL = 0.2
"""Change of every quantity at once in a trial, nm or 1e-3 of the index."""


class Bench(NamedTuple):
    """An instrument, solved as accurately as small steps need, and what changes in it."""

    config: Config
    quantities: tuple[Quantity, ...]
    law_slope: float
    """Of the focus over the diameter."""
    points: Points | None

    def instrument(self, config: Config) -> Instrument:
        """Return the instrument of a config, whose light is kept."""
        return Instrument(config, self.points)


class _Seen(NamedTuple):
    """What is seen of a quantity at five changes of it."""

    offsets: Array
    intensity: Array
    """(5, K)."""
    sides: Array
    """Turn of each side's light from rest, rad, (5, 2)."""


def _stencil(bench: Bench, quantity: Quantity) -> Array:
    at, least = room_of(bench.config, quantity)
    return stencil(at, quantity.step, least)


def responses_at(bench: Bench, diameter: float, focus: float) -> dict[str, Any]:
    """Return what changes of each quantity do to a neuron's light, by the variables' names.

    Parameters
    ----------
    bench : Bench
    diameter, focus : float
        µm; the focus is held.

    Returns
    -------
    dict
        Phases are of M observables, each quantity's unit is a nanometre or 1e-3 of an index.
    """
    config = bench.config
    own = bench.instrument(config)
    k = own.wavenumber
    middle = float((k[0] + k[-1]) / 2)
    light = own.light(diameter, focus)
    rest = own.sum(light)
    depth = float(own.nominal_depth(np.array(diameter)))
    observer = observer_of(config, rest.intensity, depth)
    errors, status = [rest.error], [rest.status]

    def at(place: Changed) -> tuple[Any, Array]:
        instrument = bench.instrument(place.config)
        found = instrument.light(diameter + place.diameter, focus)
        summed = instrument.sum(found)
        errors.append(summed.error)
        status.append(summed.status)
        return found, summed.intensity

    def seen(quantity: Quantity) -> _Seen:
        offsets = _stencil(bench, quantity)
        there = [
            at(with_change(config, quantity, by)) if by else (light, rest.intensity)
            for by in offsets.tolist()
        ]
        turned = side_advances(light, [found for found, _ in there], middle)
        return _Seen(offsets, np.stack([intensity for _, intensity in there]), turned)

    every = [seen(quantity) for quantity in bench.quantities]
    phases = [_phase_response(observer, rest.intensity, one) for one in every]
    shape = [derivative(one.offsets, one.intensity) for one in every]
    size = [np.abs(one.value).max() or 1.0 for one in shape]
    # a thousandth of µm or of an index is a unit
    response = 1e-3 * np.stack([one.value for one in shape])
    given = config.action_potential
    generator = np.random.default_rng(given.seed)
    noisy = _noise(observer, rest.intensity, given.photons, generator)
    trial = _trial(bench, diameter, focus, rest.intensity, response, generator)
    return {
        "depth": np.append(observer.depths, [np.nan, np.nan]),
        "phase_response": np.stack([value for value, _ in phases], axis=1),
        "phase_response_difference_error": np.stack([off for _, off in phases], axis=1),
        "phase_noise_covariance": noisy,
        "intensity": rest.intensity,
        "intensity_response": response,
        "intensity_response_error": np.array(
            [one.error.max() / largest for one, largest in zip(shape, size, strict=True)]
        ),
        "trial_bias": trial[0],
        "trial_coverage": trial[1],
        "intensity_error": max(errors),
        "accuracy_status": max(status),
    }


def _phase_response(observer: Observer, rest: Array, seen: _Seen) -> tuple[Array, Array]:
    """Return the derivatives of phases by a quantity, rad per µm or index, and their errors."""
    here = observer.phases(rest[np.newaxis])
    phases = np.column_stack([wrapped(observer.phases(seen.intensity) - here), seen.sides])
    found = derivative(seen.offsets, phases)
    return found.value, found.error


def _noise(
    observer: Observer, rest: Array, photons: float, generator: np.random.Generator
) -> Array:
    """Return the covariance of the phases by shot noise, mrad², (M, M); NaN of the sides."""
    alike = np.broadcast_to(rest, (DRAWS, rest.size))
    counted = observer.phases(shot_noise(alike, photons, generator))
    off = 1e3 * wrapped(counted - observer.phases(rest[np.newaxis]))
    covariance = np.full((off.shape[1] + 2,) * 2, np.nan)
    covariance[:-2, :-2] = np.cov(off.T)
    return covariance


def _trial(
    bench: Bench, diameter: float, focus: float, rest: Array, response: Array,
    generator: np.random.Generator,
) -> tuple[Array, Array]:  # fmt: skip
    """Return the mean error of changes that are fitted to noisy spectra, and how often it covers.

    All quantities have changed by `TRIAL`: Maxwell's spectrum of that neuron, not a straight one.
    """
    there = Changed(bench.config)
    for quantity in bench.quantities:
        change = with_change(there.config, quantity, 1e-3 * TRIAL)
        there = Changed(change.config, there.diameter + change.diameter)
    instrument = bench.instrument(there.config)
    spectrum = instrument.spectrum(diameter + there.diameter, focus).intensity
    # the same photons for the light as at rest: a brighter neuron has more
    scale = expected_counts(rest, bench.config.action_potential.photons).sum() / rest.sum()
    counts = generator.poisson(scale * spectrum, (DRAWS, rest.size)).astype(float)
    found = likeliest_changes(counts, rest, response)
    off = found.value - TRIAL
    stated = np.sqrt(np.diagonal(found.covariance, axis1=1, axis2=2))
    return off.mean(axis=0), (np.abs(off) <= stated).mean(axis=0)


def shifts_at(bench: Bench, diameter: float, focus: float) -> Array:
    """Return how the responses differ if what is believed is off by a tolerance.

    Returns
    -------
    ndarray, shape (P, 2, M, Q)
        Of each parameter of the calibration at Gauss and Hermite's two outer nodes of three, times
        the root of their weight: the covariance of the responses is the sum of their squares.
    """
    config = bench.config
    own = bench.instrument(config)
    light = own.light(diameter, focus)
    depth = float(own.nominal_depth(np.array(diameter)))
    observer = observer_of(config, own.sum(light).intensity, depth)
    middle = float((own.wavenumber[0] + own.wavenumber[-1]) / 2)

    def slopes(other: Config, beside: float, above: float) -> Array:
        pairs = [
            _pair(bench, other, one, diameter + beside, focus + above) for one in bench.quantities
        ]
        return np.stack([_pair_slope(observer, pair, middle) for pair in pairs], axis=1)

    here = slopes(config, 0.0, 0.0)
    found = []
    for name in parameters_of(config):
        nodes = nodes_of(config, name)
        ends = np.sqrt(3) * nodes.tolerance * np.array([-1.0, 1.0])
        rows = []
        for by in np.clip(ends, nodes.offset[0], nodes.offset[-1]).tolist():
            place = moved(config, {name: by}, bench.law_slope)
            off = slopes(place.config, place.diameter, place.focus) - here if by else 0 * here
            rows.append(off / np.sqrt(6))
        found.append(rows)
    return np.array(found)


class _Pair(NamedTuple):
    """A neuron before and after a small change."""

    width: float
    light: Sequence[Any]
    intensity: Array


def _pair(bench: Bench, config: Config, quantity: Quantity, diameter: float, focus: float) -> _Pair:
    at, least = room_of(config, quantity)
    ends = stencil(at, quantity.step, least)[[0, -1]]
    found, spectra = [], []
    for by in ends.tolist():
        place = with_change(config, quantity, by)
        instrument = bench.instrument(place.config)
        light = instrument.light(diameter + place.diameter, focus)
        found.append(light)
        spectra.append(instrument.sum(light).intensity)
    return _Pair(float(ends[1] - ends[0]), found, np.stack(spectra))


def _pair_slope(observer: Observer, pair: _Pair, middle: float) -> Array:
    before, after = observer.phases(pair.intensity)
    turned = side_advances(pair.light[0], [pair.light[1]], middle)[0]
    change: Array = np.append(wrapped(after - before), turned) / pair.width
    return change
