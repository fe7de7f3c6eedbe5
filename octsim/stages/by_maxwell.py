"""The phase slope by Maxwell's equations at a few diameters of a sweep by rays, to compare."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.maxwell import beyond_maxwell, by_maxwell
from octsim.config.models import Config
from octsim.config.scheme import cost_by, scheme_of
from octsim.instrument.instrument import Instrument
from octsim.phase.local_slopes import local_slope
from octsim.schemes.light import AccuracyStatus
from octsim.schemes.table import FULL_WAVE

Array = NDArray[np.float64]
ACCURACY = 1e-3
"""Of the spectra: largest error of the intensity over the largest intensity."""
DIAMETERS = 5
"""How many diameters of a sweep are compared."""
MOST_SECONDS = 10.0
"""Processor time, by the table of costs, above which a run does not wait for it."""


class ExactStatus(IntEnum):
    """Whether the slope is compared with Maxwell's equations."""

    COMPARED = 0
    BY_MAXWELL = 1
    """The run's own light is by them."""
    BEYOND_SCHEME = 2
    """The scheme fullwave can't do the scene or the objective."""
    NO_FOCUS = 3
    """There is no focus law."""
    TOO_LONG = 4
    """The diameters are so large that a run would wait."""
    OTHER_ESTIMATOR = 5
    """Maximum likelihood, which compares with a model by light paths."""
    OTHER_COMBINATION = 6
    """Not the first combination of a grid."""
    NOT_REACHED = 7
    """The accuracy was not reached at some of the diameters."""


class ExactSlopeStatus(IntEnum):
    """Whether there is a slope by Maxwell's equations at a diameter."""

    COMPARED = 0
    OTHER_DIAMETER = 1
    """Not one of the few that are compared."""
    NOT_COMPARED = 2
    """None is; `ExactStatus` says why."""
    NOT_REACHED = 3
    """The accuracy was not reached, there or beside."""
    NO_FRINGE = 4
    """Their spectrum has no phase, there or beside."""


class ExactSlopes(NamedTuple):
    """Slopes of a sweep by Maxwell's equations."""

    slope: Array
    """(D,), mrad/nm; NaN but at `DIAMETERS` of them."""
    status: ExactStatus
    of_each: NDArray[np.int64]
    """`ExactSlopeStatus` of each, (D,)."""


def not_compared(count: int, status: ExactStatus) -> ExactSlopes:
    """Return the slopes of a number of diameters none of which is compared."""
    none = np.full(count, ExactSlopeStatus.NOT_COMPARED)
    return ExactSlopes(np.full(count, np.nan), status, none)


def compared(count: int) -> list[int]:
    """Return places of diameters that are compared, of a number in a sweep: none at its ends."""
    if count < 3:
        return []
    return sorted(set(np.linspace(1, count - 2, DIAMETERS).round().astype(int).tolist()))


def exact_slopes(config: Config, foci: Array) -> ExactSlopes:
    """Solve Maxwell's equations at a few diameters of a plain config's sweep and their neighbours.

    Parameters
    ----------
    config : Config
        A plain one.
    foci : ndarray, shape (D,)
        Focus of each diameter, µm; NaN without a law.
    """
    diameters = config.sweep.diameters.values()
    slope, status = np.full(diameters.size, np.nan), _before(config, foci)
    places = compared(diameters.size)
    if status != ExactStatus.COMPARED:
        return not_compared(diameters.size, status)
    of_each = np.full(diameters.size, ExactSlopeStatus.OTHER_DIAMETER)
    exact = by_maxwell(config, ACCURACY)
    instrument = Instrument(exact)
    for place in places:
        near = slice(place - 1, place + 2)
        spectra = [
            instrument.spectrum(diameter, focus)
            for diameter, focus in zip(diameters[near].tolist(), foci[near].tolist(), strict=True)
        ]
        if any(found.status != AccuracyStatus.REACHED for found in spectra):
            status, of_each[place] = (ExactStatus.NOT_REACHED, ExactSlopeStatus.NOT_REACHED)
            continue
        slope[place] = local_slope(
            np.stack([found.intensity for found in spectra]), instrument.wavenumber,
            diameters[near], exact.swept_group_index, config.processing,
            instrument.power,
        )  # fmt: skip
        known = np.isfinite(slope[place])
        of_each[place] = ExactSlopeStatus.COMPARED if known else ExactSlopeStatus.NO_FRINGE
    return ExactSlopes(slope, status, of_each)


def _before(config: Config, foci: Array) -> ExactStatus:
    """Return why nothing is to be solved, if so."""
    if scheme_of(config).light == "waves":
        return ExactStatus.BY_MAXWELL
    if beyond_maxwell(config):
        return ExactStatus.BEYOND_SCHEME
    if config.processing.estimator == "maximum_likelihood":
        return ExactStatus.OTHER_ESTIMATOR
    if not np.isfinite(foci).all():
        return ExactStatus.NO_FOCUS
    point = cost_by(FULL_WAVE, {"accuracy": ACCURACY}, config, config.sweep.diameters.stop)
    if 3 * DIAMETERS * point.seconds > MOST_SECONDS:
        return ExactStatus.TOO_LONG
    return ExactStatus.COMPARED
