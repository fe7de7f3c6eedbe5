"""From spectra to phases and the phase slope (figures 9 to 12)."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config import Config
from octsim.datasets import make
from octsim.estimation import estimated, ideal_phases
from octsim.plates import ideal_spectra, predicted_phase_slope
from octsim.spectrum import wavenumbers
from octsim.transform import centred as centred
from octsim.transform import fourier_components as fourier_components
from octsim.transform import optical_depths as optical_depths
from octsim.transform import windowed as windowed


class PhaseSlopes(NamedTuple):
    """Phase slopes of a sweep over D diameters with C components, in rad/µm = mrad/nm."""

    component: NDArray[np.int64]
    """Strongest component, (D,); never the constant one, which has no phase."""
    by_component: NDArray[np.float64]
    """Slope of each component, (D, C)."""
    strongest: NDArray[np.float64]
    """Slope of the strongest component, (D,)."""


def phase_slopes(
    diameter: NDArray[np.float64], magnitude: NDArray[np.float64], phase: NDArray[np.float64]
) -> PhaseSlopes:
    """Differentiate phases over the diameter, by central differences of the unwrapped phase.

    Parameters
    ----------
    diameter : ndarray, shape (D,)
        Increasing diameters, µm.
    magnitude, phase : ndarray, shape (D, C)
        Magnitude and phase (rad) of each component.
    """
    component = 1 + magnitude[:, 1:].argmax(axis=1)
    by_component = np.gradient(np.unwrap(phase, axis=0), diameter, axis=0)
    strongest = np.take_along_axis(by_component, component[:, np.newaxis], axis=1)[:, 0]
    return PhaseSlopes(component, by_component, strongest)


def slope_of(diameter: NDArray[np.float64], phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Differentiate phases (D,) over diameters (D,), by central differences once unwrapped."""
    slope: NDArray[np.float64] = np.gradient(np.unwrap(phase), diameter)
    return slope


def estimated_slopes(
    of_components: PhaseSlopes, diameter: NDArray[np.float64], phase: NDArray[np.float64] | None
) -> PhaseSlopes:
    """Put the slope of an estimator's phase (D,), if it has one, in the strongest's place.

    Those of the components stay; fft has no phase but theirs.
    """
    if phase is None:
        return of_components
    return of_components._replace(strongest=slope_of(diameter, phase))


def fourier(config: Config, spectra: xr.Dataset) -> xr.Dataset:
    """Take the Fourier transform of each spectrum.

    Returns
    -------
    Dataset
        magnitude and phase (diameter, component), depth(component); and, of another estimator than
        fft, estimated_phase and estimated_depth (diameter).
    """
    components = fourier_components(spectra["intensity"].values, config.processing)
    dimensions = ("diameter", "component")
    found: dict[str, Any] = {}
    if config.processing.estimator != "fft":
        of_each = estimated(config, spectra)
        found = {
            "estimated_phase": ("diameter", of_each.phase),
            "estimated_depth": ("diameter", of_each.depth),
        }
    return make(
        "fourier",
        config,
        "Fourier transform of the spectrum, for each diameter",
        {
            "magnitude": (dimensions, np.abs(components)),
            "phase": (dimensions, np.angle(components)),
            **found,
        },
        {
            "diameter": spectra["diameter"].values,
            "component": np.arange(components.shape[1]),
            "depth": ("component", optical_depths(spectra["wavenumber"].values)),
        },
        __name__,
    )


def phase_slope(config: Config, transformed: xr.Dataset) -> xr.Dataset:
    """Differentiate the phase over the diameter, and compare with the ideal and the prediction.

    Returns
    -------
    Dataset
        phase_slope, component and ideal_phase_slope (diameter), component_phase_slope(diameter,
        component), predicted_phase_slope, and the thesis's summary figures as scalars.
    """
    diameter, k = transformed["diameter"].values, wavenumbers(config.spectrum)
    n_neuron = config.scene.refractive_index.neuron
    by_fft = config.processing.estimator == "fft"
    slopes = estimated_slopes(
        phase_slopes(diameter, transformed["magnitude"].values, transformed["phase"].values),
        diameter,
        None if by_fft else transformed["estimated_phase"].values,
    )
    spectra = ideal_spectra(n_neuron, diameter, k)
    ideal = fourier_components(spectra, config.processing)
    ideals = estimated_slopes(
        phase_slopes(diameter, np.abs(ideal), np.angle(ideal)),
        diameter,
        None if by_fft else ideal_phases(config, spectra, diameter, k),
    )
    predicted = predicted_phase_slope(n_neuron, k[0], k[-1])
    deviation = slopes.strongest - predicted
    largest = int(np.abs(deviation).argmax())
    return make(
        "phase_slope",
        config,
        "Phase slope: change of the spectrum's phase with the diameter",
        {
            "phase_slope": ("diameter", slopes.strongest),
            "component": ("diameter", slopes.component),
            "component_phase_slope": (("diameter", "component"), slopes.by_component),
            "ideal_phase_slope": ("diameter", ideals.strongest),
            "ideal_component": ("diameter", ideals.component),
            "predicted_phase_slope": predicted,
            "mean_phase_slope": slopes.strongest.mean(),
            "phase_slope_standard_deviation": slopes.strongest.std(),
            "mean_ideal_phase_slope": ideals.strongest.mean(),
            "ideal_phase_slope_standard_deviation": ideals.strongest.std(),
            "standard_deviation_from_ideal": (slopes.strongest - ideals.strongest).std(),
            "largest_deviation": deviation[largest],
            "largest_deviation_diameter": diameter[largest],
        },
        {"diameter": diameter},
        __name__,
    )


def summary(slopes: xr.Dataset) -> str:
    """Say in one line what a run found."""
    value = {str(name): float(slopes[name]) for name in slopes.data_vars if not slopes[name].dims}
    return (
        f"phase slope {value['mean_phase_slope']:.3f} ± "
        f"{value['phase_slope_standard_deviation']:.3f} mrad/nm (mean ± scatter over the "
        f"diameters), prediction {value['predicted_phase_slope']:.3f}; largest deviation from it "
        f"{value['largest_deviation']:+.3f} at {value['largest_deviation_diameter']:.4g} um"
    )
