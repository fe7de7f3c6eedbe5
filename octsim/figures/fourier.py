"""Fourier transforms: of one spectrum, and their components over the diameter (figures 9 to 11)."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from octsim.figures.marks import mark_points
from octsim.figures.phase_slope import draw_components
from octsim.figures.spectra import DIAMETER
from octsim.figures.style import component_colour, label, tell_doubts, title


def figure_9(fourier: xr.Dataset) -> Figure:
    """Draw the Fourier transform of one spectrum, its first two components marked (fig. 9)."""
    shown = fourier.sel(diameter=DIAMETER, method="nearest").isel(component=slice(0, 13))
    figure = Figure()
    axes = figure.subplots()
    component, magnitude = shown["component"], shown["magnitude"]
    axes.plot(component, magnitude, color="0.5", marker=".")
    for number in (1, 2):
        if number < component.size:
            axes.plot(
                number, magnitude.isel(component=number),
                "os"[number - 1], color=component_colour(number), markersize=9,
                label=f"component {number}",
            )  # fmt: skip
    axes.set_xlabel(label(component))
    axes.set_ylabel(label(magnitude, "magnitude (sum over the samples)"))
    step = float(shown["depth"][1])

    def to_depth(number: Any) -> Any:
        return number * step

    def to_component(depth: Any) -> Any:
        return depth / step

    depth = axes.secondary_xaxis("top", functions=(to_depth, to_component))
    axes.yaxis.get_offset_text().set_x(-0.12)  # a power of ten, left of the depths
    depth.set_xlabel(label(shown["depth"], "optical depth"))
    axes.set_title(title(fourier, f"Fourier transform, diameter {float(shown['diameter']):.4g} µm"))
    axes.legend()
    tell_doubts(figure, fourier)
    return figure


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
    drawn = draw_components(
        axes, diameter.values, slopes["strongest_component"].values, fourier["magnitude"]
    )
    mark_points(axes, diameter, drawn, slopes.get("fringe_status"))
    axes.set_xlabel(label(diameter))
    axes.set_ylabel(label(fourier["magnitude"], "magnitude (sum over the samples)"))
    axes.set_title(title(slopes, "Magnitude (solid where strongest)"))
    axes.legend()
    tell_doubts(figure, slopes)
    return figure


def figure_11(fourier: xr.Dataset, slopes: xr.Dataset) -> Figure:
    """Draw the unwrapped phase of the components over the diameter (thesis fig. 11)."""
    figure = Figure()
    axes = figure.subplots()
    diameter = fourier["diameter"]
    unwrapped = fourier["phase"].copy(data=_unwrapped(fourier["phase"].values))
    drawn = draw_components(axes, diameter.values, slopes["strongest_component"].values, unwrapped)
    mark_points(axes, diameter, drawn, slopes.get("fringe_status"))
    axes.set_xlabel(label(diameter))
    axes.set_ylabel(label(fourier["phase"], "phase, unwrapped"))
    axes.set_title(title(slopes, "Phase (solid where strongest)"))
    axes.legend()
    tell_doubts(figure, slopes)
    return figure
