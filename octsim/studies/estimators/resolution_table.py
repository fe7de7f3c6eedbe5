"""Resolution by each estimator over the signal-to-noise ratio, at diameters of a sweep."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from octsim.base.threads import each
from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.datasets.files import flags_of_missing
from octsim.instrument.points import Points
from octsim.phase.estimators.estimate import Array
from octsim.studies.estimators.contenders import Band, EstimateStatus
from octsim.studies.estimators.resolution import (
    RATIOS,
    Resolution,
    Surroundings,
    resolution,
    surroundings_of,
)

SEED = 20231115
"""Of all draws; each diameter, noise and ratio has its own stream."""
READ_NOISE = 5.0
"""Standard deviation of a dark sample, in photons, where there is read noise."""
PLACES = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
"""Diameters whose resolution is looked for, as fractions of the sweep."""
_READ_NOISES = {"": 0.0, "read_noise_": READ_NOISE}
"""By the prefix of the variables."""


class _Draw(NamedTuple):
    """Noisy spectra to be drawn."""

    around: Surroundings
    decibels: float
    read_noise: float
    seed: tuple[int, ...]


def at_places(swept: Array) -> Array:
    """Return a swept quantity (D,) where the resolution is looked for, (P,)."""
    found: Array = np.interp(PLACES * (swept.size - 1), np.arange(swept.size), swept)
    return found


def resolution_variables(
    config: Config,
    compared: dict[str, Processing],
    band: Band,
    foci: Array,
    threads: int,
    runs: int,
    points: Points | None,
) -> dict[str, Any]:
    """Return the resolution of each estimator, the bound and the photons, as variables.

    Parameters
    ----------
    config : Config
        The run.
    compared : dict
        Processing of each estimator.
    band : Band
        Of the run.
    foci : ndarray, shape (D,)
        Of the sweep's diameters, µm.
    threads, runs : int
        As of `octsim.studies.estimators.study.estimators`.
    points : Points or None
        Where light that was found before is kept.
    """
    diameters = at_places(config.sweep.diameters.values())
    places = zip(diameters.tolist(), at_places(foci).tolist(), strict=True)
    about = list(each(lambda place: surroundings_of(config, *place, points), places, threads))

    def measured(draw: _Draw) -> Resolution:
        around, decibels, read_noise, seed = draw
        return resolution(around, band, compared, decibels, read_noise, seed, runs)

    variables: dict[str, Any] = {}
    for number, (prefix, read_noise) in enumerate(_READ_NOISES.items()):
        draws = [
            _Draw(around, ratio, read_noise, (SEED, number, p, r))
            for p, around in enumerate(about)
            for r, ratio in enumerate(RATIOS)
        ]
        variables |= _arranged(prefix, list(each(measured, draws, threads)), list(compared))
    return variables


def _arranged(
    prefix: str, resolutions: Sequence[Resolution], compared: Sequence[str]
) -> dict[str, Any]:
    """Return variables of resolutions that are known diameter after diameter, ratio after ratio."""
    shape = len(PLACES), len(RATIOS)
    bound = np.array([one.bound for one in resolutions]).reshape(shape)
    photons = np.array([one.photons for one in resolutions]).reshape(shape)
    of_each = np.array(
        [[one.of_each[estimator] for one in resolutions] for estimator in compared]
    ).reshape(-1, *shape)
    dimensions = ("estimator", "noise_diameter", "snr")
    status = flags_of_missing(of_each, EstimateStatus.NO_ESTIMATE)
    return {
        # over the diameters, as noise of each has as much to say
        f"{prefix}resolution": (("estimator", "snr"), np.sqrt(np.mean(of_each**2, axis=1))),
        f"{prefix}bound": ("snr", np.sqrt(np.mean(bound**2, axis=0))),
        f"{prefix}photons": ("snr", photons.mean(axis=0)),
        f"{prefix}resolution_over_bound": (dimensions, of_each / bound),
        f"{prefix}resolution_status": (dimensions, *status),
    }
