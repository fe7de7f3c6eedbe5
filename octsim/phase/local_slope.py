"""The phase slope at one diameter, of spectra there and a step to either side."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.processing import Processing
from octsim.phase.estimators import phases
from octsim.phase.estimators.visible import fringe_at
from octsim.phase.slopes import phase_slopes, slope_of
from octsim.phase.transform import fourier_components

LEAST_SQUARES = Processing.model_validate({"estimator": "sinusoid"})
"""A sinusoid with linear offset and amplitude, its frequency at 2nd of each diameter."""


class LocalSlope(NamedTuple):
    """What three spectra tell of the one in the middle."""

    slope: float
    """Phase slope, mrad/nm."""
    phase: float
    """Phase, rad: of the first sample by fft, at mid-band by others."""
    visibility: float
    """Of the fringe of the diameter; NaN without one."""


def local_slope(
    intensity: NDArray[np.float64],
    diameter: NDArray[np.float64],
    wavenumber: NDArray[np.float64],
    index: float,
    processing: Processing,
) -> LocalSlope:
    """Return the phase slope of spectra (3, K) at the middle one of their diameters.

    Parameters
    ----------
    intensity : ndarray, shape (3, K)
        Spectra at evenly spaced diameters.
    diameter : ndarray, shape (3,)
        µm, increasing.
    wavenumber : ndarray, shape (K,)
        Evenly spaced, 1/µm.
    index : float
        Refractive index of the neuron.
    processing : Processing
        The estimator; maximum likelihood has no phase of its own, and is taken for fft.
    """
    depth = index * diameter
    visibility = float(fringe_at(intensity[1:2], wavenumber, depth[1:2], np.zeros(1)).visibility[0])
    if processing.estimator in ("fft", "maximum_likelihood"):
        found = fourier_components(intensity, processing)
        slopes = phase_slopes(diameter, np.abs(found), np.angle(found))
        phase = float(np.angle(found[1, slopes.component[1]]))
        return LocalSlope(float(slopes.strongest[1]), phase, visibility)
    estimated = phases(intensity, wavenumber, depth, processing).phase
    return LocalSlope(float(slope_of(diameter, estimated)[1]), float(estimated[1]), visibility)
