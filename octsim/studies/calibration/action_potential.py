"""The worked example: a neuron that fires, seen and recovered (`snakemake action_potential`)."""

from typing import Any

import numpy as np
import xarray as xr

from octsim.base.threads import each
from octsim.config.models import Config
from octsim.datasets.files import make
from octsim.instrument.instrument import Instrument
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.derivatives import Array
from octsim.phase.estimators.series import series_phases
from octsim.phase.measured_series import Series, change_from_rest
from octsim.phase.noise import shot_noise
from octsim.stages.focus_law import focus_line
from octsim.studies.calibration.expansion import expansion
from octsim.studies.calibration.round_trips import round_trips, trip_diameters
from octsim.studies.calibration.study import by_fft, calibrating, converged

DURATION = 1e-3
"""Of the action potential at half its height, s (docs/calibration.md cites measured ones)."""
INTERVAL = 50e-6
"""From one spectrum to the next, s: 20 000 a second, as line cameras do."""
SAMPLES = 201
REST = 60
"""Spectra that are taken for those at rest."""


def swelling(time: Array, largest: float) -> Array:
    """Give the change of the diameter over time (s): a Gaussian in the middle, of `DURATION`."""
    middle = (time[0] + time[-1]) / 2
    pulse: Array = largest * np.exp(-4 * np.log(2) * ((time - middle) / DURATION) ** 2)
    return pulse


def action_potential(
    config: Config, calibration: xr.Dataset, law: xr.Dataset | None = None, threads: int = 1
) -> xr.Dataset:
    """Watch a neuron swell, spectrum by spectrum with shot noise, and recover by how much.

    Each spectrum is of the neuron as it is at that time, at a focus that is held. The thesis's way
    is beside: its transform's phase over its predicted slope, n (k_min + k_max).

    Returns
    -------
    Dataset
        Over time: true_expansion, expansion with its errors, fft_expansion; and the round trips,
        over diameters and trials: what they recover, its errors and how often these cover the
        truth.

    Raises
    ------
    OctsimError
        If the diameter is outside the calibration's.
    """
    settings, k = config.action_potential, config.spectrum.wavenumbers()
    time = INTERVAL * np.arange(SAMPLES, dtype=np.float64)
    growth = swelling(time, settings.expansion)
    line = focus_line(config, law)
    focus = line.slope * settings.diameter + line.intercept
    look = Instrument(converged(config)).spectrum
    grown = (settings.diameter + growth).tolist()
    spectra = np.stack(list(each(lambda diameter: look(diameter, focus)[0], grown, threads)))
    counted = shot_noise(spectra, settings.photons, np.random.default_rng(settings.seed))
    depth = config.scene.refractive_index.neuron * settings.diameter
    phase, of_fft = (
        series_phases(counted, k, depth, processing)
        for processing in (calibrating(config), by_fft(config))
    )
    change = change_from_rest(Series(time, phase), REST)
    found = expansion(change.phase, settings.diameter, calibration, change.error)
    fft_change = change_from_rest(Series(time, of_fft), REST)
    predicted = predicted_phase_slope(config.scene.refractive_index.neuron, k[0], k[-1])
    return make(
        "action_potential",
        config,
        "A simulated action potential: expansion, phase, and what is recovered",
        {
            "true_expansion": ("time", 1e3 * growth),
            "phase_change": ("time", change.phase),
            "expansion": ("time", found.expansion),
            "statistical_error": ("time", found.statistical_error),
            "systematic_error": ("time", found.systematic_error),
            "fft_expansion": ("time", 1e3 * fft_change.phase / predicted),
            "diameter": settings.diameter,
            "focus": focus,
            "seed": settings.seed,
            **_trips(config, calibration, law, threads),
        },
        {"time": time, "trip_diameter": trip_diameters(config)},
    )


def _trips(
    config: Config, calibration: xr.Dataset, law: xr.Dataset | None, threads: int
) -> dict[str, Any]:
    """Give what the round trips come to."""
    trips = round_trips(config, calibration, law, threads)
    truth, both = 1e3 * config.action_potential.expansion, trips["both"]
    dimensions = ("trip_diameter", "trial")
    return {
        "trip_expansion": (dimensions, both.recovered),
        "trip_statistical_error": (dimensions, both.statistical_error),
        "trip_systematic_error": (dimensions, both.systematic_error),
        "trip_bias": ("trip_diameter", (both.recovered - truth).mean(axis=1) / truth),
        **{
            f"coverage_{name}": ("trip_diameter", one.covered(truth)) for name, one in trips.items()
        },
    }


def summary(fired: xr.Dataset) -> str:
    """Say in one line what the example comes to."""
    off = fired["expansion"] - fired["true_expansion"]
    return (
        f"expansion of {float(fired['true_expansion'].max()):.4g} nm recovered to "
        f"{1e3 * float(off.std()):.3g} pm rms a spectrum, stated "
        f"{1e3 * float(fired['statistical_error'].mean()):.3g}; of "
        f"{fired['trip_expansion'].size} round trips {float(fired['coverage_both'].mean()):.1%} "
        f"are within their standard error, mean error "
        f"{float(fired['trip_bias'].mean()):+.2%} of the expansion"
    )
