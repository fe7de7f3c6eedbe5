"""Modelled spectra that maximum likelihood compares measured ones with."""

import numpy as np

from octsim.config.derive import by_accuracy
from octsim.config.models import Config
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.phase.estimators.estimate import Array
from octsim.phase.estimators.likelihood import Model

MODEL_ACCURACY = 1e-6
"""Of the spectra that maximum likelihood compares with."""
_STEP = 0.007  # µm; a spline over them is off by some 1e-6 of the largest intensity
_MARGIN = 0.1  # µm, that a diameter may seem to be outside the sweep


def modelled(
    config: Config,
    diameters: Array,
    foci: Array,
    threads: int = 1,
    points: Points | None = None,
) -> Model:
    """Return the spectra of a config's scene by light paths, for diameters and foci (M,) in µm.

    They are to `MODEL_ACCURACY`, whatever the config's own. Light that was found before comes from
    `points`.
    """
    instrument = Instrument(by_accuracy(config, MODEL_ACCURACY), points)
    return Model(diameters, instrument.spectra(diameters, foci, threads))


def model_of_sweep(
    config: Config, foci: Array, threads: int = 1, points: Points | None = None
) -> Model:
    """Return a model that reaches beyond a sweep whose foci (D,), µm, are given.

    Its steps are fine enough for a cubic spline, whatever the sweep's; foci go on in a line.
    """
    diameters = config.sweep.diameters.values()
    step = min(diameters[1] - diameters[0], _STEP)
    first = max(diameters[0] - _MARGIN, diameters[0] / 2)
    num = int(np.ceil((diameters[-1] + _MARGIN - first) / step)) + 1
    at = np.linspace(first, diameters[-1] + _MARGIN, num)
    ends = foci[[0, -1]] + [
        (at[0] - diameters[0]) * (foci[1] - foci[0]) / (diameters[1] - diameters[0]),
        (at[-1] - diameters[-1]) * (foci[-1] - foci[-2]) / (diameters[-1] - diameters[-2]),
    ]
    known = np.concatenate([at[:1], diameters, at[-1:]])
    reached = np.interp(at, known, np.array([ends[0], *foci, ends[1]]))
    return modelled(config, at, reached, threads, points)
