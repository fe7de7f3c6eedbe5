"""What is not known of an expansion: by the photons, and by what is off, for each estimator."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from octsim.config.processing import Processing
from octsim.optics.materials import Material
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.cramer_rao import diameter_bound
from octsim.phase.derivatives import Array, derivative, wrapped
from octsim.phase.estimators import phases
from octsim.phase.estimators.estimate import at_depth
from octsim.phase.estimators.likelihood import Model, maximum_likelihood
from octsim.phase.estimators.series import series_phases
from octsim.phase.estimators.visible import Fringe, fringe_at
from octsim.phase.fringe_status import WITH_PHASE
from octsim.phase.noise import shot_noise
from octsim.phase.transform import prepared, window_samples, without_source
from octsim.studies.design.cell import OFFSETS, SIDES, Seen
from octsim.studies.design.settings import PARAMETERS, STEP

DRAWS = 64
"""Noisy spectra of each setting, the same noise for all of a diameter: a standard error by them is
known to 9 %, and its mean over D diameters to 9 % / √D."""
SEED = 20261129
_WEIGHTED = Processing.model_validate({"centre": "weighted"})


class Neuron(NamedTuple):
    """What an estimator is told, and what it compares with."""

    diameter: float
    """At rest, µm."""
    n_neuron: float
    """Its group index, of optical depths."""
    wavenumber: Array
    """(K,), 1/µm."""
    around: Array
    """Modelled spectra at `OFFSETS` of the diameter, (5, K)."""
    material: Material | None = None
    """What it is of; None is of an index that is the same at all wavenumbers."""
    power: Array | None = None
    """Of the source, (K,); None of a flat one."""


Estimator = Callable[[Neuron, Array, Array], Array]
"""Takes spectra (S, K) and the offsets (S,) of their diameters, µm; returns phases (S,), rad."""


def _held(**given: object) -> Estimator:
    processing = Processing.model_validate(given)

    def estimator(neuron: Neuron, spectra: Array, _: Array) -> Array:
        depth = neuron.n_neuron * neuron.diameter
        return series_phases(spectra, neuron.wavenumber, depth, processing, neuron.power)

    return estimator


def _following(neuron: Neuron, spectra: Array, offset: Array) -> Array:
    depth = neuron.n_neuron * (neuron.diameter + offset)
    sinusoid = Processing.model_validate({"estimator": "sinusoid"})
    return phases(spectra, neuron.wavenumber, depth, sinusoid, neuron.power).phase


def _likeliest(neuron: Neuron, spectra: Array, _: Array) -> Array:
    """Return the likeliest diameters, as phases of the prediction."""
    k = neuron.wavenumber
    found = maximum_likelihood(spectra, Model(neuron.diameter + OFFSETS, neuron.around))
    return predicted_phase_slope(neuron.material or neuron.n_neuron, k[0], k[-1]) * found


ESTIMATORS: Mapping[str, Estimator] = {
    "sinusoid": _held(estimator="sinusoid"),
    "sinusoid_following": _following,
    "fft": _held(),
    "zero_padded": _held(estimator="zero_padded", centre="weighted"),
    "hilbert": _held(estimator="hilbert"),
    "maximum_likelihood": _likeliest,
}
"""Those compared; the first two differ in the frequency of the sinusoid, which is that of the
neuron at rest, or that of each diameter."""


class Known(NamedTuple):
    """How well one focus, fill and band know an expansion."""

    slope: Array
    """Of each estimator, (E,), mrad/nm; NaN without a fringe, as all else is."""
    statistical: Array
    """Standard error of one spectrum's diameter by its photons, (E,), nm."""
    relative: Array
    """Relative standard error of the slope by each of `PARAMETERS`, (E, P)."""
    bound: float
    """Least standard error that any estimator can have, Cramér and Rao's, nm."""
    brightness: float
    """Mean intensity over the band."""
    depth_peak: float
    """Amplitude in the depth profile at the neuron's optical depth."""
    fringe: Fringe
    """Of the neuron at rest, (1,)."""


def known(
    seen: Seen, neuron: Neuron, photons: float, tolerance: float, seed: tuple[int, ...]
) -> Known:
    """Return how well spectra know an expansion.

    Parameters
    ----------
    seen : Seen
        Of a focus, a fill and a band.
    neuron : Neuron
        As it is believed to be.
    photons : float
        Detected in a spectrum.
    tolerance : float
        One standard deviation of the diameter at rest, µm.
    seed : tuple of int
        Of the noise.
    """
    middle = OFFSETS.size // 2
    rest = seen.around[middle]
    depth = np.array([neuron.n_neuron * neuron.diameter])
    fringe = fringe_at(rest[np.newaxis], neuron.wavenumber, depth, seen.error, neuron.power)
    nothing = np.full(len(ESTIMATORS), np.nan)
    brightness, height = (
        float(rest.mean()),
        _depth_peak(rest, neuron.wavenumber, depth, neuron.power),
    )
    if fringe.status[0] not in WITH_PHASE:
        none = np.full((len(ESTIMATORS), len(PARAMETERS)), np.nan)
        return Known(nothing, nothing, none, np.nan, brightness, height, fringe)
    counts = photons / rest.sum()
    alike = np.broadcast_to(rest, (DRAWS, rest.size))
    drawn = shot_noise(alike, photons, np.random.default_rng(seed))
    exact = np.concatenate([seen.around, *seen.off.values()])
    series = np.concatenate([counts * exact, drawn])
    offset = np.concatenate([OFFSETS, *(SIDES for _ in seen.off), np.zeros(DRAWS)])
    of_each = [
        _by(estimator(neuron, series, offset), list(seen.off), tolerance)
        for estimator in ESTIMATORS.values()
    ]
    slope, statistical, relative = (np.array(part) for part in zip(*of_each, strict=True))
    change = derivative(OFFSETS, seen.around).value
    bound = 1e3 * diameter_bound(rest, change, photons)
    return Known(slope, statistical, relative, bound, brightness, height, fringe)


def _depth_peak(spectrum: Array, wavenumber: Array, depth: Array, power: Array | None) -> float:
    """Return the amplitude of a spectrum (K,) at a depth (1,), of cos(2zk) 1, by a window."""
    shaped = prepared(without_source(spectrum[np.newaxis], power), _WEIGHTED)
    height = np.abs(at_depth(shaped, wavenumber, depth)[0])
    window = window_samples(_WEIGHTED.window, wavenumber.size)
    return float(2 * height / (window if power is None else window * power).sum())


def _by(phase: Array, names: list[str], tolerance: float) -> tuple[float, float, Array]:
    """Return slope, statistical error (nm) and relative errors (P,) of an estimator's phases."""
    first = OFFSETS.size
    around = wrapped(phase[:first] - phase[first // 2])
    slope = float(derivative(OFFSETS, around).value)
    pairs = phase[first : first + 2 * len(names)].reshape(-1, 2)
    noisy = wrapped(phase[first + pairs.size :] - phase[first // 2])
    own = (around[3] - around[1]) / (2 * STEP)
    moved = wrapped(pairs[:, 1] - pairs[:, 0]) / (2 * STEP) - own
    # of the mean slope from one side of the diameter to the other
    bend = (around[0] + around[-1]) / OFFSETS[-1] ** 2
    off = {"diameter": bend * tolerance} | dict(zip(names, moved.tolist(), strict=True))
    relative = np.array([off[name] for name in PARAMETERS]) / slope
    return slope, 1e3 * float(noisy.std(ddof=1)) / abs(slope), np.abs(relative)
