"""The estimators by their names."""

from collections.abc import Callable, Mapping

import numpy as np

from octsim.config.processing import Processing
from octsim.phase.estimators.esprit import esprit
from octsim.phase.estimators.estimate import Array, Phases
from octsim.phase.estimators.fft import fft, peak_depths, zero_padded
from octsim.phase.estimators.fringe import fringe
from octsim.phase.estimators.hilbert import hilbert
from octsim.phase.estimators.sinusoid import sinusoid
from octsim.phase.transform import without_source

Estimator = Callable[[Array, Array, Array, Processing], Phases]

ESTIMATORS: Mapping[str, Estimator] = {
    "fft": fft,
    "zero_padded": zero_padded,
    "sinusoid": sinusoid,
    "hilbert": hilbert,
    "esprit": esprit,
    "fringe": fringe,
}
"""Each takes spectra (D, K), wavenumbers (K,), depths (D,) and the processing. The sinusoid's fit
takes the source as well; maximum likelihood needs modelled spectra too:
`octsim.phase.estimators.likelihood`."""


def phases(
    intensity: Array, wavenumber: Array, nominal: Array, processing: Processing,
    source: Array | None = None,
) -> Phases:  # fmt: skip
    """Estimate the phase of spectra as the processing says, without asking how well.

    Parameters
    ----------
    intensity : ndarray, shape (D, K)
        Spectra.
    wavenumber : ndarray, shape (K,)
        Evenly spaced, increasing wavenumbers, 1/µm.
    nominal : ndarray, shape (D,)
        Nominal optical depths n_neuron · diameter, µm, for ``processing.depth: nominal``.
    processing : Processing
        Which estimator, at which depth, with which options.
    source : ndarray, shape (K,), optional
        The source's power, None of a flat one. It shapes the sinusoid's model; the others see
        spectra without the light that does not oscillate, as `without_source` has it.
    """
    # each spectrum's samples beside each other: the order in which numpy sums hangs on that
    intensity = np.ascontiguousarray(intensity)
    depth = expected_depths(intensity, wavenumber, nominal, processing, source)
    if processing.estimator == "sinusoid":
        return sinusoid(intensity, wavenumber, depth, processing, source)
    spectra = without_source(intensity, source)
    return ESTIMATORS[processing.estimator](spectra, wavenumber, depth, processing)


def expected_depths(
    intensity: Array, wavenumber: Array, nominal: Array, processing: Processing,
    source: Array | None = None,
) -> Array:  # fmt: skip
    """Return where the phases of spectra (D, K) are looked for, (D,), µm, as the processing says.

    Parameters are those of `phases`.
    """
    if processing.depth == "peak":
        return peak_depths(without_source(intensity, source), wavenumber, processing)
    if isinstance(processing.depth, float):
        return np.full(intensity.shape[0], processing.depth)
    return nominal
