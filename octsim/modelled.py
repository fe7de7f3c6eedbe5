"""Modelled spectra that maximum likelihood compares measured ones with."""

import numpy as np

from octsim.config import Config
from octsim.estimators.estimate import Array
from octsim.estimators.likelihood import Model
from octsim.settings import by_accuracy
from octsim.simulation import summer, tracer
from octsim.threads import each

MODEL_ACCURACY = 1e-6
"""Of the spectra that maximum likelihood compares with."""


def modelled(config: Config, diameters: Array, foci: Array, threads: int = 1) -> Model:
    """Trace the spectra of a config's scene by light paths, for diameters and foci (M,) in µm."""
    exact = by_accuracy(config, MODEL_ACCURACY)
    trace_at, sum_light = tracer(exact), summer(exact)
    points = zip(diameters.tolist(), foci.tolist(), strict=True)
    spectra = each(lambda point: sum_light(trace_at(*point))[0], points, threads)
    return Model(diameters, np.stack(spectra))
