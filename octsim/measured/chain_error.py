"""How far a change of the phase is off by what the chain does not know exactly."""

import numpy as np
from numpy.typing import NDArray

from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.one_fit import Design, Model, design_of, fitted

Array = NDArray[np.float64]
DRAWS = 16
_MOVED = 0.02
"""Change of the phase that is tried, rad."""
_SEED = 20261129


def reference_error(
    model: Model, design: Design, mean: Array, source_error: Array, read_variance: float
) -> float:
    """Return the relative error of phase changes by the noise of the source's spectrum.

    The mean spectrum, as it was fitted, is moved by a known phase, and read by fits whose source is
    off by draws of its noise.

    Parameters
    ----------
    model, design
        The fit.
    mean : ndarray, shape (K,)
        Counts without the dark.
    source_error : ndarray, shape (K,)
        Standard error of the source's power, over its largest.
    read_variance : float
        As `octsim.phase.estimators.one_fit.design_of` takes it.
    """
    if model.source is None:
        return 0.0
    parameters = design.solver @ mean
    places = slice(design.cosine, design.cosine + 2 * design.step)
    waves, amplitudes = design.columns[:, places], parameters[places]
    still = design.columns @ parameters - waves @ amplitudes
    # cosines and sines of each power, turned by the phase
    cosines, sines = amplitudes.reshape(2, -1)
    turned = np.concatenate(
        [
            cosines * np.cos(_MOVED) + sines * np.sin(_MOVED),
            sines * np.cos(_MOVED) - cosines * np.sin(_MOVED),
        ]
    )
    pair = np.stack([still + waves @ amplitudes, still + waves @ turned])
    true = _moved(design, pair)
    generator, found = np.random.default_rng(_SEED), []
    for _ in range(DRAWS):
        wrong = model.source + source_error * generator.standard_normal(mean.size)
        off = design_of(model._replace(source=wrong), mean, read_variance)
        found.append(_moved(off, pair) / true - 1)
    return float(np.sqrt(np.mean(np.square(found))))


def _moved(design: Design, pair: Array) -> float:
    """Return by how much the phase moves from one of two spectra (2, K) to the other, rad."""
    phase = fitted(design, pair, np.ones(pair.shape[1])).phase
    return float(wrapped(phase[1] - phase[0]))
