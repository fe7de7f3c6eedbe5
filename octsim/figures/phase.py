"""Figure 12: the phase slope over the diameter."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from octsim.figures.style import BLACK, GREEN, component_colour, label


def figure_12(slopes: xr.Dataset) -> Figure:
    """Draw the phase slope by component, the ideal curve and the prediction (thesis fig. 12)."""
    figure = Figure()
    axes = figure.subplots()
    diameter, component = slopes["diameter"].values, slopes["component"].values
    for number in np.unique(component):
        by_component = slopes["component_phase_slope"].isel(component=number).values
        colour = component_colour(number)
        axes.plot(diameter, by_component, color=colour, linestyle=":", linewidth=1.0)
        strongest = np.where(component == number, by_component, np.nan)
        axes.plot(
            diameter, strongest,
            color=colour, marker=".", markersize=3, label=f"component {number}",
        )  # fmt: skip
    axes.plot(
        diameter, slopes["ideal_phase_slope"],
        color=GREEN, linestyle="--", label="ideal spectrum cos(2ndk)",
    )  # fmt: skip
    predicted = float(slopes["predicted_phase_slope"])
    axes.axhline(predicted, color=BLACK, linestyle="-.", label=f"prediction {predicted:.2f}")
    shown = np.concatenate((slopes["phase_slope"].values, slopes["ideal_phase_slope"].values))
    margin = 0.15 * max(float(np.ptp(shown)), 0.1)
    axes.set_ylim(shown.min() - margin, shown.max() + 3 * margin)
    axes.set_xlabel(label(slopes["diameter"]))
    axes.set_ylabel(label(slopes["phase_slope"], "phase slope"))
    axes.set_title("Phase slope (dotted where another component is stronger)")
    axes.legend(ncols=2)
    return figure
