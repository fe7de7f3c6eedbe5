"""The calibration: the slope at a fixed focus beside the thesis's, and what makes its error."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from octsim.figures.marks import mark_points
from octsim.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    label,
    tell,
    title,
)
from octsim.studies.calibration.told import doubts

_SLOPES = (
    # variable, colour, line, marker, what the legend says
    ("fft_fixed_focus_phase_slope", SKY, "-", "s", "fft, focus held"),
    ("light_paths_phase_slope", PURPLE, "-", "v", "by rays (light paths), focus held"),
    ("maxwell_phase_slope", GREEN, "-", "o", "by Maxwell's equations, focus held"),
    ("following_phase_slope", ORANGE, "--", "", "focus follows the diameter"),
    ("fft_following_phase_slope", VERMILION, ":", "", "fft, focus follows (the thesis)"),
)
_MARKERS = "osv^D"
_SHOWN = 5  # of the parameters, those that count most


def calibration_figure(table: xr.Dataset) -> Figure:
    """Draw the slopes with their standard error, and the budget of that error."""
    figure = Figure(figsize=(10.5, 4.6))
    slopes, budget = figure.subplots(1, 2)
    _draw_slopes(slopes, table)
    _draw_budget(budget, table)
    tell(figure, doubts(table))
    figure.suptitle(title(table, "Calibration of the phase"), fontsize=11)
    return figure


def _draw_slopes(axes: Axes, table: xr.Dataset) -> None:
    diameter, slope = table["diameter"], table["fixed_focus_phase_slope"]
    error = table["fixed_focus_phase_slope_standard_error"]
    axes.fill_between(
        diameter, slope - error, slope + error, color=BLUE, alpha=0.2, linewidth=0,
        label="its standard error",
    )  # fmt: skip
    axes.plot(diameter, slope, color=BLUE, linewidth=2, label="focus held: the calibration")
    for name, colour, line, marker, text in _SLOPES:
        if table[name].isnull().all() or np.allclose(table[name], slope, rtol=1e-4):
            continue  # not solved, or the calibration itself
        axes.plot(
            diameter, table[name], color=colour, linestyle=line, marker=marker, markersize=4,
            markevery=5, label=text,
        )  # fmt: skip
    for status in ("accuracy_status", "model_status"):
        mark_points(axes, diameter, slope, table.get(status))
    predicted = float(table["predicted_phase_slope"])
    axes.axhline(predicted, color=BLACK, linestyle="-.", label=f"prediction {predicted:.2f}")
    axes.set_xlabel(label(diameter, "diameter at rest"))
    axes.set_ylabel(label(slope, "phase slope"))
    low, high = axes.get_ylim()
    axes.set_ylim(low - 0.5 * (high - low), high)  # room for the legend
    axes.legend(fontsize=8, ncols=2, loc="lower center")


def _draw_budget(axes: Axes, table: xr.Dataset) -> None:
    """Draw what each tolerance makes of the slope's error, relative to the slope."""
    diameter, slope = table["diameter"], table["fixed_focus_phase_slope"]
    total = table["fixed_focus_phase_slope_standard_error"] / np.abs(slope)
    axes.plot(diameter, 100 * total, color=BLACK, linewidth=2, label="all together")
    shares = 100 * table["budget"] / np.abs(slope)
    most = shares.mean("diameter").values.argsort()[::-1][:_SHOWN]
    colours = (BLUE, ORANGE, GREEN, PURPLE, VERMILION)
    for place, colour, marker in zip(most, colours, _MARKERS, strict=True):
        one = shares.isel(parameter=place)
        axes.plot(
            diameter, one, color=colour, marker=marker, markevery=5, markersize=4,
            label=str(one["parameter"].item()).replace("_", " "),
        )  # fmt: skip
    axes.set_yscale("log")
    axes.set_xlabel(label(diameter, "diameter at rest"))
    axes.set_ylabel("Standard error of the phase slope (%)")
    axes.legend(fontsize=8, ncols=2)
