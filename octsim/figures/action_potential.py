"""The worked example: what is recovered of an action potential, and what the thesis's way adds."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from octsim.figures.expansion import TIME_UNIT, draw_expansion, standard_error
from octsim.figures.style import BLACK, BLUE, ORANGE, SKY, VERMILION, title

THESIS_OSCILLATION = 0.022
"""Of the thesis's slope, as a fraction: its 0.5 mrad/nm."""


def action_potential_figure(fired: xr.Dataset, table: xr.Dataset) -> Figure:
    """Draw the recovered expansion, its errors, and those of the thesis's way over the diameter."""
    figure = Figure(figsize=(11.5, 4.4))
    trace, errors, diameters = figure.subplots(1, 3)
    draw_expansion(trace, fired)
    trace.plot(
        TIME_UNIT * fired["time"], fired["true_expansion"], color=BLACK, linewidth=1.2,
        linestyle="--", label="true",
    )  # fmt: skip
    trace.legend(fontsize=8)
    _draw_errors(errors, fired)
    _draw_diameters(diameters, table)
    figure.suptitle(title(fired, "A simulated action potential"), fontsize=11)
    return figure


def _draw_errors(axes: Axes, fired: xr.Dataset) -> None:
    """Draw what is recovered less what is true, in pm."""
    time, truth = TIME_UNIT * fired["time"].values, fired["true_expansion"].values
    for error, colour, hatch, text in (
        (THESIS_OSCILLATION * truth, ORANGE, "////", "± oscillation of the thesis's slope"),
        (standard_error(fired), SKY, "", "± stated error"),
    ):
        axes.fill_between(
            time, -1e3 * error, 1e3 * error, facecolor=to_rgba(colour, 0.35), edgecolor=colour,
            linewidth=0, hatch=hatch, label=text,
        )  # fmt: skip
    for name, colour, marker, text in (
        ("fft_expansion", VERMILION, "x", "the thesis's way"),
        ("expansion", BLUE, ".", "recovered"),
    ):
        axes.plot(
            time, 1e3 * (fired[name].values - truth), color=colour, marker=marker, markersize=3,
            linestyle="none", label=text,
        )  # fmt: skip
    axes.set_xlabel("Time (ms)")
    axes.set_ylabel("Error of the change of the diameter (pm)")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.35 * (high - low))  # room for the legend
    axes.legend(fontsize=8)


def _draw_diameters(axes: Axes, table: xr.Dataset) -> None:
    """Draw by how much each way is wrong at each diameter, in per cent of any small expansion."""
    diameter, slope = table["diameter"], table["fixed_focus_phase_slope"]
    predicted = float(table["predicted_phase_slope"])
    error = 100 * np.asarray(table["fixed_focus_phase_slope_standard_error"] / slope)
    axes.fill_between(diameter, -error, error, color=SKY, alpha=0.35, linewidth=0,
                      label="± systematic error stated")  # fmt: skip
    axes.plot(
        diameter, 100 * (table["fft_fixed_focus_phase_slope"] / predicted - 1),
        color=VERMILION, marker="x", markersize=3, label="the thesis's way",
    )  # fmt: skip
    axes.plot(
        diameter, 100 * (table["fft_fixed_focus_phase_slope"] / slope - 1),
        color=ORANGE, linestyle="--", label="fft, calibrated without its oscillation",
    )  # fmt: skip
    axes.axhline(0, color=BLUE, label="calibrated")
    axes.set_xlabel("Diameter at rest (µm)")
    axes.set_ylabel("Error of the expansion (%)")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.3 * (high - low))
    axes.legend(fontsize=8)
