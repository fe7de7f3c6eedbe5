"""Figure 12 of two runs: the phase slope over the diameter, one over the other."""

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from octsim.figures.marks import mark_points
from octsim.figures.style import BLUE, ORANGE, label

# apart in lightness too, and by their markers
_COLOURS, _MARKERS = (BLUE, ORANGE), "os"
_MARKS = 12  # along a curve
# each leaves room for the other's, so that curves that fall together are both seen
_IDEALS = (0, (5, 5)), (5, (5, 5))
_PREDICTIONS = (0, (5, 2, 1, 8)), (8, (5, 2, 1, 8))
_Entry = tuple[Artist, str]
_MOST_LETTERS = 36  # of a name in the legend


def figure_compare(slopes: tuple[xr.Dataset, xr.Dataset], names: tuple[str, str]) -> Figure:
    """Draw two runs' phase slopes with their ideal curves and predictions.

    Parameters
    ----------
    slopes : tuple of Dataset
        Of the stage phase_slope, without a grid.
    names : tuple of str
        What the legend calls the runs.
    """
    figure = Figure(figsize=(6.4, 4.8))
    axes = figure.subplots()
    shown = []
    for number, (one, name) in enumerate(zip(slopes, names, strict=True)):
        colour, marker = _COLOURS[number], _MARKERS[number]
        diameter, slope, ideal = one["diameter"], one["phase_slope"], one["ideal_phase_slope"]
        predicted = float(one["predicted_phase_slope"])
        every = max(1, diameter.size // _MARKS)
        axes.plot(
            diameter, slope, color=colour, marker=marker, markevery=every, markersize=4,
            label=_shortened(name),
        )  # fmt: skip
        axes.plot(diameter, ideal, color=colour, linestyle=_IDEALS[number], label="ideal cos(2ndk)")
        axes.axhline(
            predicted, color=colour, linestyle=_PREDICTIONS[number],
            label=f"prediction {predicted:.2f} mrad/nm",
        )  # fmt: skip
        shown += [slope.values, ideal.values]
    values = np.concatenate(shown)
    finite = values[np.isfinite(values)]
    if finite.size:
        margin = 0.1 * max(float(np.ptp(finite)), 0.1)
        axes.set_ylim(finite.min() - margin, finite.max() + margin)
    axes.set_xlabel(label(slopes[0]["diameter"]))
    axes.set_ylabel(label(slopes[0]["phase_slope"], "phase slope"))
    axes.set_title("Phase slope of two runs")
    handles, labels = axes.get_legend_handles_labels()
    for one in slopes:
        mark_points(axes, one["diameter"], one["phase_slope"], one.get("fringe_status"))
    both = axes.get_legend_handles_labels()
    marks = list(zip(*(entries[len(labels) :] for entries in both), strict=True))
    columns = _columns(list(zip(handles, labels, strict=True)), marks)
    figure.legend(*zip(*columns, strict=True), loc="outside lower center", ncols=2, handlelength=3)
    return figure


def _columns(curves: list[_Entry], marks: list[_Entry]) -> list[_Entry]:
    """Return a legend's entries column by column: each run's curves, and marks below both."""
    half = len(curves) // 2
    blank: list[_Entry] = [(Line2D([], [], linestyle="none"), "")] * (len(marks) % 2)
    return [*curves[:half], *marks[::2], *curves[half:], *marks[1::2], *blank]


def _shortened(name: str) -> str:
    """Return the end of a name, which tells more of a path than its beginning."""
    return name if len(name) <= _MOST_LETTERS else "…" + name[1 - _MOST_LETTERS :]
