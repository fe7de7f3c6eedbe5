"""From spectra to phases and the phase slope (figures 9 to 12)."""

from collections.abc import Iterator
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.reader import Stored
from octsim.datasets.stage import Part, Stage, Stream
from octsim.optics.band import wavenumbers
from octsim.optics.two_beams import ideal_spectra, predicted_phase_slope
from octsim.phase.by_config import estimator_of, ideal_phases
from octsim.phase.derivatives import wrapped
from octsim.phase.transform import centred as centred
from octsim.phase.transform import fourier_components as fourier_components
from octsim.phase.transform import optical_depths as optical_depths
from octsim.phase.transform import rounding_level
from octsim.phase.transform import windowed as windowed
from octsim.stages.cost_estimate import points_per_block

_DEGREE = 4


class PhaseStatus(IntEnum):
    """Whether a component has a phase."""

    KNOWN = 0
    BELOW_ROUNDING = 1
    """It holds nothing but rounding, as the constant one, whose mean is subtracted."""
    NO_SPECTRUM = 2
    """The spectrum is NaN, as there is no focus."""


class PhaseSlopes(NamedTuple):
    """Phase slopes of a sweep over D diameters with C components, in rad/µm = mrad/nm."""

    component: NDArray[np.int64]
    """Strongest component, (D,); never the constant one, which has no phase."""
    by_component: NDArray[np.float64]
    """Slope of each component, (D, C)."""
    strongest: NDArray[np.float64]
    """Slope of the strongest component, (D,)."""


