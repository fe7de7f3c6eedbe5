"""Figures 8 and 9: the spectrum of one diameter on its way to its Fourier transform."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from octsim.config.processing import Processing
from octsim.figures.style import BLUE, GREEN, SKY, component_colour, label, title
from octsim.phase.transform import centred_by, windowed

DIAMETER = 1.4
"""Diameter that the thesis shows, µm; the nearest of the sweep is drawn."""


def figure_8(spectra: xr.Dataset, processing: Processing) -> Figure:
    """Draw the three stages of a spectrum's preparation (thesis fig. 8)."""
    spectrum = spectra.sel(diameter=DIAMETER, method="nearest")
    level = centred_by(spectrum["intensity"].values, processing)
    # the thesis's scale: the centred spectrum reaches from −1 to 1
    level = level / max(float(np.abs(level).max()), np.finfo(float).tiny)
    shaped = windowed(level, processing.window)
    figure = Figure()
    axes = figure.subplots()
    k = spectrum["wavenumber"]
    stages = (
        (level, SKY, "-", f"less its {processing.centre}"),
        (shaped, BLUE, "--", f"× {processing.window}"),
        (shaped - shaped.mean(), GREEN, "-.", "less the mean"),
    )
    for values, colour, line, text in stages:
        axes.plot(k, values, color=colour, linestyle=line, label=text)
    axes.set_xlabel(label(k))
    axes.set_ylabel("Intensity (largest = 1)")
    axes.set_title(title(spectra, f"Spectrum, diameter {float(spectrum['diameter']):.4g} µm"))
    figure.legend(loc="outside lower center", ncols=3)
    return figure


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
    depth.set_xlabel(label(shown["depth"], "optical depth"))
    axes.set_title(title(fourier, f"Fourier transform, diameter {float(shown['diameter']):.4g} µm"))
    axes.legend()
    return figure
