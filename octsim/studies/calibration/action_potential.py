"""The worked example: a neuron that fires, seen and recovered (`snakemake action_potential`)."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from octsim.config.derive import calibrating
from octsim.config.given import taking_config
from octsim.config.models import Config
from octsim.datasets.files import flags_of_missing, make
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.derivatives import Array
from octsim.phase.estimators.series import series_phases
from octsim.phase.measured_series import Series, change_from_rest
from octsim.phase.noise import shot_noise
from octsim.stages.focus_law import focus_line
from octsim.studies.calibration.expansion import expansion
from octsim.studies.calibration.missing import SystematicStatus
from octsim.studies.calibration.round_trips import Trips, round_trips, trip_diameters
from octsim.studies.calibration.scheme import converged
from octsim.studies.calibration.study import by_fft

DURATION = 1e-3
"""Of the action potential at half its height, s (docs/calibration.md cites measured ones)."""
INTERVAL = 50e-6
"""From one spectrum to the next, s: 20 000 a second, as line cameras do."""
SAMPLES = 201
REST = 60
"""Spectra that are taken for those at rest."""


def swelling(time: Array, largest: float) -> Array:
    """Return the change of the diameter over time (s): a Gaussian in the middle, of `DURATION`."""
    middle = (time[0] + time[-1]) / 2
    pulse: Array = largest * np.exp(-4 * np.log(2) * ((time - middle) / DURATION) ** 2)
    return pulse


@taking_config
def action_potential(
    config: Config,
    calibration: xr.Dataset,
    law: xr.Dataset | None = None,
    threads: int = 1,
    points: Points | None = None,
) -> xr.Dataset:
    """Watch a neuron swell, spectrum by spectrum with shot noise, and recover by how much.

    Each spectrum is of the neuron as it is at that time, at a focus that is held. The thesis's way
    is beside: its transform's phase over its predicted slope, n (k_min + k_max).

    Parameters
    ----------
    config : Config
    calibration : Dataset
        Of the config.
    law : Dataset, optional
        The fitted law; needed only where ``sweep.focus`` is ``law``.
    threads : int
        How many spectra, and round trips, are at work at a time.
    points : Points, optional
        Where light that was found before is kept.

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

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "action_potential": {"diameter": "1.4 um"},
    ...         "sweep": {"focus": {"slope": 0.58, "intercept": "66 nm"}},
    ...         "calibration": {
    ...             "diameters": {"start": "1.35 um", "stop": "1.45 um", "num": 8},
    ...             "scheme": "paths",
    ...         },
    ...     }
    ... )
    >>> calibration = octsim.calibration(config)
    >>> seen = octsim.action_potential(config, calibration)
    >>> seen["expansion"].dims
    ('time',)
    """
    settings, instrument = config.action_potential, Instrument(converged(config), points)
    k = instrument.wavenumber
    time = INTERVAL * np.arange(SAMPLES, dtype=np.float64)
    growth = swelling(time, settings.expansion)
    line = focus_line(config, law)
    focus = line.slope * settings.diameter + line.intercept
    grown = settings.diameter + growth
    spectra = instrument.spectra(grown, np.full(grown.size, focus), threads)
    counted = shot_noise(spectra, settings.photons, np.random.default_rng(settings.seed))
    depth = float(instrument.nominal_depth(np.array(settings.diameter)))
    phase, of_fft = (
        series_phases(counted, k, depth, processing, instrument.power)
        for processing in (calibrating(config), by_fft(config))
    )
    change = change_from_rest(Series(time, phase), REST)
    found = expansion(change.phase, settings.diameter, calibration, change.error)
    fft_change = change_from_rest(Series(time, of_fft), REST)
    predicted = predicted_phase_slope(config.swept_material, k[0], k[-1])
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
            "systematic_status": (
                "time",
                *flags_of_missing(found.systematic_error, SystematicStatus.NOT_KNOWN),
            ),
            "fft_expansion": ("time", 1e3 * fft_change.phase / predicted),
            "diameter": settings.diameter,
            "focus": focus,
            "seed": settings.seed,
            **_trips(config, round_trips(config, calibration, law, threads, points)),
        },
        {"time": time, "trip_diameter": trip_diameters(config)},
    )


def _trips(config: Config, trips: Mapping[str, Trips]) -> dict[str, Any]:
    """Return what the round trips come to, as variables."""
    truth, both = 1e3 * config.action_potential.expansion, trips["both"]
    dimensions = ("trip_diameter", "trial")
    return {
        "trip_expansion": (dimensions, both.recovered),
        "trip_statistical_error": (dimensions, both.statistical_error),
        "trip_systematic_error": (dimensions, both.systematic_error),
        "trip_systematic_status": (
            dimensions,
            *flags_of_missing(both.systematic_error, SystematicStatus.NOT_KNOWN),
        ),
        "trip_bias": ("trip_diameter", (both.recovered - truth).mean(axis=1) / truth),
        **{
            f"coverage_{name}": ("trip_diameter", one.covered(truth)) for name, one in trips.items()
        },
    }


def summary(fired: xr.Dataset) -> str:
    """Return what the example comes to, in one line."""
    off = fired["expansion"] - fired["true_expansion"]
    return (
        f"expansion of {float(fired['true_expansion'].max()):.4g} nm recovered to "
        f"{1e3 * float(off.std()):.3g} pm rms a spectrum, stated "
        f"{1e3 * float(fired['statistical_error'].mean()):.3g}; of "
        f"{fired['trip_expansion'].size} round trips {float(fired['coverage_both'].mean()):.1%} "
        f"are within their standard error, mean error "
        f"{float(fired['trip_bias'].mean()):+.2%} of the expansion"
    )
