"""Figures 10 to 12: magnitude, phase and phase slope of the components over the diameter."""

import json

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from octsim.figures.style import BLACK, GREEN, component_colour, label, title

_MARKERS = ".x+1234"


def _draw_components(
    axes: Axes, diameter: NDArray[np.float64], strongest: NDArray[np.int64], values: xr.DataArray
) -> None:
    """Draw each component in use: solid where it is the strongest, dotted elsewhere."""
    for number in np.unique(strongest).tolist():
        colour, curve = component_colour(number), values.isel(component=number).values
        axes.plot(diameter, curve, color=colour, linestyle=":", linewidth=1.0)
        axes.plot(
            diameter, np.where(strongest == number, curve, np.nan),
            color=colour, marker=_MARKERS[(number - 1) % len(_MARKERS)], markersize=3,
            label=f"component {number}",
        )  # fmt: skip


def _unwrapped(phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unwrap phases (D, C) over the diameter, across those that are not known."""
    found = np.full_like(phase, np.nan)
    for values, column in zip(phase.T, found.T, strict=True):
        known = np.isfinite(values)
        column[known] = np.unwrap(values[known])
    return found


def figure_10(fourier: xr.Dataset, slopes: xr.Dataset) -> Figure:
    """Draw the magnitude of the components over the diameter (thesis fig. 10)."""
    figure = Figure()
    axes = figure.subplots()
    diameter = fourier["diameter"]
    strongest = slopes["strongest_component"].values
    _draw_components(axes, diameter.values, strongest, fourier["magnitude"])
    axes.set_xlabel(label(diameter))
    axes.set_ylabel(label(fourier["magnitude"], "magnitude (sum over the samples)"))
    axes.set_title(title(slopes, "Magnitude (solid where strongest)"))
    axes.legend()
    return figure


def figure_11(fourier: xr.Dataset, slopes: xr.Dataset) -> Figure:
    """Draw the unwrapped phase of the components over the diameter (thesis fig. 11)."""
    figure = Figure()
    axes = figure.subplots()
    diameter = fourier["diameter"]
    unwrapped = fourier["phase"].copy(data=_unwrapped(fourier["phase"].values))
    _draw_components(axes, diameter.values, slopes["strongest_component"].values, unwrapped)
    axes.set_xlabel(label(diameter))
    axes.set_ylabel(label(fourier["phase"], "phase, unwrapped"))
    axes.set_title(title(slopes, "Phase (solid where strongest)"))
    axes.legend()
    return figure


def figure_12(slopes: xr.Dataset) -> Figure:
    """Draw the phase slope by component, the ideal curve and the prediction (thesis fig. 12)."""
    figure = Figure()
    axes = figure.subplots()
    diameter = slopes["diameter"]
    _draw_components(
        axes, diameter.values, slopes["strongest_component"].values, slopes["component_phase_slope"]
    )
    estimator = json.loads(slopes.attrs["config"])["processing"]["estimator"]
    if estimator != "fft":
        name = estimator.replace("_", " ")
        axes.plot(diameter, slopes["phase_slope"], color=BLACK, linewidth=2, label=f"by {name}")
    axes.plot(
        diameter, slopes["ideal_phase_slope"],
        color=GREEN, linestyle="--", label="ideal spectrum cos(2ndk)",
    )  # fmt: skip
    predicted = float(slopes["predicted_phase_slope"])
    axes.axhline(
        predicted, color=BLACK, linestyle="-.", label=f"prediction {predicted:.2f} mrad/nm"
    )
    shown = np.concatenate((slopes["phase_slope"].values, slopes["ideal_phase_slope"].values))
    margin = 0.15 * max(float(np.ptp(shown)), 0.1)
    axes.set_ylim(shown.min() - margin, shown.max() + 3 * margin)
    axes.set_xlabel(label(diameter))
    axes.set_ylabel(label(slopes["phase_slope"], "phase slope"))
    axes.set_title(title(slopes, "Phase slope (solid where strongest)"))
    axes.legend(ncols=2)
    return figure
