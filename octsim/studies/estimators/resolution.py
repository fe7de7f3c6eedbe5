"""Resolution of a diameter under shot and read noise, beside the Cramér–Rao bound."""

from typing import NamedTuple

import numpy as np

from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.instrument.points import Points
from octsim.phase.cramer_rao import checked_slope, diameter_bound
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.estimate import Array
from octsim.phase.estimators.likelihood import Model
from octsim.phase.modelled_spectra import modelled
from octsim.phase.noise import measured_counts, photons_for
from octsim.studies.estimators.contenders import LIKELIHOOD, Band, phases_of_series

RATIOS = (20.0, 30.0, 40.0, 50.0, 60.0)
"""Signal-to-noise ratios, dB."""
RUNS = 400
"""Noisy spectra of each."""
STEP = 5e-4
"""Of the diameter, µm, for derivatives."""
_MODEL = np.linspace(-0.06, 0.06, 25)  # µm about the diameter, of maximum likelihood's model


class Surroundings(NamedTuple):
    """Spectra around a diameter whose resolution is looked for, at a fixed focus."""

    diameter: float
    """µm."""
    spectra: Array
    """Spectra at −2, −1, 0, 1, 2 steps of the diameter, (5, K)."""
    slope: Array
    """Derivative of the spectrum by the diameter, (K,)."""
    model: Model
    """Spectra about it."""


class Resolution(NamedTuple):
    """What noise leaves of one diameter."""

    photons: float
    """Expected in a spectrum."""
    bound: float
    """Cramér–Rao bound of the diameter, µm."""
    of_each: dict[str, float]
    """Root mean square error of the diameter by each estimator, µm."""


def surroundings_of(
    config: Config, diameter: float, focus: float, points: Points | None = None
) -> Surroundings:
    """Return the spectra that one diameter (µm) at a fixed focus (µm) needs.

    Raises
    ------
    OctsimError
        If the derivative by the diameter is not the same by two steps.
    """

    def at(offsets: Array) -> Model:
        return modelled(config, diameter + offsets, np.full(offsets.size, focus), points=points)

    spectra = at(STEP * np.arange(-2.0, 3.0)).intensity
    return Surroundings(diameter, spectra, checked_slope(spectra, STEP), at(_MODEL))


def resolution(
    around: Surroundings,
    band: Band,
    compared: dict[str, Processing],
    decibels: float,
    read_noise: float,
    seed: tuple[int, ...],
    runs: int = RUNS,
) -> Resolution:
    """Return how far off each estimator's diameter is, of noisy spectra that are drawn.

    A phase's error is divided by the slope that the same estimator has there at a fixed focus, by
    central differences.

    Parameters
    ----------
    around : Surroundings
        Of the diameter.
    band : Band
        Of its spectra.
    compared : dict
        Processing of each estimator.
    decibels : float
        Signal-to-noise ratio, 10 log₁₀ of `octsim.phase.noise.signal_to_noise`.
    read_noise : float
        Standard deviation of a dark sample, in photons.
    seed : tuple of int
        Seed of the draws.
    runs : int
        Number of noisy spectra.
    """
    spectrum = around.spectra[2]
    photons = photons_for(spectrum, 10 ** (decibels / 10), read_noise)
    bright = np.broadcast_to(spectrum, (runs, spectrum.size))
    counts = measured_counts(bright, photons, read_noise, np.random.default_rng(seed))
    with_noise = {
        name: processing.model_copy(update={"read_noise": read_noise})
        for name, processing in compared.items()
    }
    # without noise the same light, so that read noise has the same weight
    clean = around.spectra * (photons / spectrum.sum())
    of_each = {name: _error(one, band, around, clean, counts) for name, one in with_noise.items()}
    bound = diameter_bound(spectrum, around.slope, photons, read_noise)
    return Resolution(photons, bound, of_each)


def _error(
    processing: Processing, band: Band, around: Surroundings, clean: Array, counts: Array
) -> float:
    """Return the root mean square error of the diameter, µm; NaN if a run has no estimate."""
    # one series, so that what is common to it (a component, an envelope) is so to both
    series = np.concatenate([clean, counts])
    phases = phases_of_series(processing, band, around.diameter, series, around.model)
    known, noisy = phases[: clean.shape[0]], phases[clean.shape[0] :]
    if processing.estimator == LIKELIHOOD:
        known[2] = band.predicted * around.diameter  # not of the model: the truth
    slope = wrapped(known[4] - known[0]) / (4 * STEP)
    off = wrapped(noisy - known[2])
    return float(np.sqrt(np.mean(off**2)) / abs(slope))