def turns(phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give by how much phases (D, ...) turn from one to the next, (D − 1, ...), in [−π, π].

    This is the step of the unwrapped phase, but as it adds nothing up it does not depend on where a
    sweep begins.
    """
    return wrapped(np.diff(phase, axis=0))


def gradient(step: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Differentiate by central differences, one-sided at both ends, as `numpy.gradient` does.

    Parameters
    ----------
    step : ndarray, shape (N − 1, ...)
        Steps of the function from each place to the next.
    x : ndarray, shape (N,)
        The places, increasing.
    """
    width = np.diff(x).reshape(-1, *(1,) * (step.ndim - 1))
    slope = step / width
    left, right = width[:-1], width[1:]
    inner = (right * slope[:-1] + left * slope[1:]) / (left + right)
    return np.concatenate((slope[:1], inner, slope[-1:]))


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
    by_component = gradient(turns(phase), diameter)
    strongest = np.take_along_axis(by_component, component[:, np.newaxis], axis=1)[:, 0]
    return PhaseSlopes(component, by_component, strongest)


def slope_of(diameter: NDArray[np.float64], phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Differentiate phases (D,) over diameters (D,), µm, by central differences."""
    return gradient(turns(phase), diameter)


def trend(diameter: NDArray[np.float64], slope: NDArray[np.float64]) -> NDArray[np.float64]:
    """Fit a polynomial of the fourth degree over the diameter to slopes by least squares, (D,)."""
    degree = min(_DEGREE, slope.size - 1)
    fitted: NDArray[np.float64] = Polynomial.fit(diameter, slope, degree)(diameter)
    return fitted


@Stage
def fourier(config: Config, spectra: xr.Dataset) -> Stream:
    """Take the Fourier transform of each spectrum.

    Returns
    -------
    Dataset
        magnitude, phase and whether that is known (diameter, component), depth(component); and, of
        another estimator than fft, estimated_phase and estimated_depth (diameter).
    """

    def own(config: Config) -> dict[str, Coordinate]:
        depths = optical_depths(wavenumbers(config.spectrum))
        return {
            "diameter": ("diameter", config.sweep.diameters.values()),
            "component": ("component", np.arange(depths.size)),
            "depth": ("component", depths),
        }

    title = "Fourier transform of the spectrum, for each diameter"
    layout = Layout("fourier", config, title, __name__, own, "diameter")
    return Stream(layout, _transformed(layout, Stored(spectra, "spectra", config, layout)))


def _by_components(config: Config) -> bool:
    """Tell whether the phase is that of the components themselves."""
    return config.processing.estimator == "fft"


def _block_points(config: Config) -> int:
    return points_per_block(40 * config.spectrum.samples)


def _transformed(layout: Layout, stored: Stored) -> Iterator[Part]:
    dimensions = ("diameter", "component")
    estimates = any(not _by_components(at.config) for at in layout.combinations)
    for at, span in layout.blocks(_block_points):
        part = stored.part(at, span)
        intensity = part["intensity"].values
        components = fourier_components(intensity, at.config.processing)
        magnitude = np.abs(components)
        status = _status(magnitude, rounding_level(intensity, at.config.processing))
        phase = np.where(status == PhaseStatus.KNOWN, np.angle(components), np.nan)
        variables: dict[str, Any] = {
            "magnitude": (dimensions, magnitude),
            "phase": (dimensions, phase),
            "phase_status": (dimensions, *flags(PhaseStatus, status)),
        }
        if estimates:
            if span.start == 0:
                foci = stored.part(at, names=("focus",))["focus"].values
                estimate = estimator_of(at.config, foci)
            found = estimate(intensity, part["diameter"].values)
            variables["estimated_phase"] = "diameter", found.phase
            variables["estimated_depth"] = "diameter", found.depth
        yield Part(at, span.start, len(intensity), variables)


def _status(magnitude: NDArray[np.float64], level: NDArray[np.float64]) -> NDArray[np.int64]:
    """Tell which components (D, C) are above the rounding (D, 1) of their spectra."""
    missing = np.where(np.isnan(magnitude), PhaseStatus.NO_SPECTRUM, PhaseStatus.BELOW_ROUNDING)
    return np.where(magnitude > level, PhaseStatus.KNOWN, missing)


@Stage
def phase_slope(config: Config, transformed: xr.Dataset) -> Stream:
    """Differentiate the phase over the diameter, and compare with the ideal and the prediction.

    Returns
    -------
    Dataset
        phase_slope, component and ideal_phase_slope (diameter), component_phase_slope(diameter,
        component), predicted_phase_slope, and the thesis's summary figures as scalars.
    """

    def own(config: Config) -> dict[str, Coordinate]:
        return {"diameter": ("diameter", config.sweep.diameters.values())}

    title = "Phase slope: change of the spectrum's phase with the diameter"
    layout = Layout("phase_slope", config, title, __name__, own, "diameter", _component_count)
    return Stream(layout, _differentiated(layout, Stored(transformed, "fourier", config, layout)))


def _component_count(config: Config) -> dict[str, int]:
    return {"component": config.spectrum.samples // 2 + 1}


def _differentiated(layout: Layout, stored: Stored) -> Iterator[Part]:
    slopes: dict[str, list[NDArray[np.float64]]] = {"phase_slope": [], "ideal_phase_slope": []}
    for at, span in layout.blocks(_block_points):
        count = layout.count(at)
        # a central difference looks at both neighbours
        wide = slice(max(span.start - 1, 0), min(span.stop + 1, count))
        variables = _slopes(at.config, stored.part(at, wide), span.start - wide.start, span)
        for name, values in slopes.items():
            values.append(variables[name][1])
        if span.stop == count:
            joined = {name: np.concatenate(values) for name, values in slopes.items()}
            variables |= _figures(at.config, layout.own[at.position]["diameter"][1], **joined)
            slopes = {name: [] for name in slopes}
        yield Part(at, span.start, span.stop - span.start, variables)


def _slopes(config: Config, part: xr.Dataset, before: int, span: slice) -> dict[str, Any]:
    """Give the slopes of some diameters of a part that holds their neighbours too."""
    inner = slice(before, before + span.stop - span.start)
    diameter, k = part["diameter"].values, wavenumbers(config.spectrum)
    found = phase_slopes(diameter, part["magnitude"].values, part["phase"].values)
    n_neuron = config.scene.refractive_index.neuron
    spectra = ideal_spectra(n_neuron, diameter, k)
    ideal = fourier_components(spectra, config.processing)
    ideals = phase_slopes(diameter, np.abs(ideal), np.angle(ideal))
    slope, ideal_slope = found.strongest, ideals.strongest
    if not _by_components(config):
        slope = slope_of(diameter, part["estimated_phase"].values)
        ideal_slope = slope_of(diameter, ideal_phases(config, spectra, diameter, k))
    return {
        "phase_slope": ("diameter", slope[inner]),
        "component": ("diameter", found.component[inner]),
        "component_phase_slope": (("diameter", "component"), found.by_component[inner]),
        "ideal_phase_slope": ("diameter", ideal_slope[inner]),
        "ideal_component": ("diameter", ideals.component[inner]),
    }


def _figures(
    config: Config,
    diameter: NDArray[np.float64],
    phase_slope: NDArray[np.float64],
    ideal_phase_slope: NDArray[np.float64],
) -> dict[str, Any]:
    """Give the thesis's summary figures of a sweep."""
    k = wavenumbers(config.spectrum)
    predicted = predicted_phase_slope(config.scene.refractive_index.neuron, k[0], k[-1])
    deviation = phase_slope - predicted
    largest = int(np.abs(deviation).argmax())
    return {
        "predicted_phase_slope": predicted,
        "mean_phase_slope": phase_slope.mean(),
        "phase_slope_standard_deviation": phase_slope.std(),
        "mean_ideal_phase_slope": ideal_phase_slope.mean(),
        "ideal_phase_slope_standard_deviation": ideal_phase_slope.std(),
        "standard_deviation_from_ideal": (phase_slope - ideal_phase_slope).std(),
        "largest_deviation": deviation[largest],
        "largest_deviation_diameter": diameter[largest],
    }


def summary(slopes: xr.Dataset) -> str:
    """Say in one line what a run found."""
    means = slopes["mean_phase_slope"].values
    if means.ndim:
        return (
            f"mean phase slope over the diameters {np.nanmin(means):.3f} to "
            f"{np.nanmax(means):.3f} mrad/nm over {means.size} combinations"
        )
    figures = (
        "mean_phase_slope", "phase_slope_standard_deviation", "predicted_phase_slope",
        "largest_deviation", "largest_deviation_diameter",
    )  # fmt: skip
    mean, scatter, predicted, deviation, diameter = (float(slopes[name]) for name in figures)
    return (
        f"phase slope {mean:.3f} ± {scatter:.3f} mrad/nm (mean ± scatter over the diameters), "
        f"prediction {predicted:.3f}; largest deviation from it {deviation:+.3f} at "
        f"{diameter:.4g} um"
    )
