"""Round trips: from an expansion through noisy instruments that are not as believed, and back."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from octsim.base.threads import each
from octsim.config.derive import calibrating
from octsim.config.following import calibration_diameters
from octsim.config.models import Config
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.phase.derivatives import Array
from octsim.phase.estimators.series import series_phases
from octsim.phase.measured_series import Series, change_from_rest
from octsim.phase.noise import shot_noise
from octsim.stages.focus_law import focus_line
from octsim.studies.calibration.expansion import expansion
from octsim.studies.calibration.scheme import converged
from octsim.studies.calibration.sensitivity import Expansion
from octsim.studies.calibration.tolerances import Place, drawn

TRIALS = 200
"""Round trips at each diameter."""
PLACES = (0.05, 0.3, 0.5, 0.7, 0.95)
"""Where in the calibration's range they are, apart from which they are between its diameters."""
REST = 32
"""Spectra at rest in each."""


class Trips(NamedTuple):
    """Round trips at D diameters, N each: recovered expansions and their errors, nm, (D, N)."""

    recovered: Array
    statistical_error: Array
    systematic_error: Array

    def covered(self, truth: float) -> Array:
        """Return the fraction of trips, (D,), within their standard error, both parts together."""
        stated = np.hypot(self.statistical_error, self.systematic_error)
        within: Array = (np.abs(self.recovered - truth) <= stated).mean(axis=1)
        return within


def trip_diameters(config: Config) -> Array:
    """Return the diameters of the round trips, (D,), µm: halfway between the calibration's."""
    table = calibration_diameters(config).values()
    left = (np.array(PLACES) * (table.size - 2)).round().astype(int)
    between: Array = (table[left] + table[left + 1]) / 2
    return between


def _recover(
    config: Config, calibration: xr.Dataset, pair: Array, diameter: float,
    generator: np.random.Generator | None,
) -> Expansion:  # fmt: skip
    """Return what is recovered from a spectrum at rest and one after it, (2, K), maybe with noise.

    The phases of the spectra at rest are all that is known of the noise.
    """
    spectra = pair[[0] * REST + [1]]
    if generator is not None:
        spectra = shot_noise(spectra, config.action_potential.photons, generator)
    depth = config.swept_group_index * diameter
    k, power = config.spectrum.wavenumbers(), config.spectrum.power()
    phase = series_phases(spectra, k, depth, calibrating(config), power)
    series = Series(np.arange(REST + 1.0), phase)
    change = change_from_rest(series, REST)
    found = expansion(change.phase[-1:], diameter, calibration, change.error[-1:])
    return Expansion(*(part[0] for part in found))


def _pair(
    instrument: Instrument,
    place: Place,
    diameter: float,
    focus: float,
    grown: float,
) -> Array:
    """Return the spectra at rest and after it, (2, K), of a neuron that grows, µm."""
    at, height = diameter + place.diameter, focus + place.focus
    return instrument.spectra((at, at + grown), (height, height))


def round_trips(
    config: Config,
    calibration: xr.Dataset,
    law: xr.Dataset | None,
    threads: int,
    points: Points | None = None,
) -> dict[str, Trips]:
    """Return what ``action_potential.expansion`` is recovered as, many times.

    Returns
    -------
    dict
        ``noise``: an instrument as believed, with shot noise, and no systematic error stated;
        ``instrument``: instruments drawn from the tolerances, without noise; ``both``.
    """
    exact, grown = converged(config), config.action_potential.expansion
    diameters = trip_diameters(config)
    line = focus_line(config, law)
    foci = line.at(diameters)
    instrument = Instrument(exact, points)
    believed = [
        _pair(instrument, Place(exact, 0.0, 0.0), diameter, focus, grown)
        for diameter, focus in zip(diameters.tolist(), foci.tolist(), strict=True)
    ]
    seeds = np.random.SeedSequence(config.action_potential.seed).spawn(diameters.size * TRIALS)

    def trip(number: int) -> list[Expansion]:
        generator = np.random.default_rng(seeds[number])
        at = number // TRIALS
        diameter, focus = float(diameters[at]), float(foci[at])
        place = drawn(exact, generator, line.slope)
        other = _pair(Instrument(place.config, points), place, diameter, focus, grown)
        return [
            _recover(config, calibration, believed[at], diameter, generator)._replace(
                systematic_error=np.zeros(())
            ),
            _recover(config, calibration, other, diameter, None),
            _recover(config, calibration, other, diameter, generator),
        ]

    trips = list(each(trip, range(len(seeds)), threads))
    parts = np.array([[part for one in trip for part in one] for trip in trips], float)
    shaped = parts.reshape(diameters.size, TRIALS, 3, 3)
    return {
        name: Trips(*(shaped[:, :, kind, part] for part in range(3)))
        for kind, name in enumerate(("noise", "instrument", "both"))
    }
