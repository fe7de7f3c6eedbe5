"""The estimators that are compared, and a sweep's phase slope by each."""

from collections.abc import Collection, Mapping
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.optics.materials import Material
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.estimators import phases
from octsim.phase.estimators.estimate import Array
from octsim.phase.estimators.likelihood import Model, maximum_likelihood
from octsim.phase.estimators.series import series_phases
from octsim.phase.slopes import phase_slopes, slope_of
from octsim.phase.transform import fourier_components, without_source


class EstimateStatus(IntEnum):
    """Whether an estimator has what is compared."""

    KNOWN = 0
    OF_A_SERIES = 1
    """It is for a series at one diameter only."""
    NO_ESTIMATE = 2
    """It finds no phase in a spectrum that this takes."""


LIKELIHOOD = "maximum_likelihood"
COMMON = "sinusoid_common_envelope"
"""For a series at one diameter only, so not of a sweep."""
THESIS = "fft"
_SHOT = {"weights": "shot"}
_PLAIN = {"offset_degree": 0, "amplitude_degree": 0}

CONTENDERS: Mapping[str, Mapping[str, Any]] = {
    THESIS: {},
    "fft_mean": {"centre": "mean"},
    "fft_weighted": {"centre": "weighted"},
    "fft_polynomial": {"centre": "polynomial"},
    "zero_padded": {"estimator": "zero_padded", "centre": "weighted"},
    "hilbert": {"estimator": "hilbert"},
    "fringe": {"estimator": "fringe"},
    "esprit": {"estimator": "esprit"},
    "sinusoid_plain": {"estimator": "sinusoid", "sinusoid": _PLAIN},
    "sinusoid_equal_weights": {"estimator": "sinusoid"},
    "sinusoid": {"estimator": "sinusoid", "sinusoid": _SHOT},
    "sinusoid_fitted_depth": {"estimator": "sinusoid", "sinusoid": {"depth": "fitted"} | _SHOT},
    COMMON: {"estimator": "sinusoid", "sinusoid": {"envelope": "common"} | _SHOT},
    LIKELIHOOD: {"estimator": "maximum_likelihood"},
}
"""Name of each, and how its processing differs from the thesis's."""


class Band(NamedTuple):
    """What estimators need to know of a scene's spectra."""

    n_neuron: float
    """Group index of the neuron, of optical depths."""
    wavenumber: Array
    """Wavenumbers, (K,), 1/µm."""
    material: Material | None = None
    """What the neuron is of; None is of an index that is the same at all wavenumbers."""
    power: Array | None = None
    """Of the source, (K,); None of a flat one."""

    @property
    def predicted(self) -> float:
        """Predicted phase slope, mrad/nm."""
        neuron = self.material or self.n_neuron
        return predicted_phase_slope(neuron, self.wavenumber[0], self.wavenumber[-1])


def contenders(config: Config) -> dict[str, Processing]:
    """Return the processing of each estimator that is compared, last the run's if it is other."""
    compared = {
        name: Processing.model_validate(differing) for name, differing in CONTENDERS.items()
    }
    if config.processing not in compared.values():
        compared["run"] = config.processing
    return compared


def estimate_status(values: Array, compared: Collection[str]) -> NDArray[np.int64]:
    """Return the `EstimateStatus` of what estimators find of a sweep, (E, ...)."""
    of_series = np.reshape([name == COMMON for name in compared], (-1, *(1,) * (values.ndim - 1)))
    missing = np.where(of_series, EstimateStatus.OF_A_SERIES, EstimateStatus.NO_ESTIMATE)
    return np.where(np.isnan(values), missing, EstimateStatus.KNOWN)


def sweep_phases(
    processing: Processing, band: Band, diameter: Array, intensity: Array, model: Model
) -> Array:
    """Return the phases (D,), rad, of spectra (D, K) at nominal diameters (D,), µm.

    Of maximum likelihood, which has none, the prediction's for the diameter that it finds.
    """
    if processing.estimator == LIKELIHOOD:
        return band.predicted * maximum_likelihood(intensity, model, processing.read_noise)
    depth = band.n_neuron * diameter
    return phases(intensity, band.wavenumber, depth, processing, band.power).phase


def phases_of_series(
    processing: Processing, band: Band, diameter: float, intensity: Array, model: Model
) -> Array:
    """Return the phases (T,), rad, of a series of spectra (T, K) at one nominal diameter, µm."""
    if processing.estimator == LIKELIHOOD:
        return band.predicted * maximum_likelihood(intensity, model, processing.read_noise)
    depth = band.n_neuron * diameter
    return series_phases(intensity, band.wavenumber, depth, processing, band.power)


def sweep_slopes(
    processing: Processing, band: Band, diameter: Array, intensity: Array, model: Model
) -> Array:
    """Return the phase slope (D,), mrad/nm, of a sweep's spectra (D, K).

    Of fft it is that of each spectrum's strongest component, as in the stage phase_slope.
    """
    if processing.estimator == THESIS:
        components = fourier_components(without_source(intensity, band.power), processing)
        return phase_slopes(diameter, np.abs(components), np.angle(components)).strongest
    return slope_of(diameter, sweep_phases(processing, band, diameter, intensity, model))
