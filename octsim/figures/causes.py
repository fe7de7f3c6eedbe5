"""Why the phase slope scatters, and what makes its spike."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from octsim.figures.marks import mark_missing
from octsim.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    label,
    title,
)

_COLOURS: Mapping[str, str] = {
    "rays": SKY, "step": PURPLE, "centre": VERMILION, "envelope": ORANGE, "paths": BLACK,
    "image": BLUE, "bins": GREEN,
}  # fmt: skip
_DASHES: Mapping[str, Any] = {
    "rays": (0, (1, 2)), "step": (0, (8, 2)), "centre": "-", "envelope": "--", "paths": "-",
    "image": ":", "bins": "-.",
}  # fmt: skip
_LINES = (("s", VERMILION), ("o", ORANGE), ("^", BLUE), ("x", SKY), ("+", BLACK))
_SHOWN = (0, 20, 40, 52, 56, 80)  # of the spectra around the spike


def spike_figure(found: xr.Dataset) -> Figure:
    """Draw spectra around the spike, the level subtracted, what it leaks, and the slope."""
    figure = Figure(figsize=(10.5, 7.2))
    spectra, level, leak, slope = figure.subplots(2, 2).flat
    _spectra(spectra, found)
    place = found["spike_neighbour"]
    own = found["spike_level_error"] / found["spike_amplitude"]
    level.plot(place, 100 * own, color=BLUE)
    level.set_ylabel("Level subtracted less the true one\n(% of the beat's amplitude)")
    leak.plot(place, 1e3 * found["spike_leaked_phase"], color=BLUE)
    leak.set_ylabel("Turn of the component's phase\nby what the level leaks (mrad)")
    slope.plot(
        place, found["spike_phase_slope"], color=BLUE, linestyle="none", marker=".", markersize=4,
        label="as processed",
    )  # fmt: skip
    slope.plot(
        place, found["spike_phase_slope_without_centre"], color=ORANGE, linestyle="--",
        label="the true level subtracted",
    )  # fmt: skip
    slope.set_ylabel(label(found["spike_phase_slope"], "phase slope at a point"))
    slope.legend()
    for axes in (level, leak, slope):
        _edges(axes, found)
        axes.set_xlabel(label(found["diameter"]))
    figure.suptitle(
        title(found, "The spike: converged spectra, shaded where the maximum is an edge")
    )
    return figure


def _spectra(axes: Axes, found: xr.Dataset) -> None:
    """Draw some spectra, one above the other, each with its maximum and its minimum."""
    k = found["wavenumber"]
    largest = float(found["spike_intensity"].max())
    for row, number in enumerate(_SHOWN):
        one = found.isel(spike_neighbour=number)
        height = 0.35 * row
        curve = one["spike_intensity"] / largest + height
        colour = BLUE if row % 2 else BLACK
        axes.plot(k, curve, color=colour, linewidth=1)
        for name, marker in (("spike_maximum", "o"), ("spike_minimum", "v")):
            at = int(np.abs(k.values - float(one[name])).argmin())
            axes.plot(k[at], curve[at], color=VERMILION, marker=marker, markersize=6, clip_on=False)
        axes.annotate(
            f"{float(one['spike_neighbour']):.4f} µm", (float(k[-1]), float(curve[-1])),
            xytext=(4, 0), textcoords="offset points", fontsize=8, color=colour, va="center",
        )  # fmt: skip
    axes.set_xlim(float(k[0]), float(k[-1]) + 0.32)
    axes.set_xlabel(label(k))
    axes.set_ylabel("Intensity (largest = 1), each 0.35 higher")


def _edges(axes: Axes, found: xr.Dataset) -> None:
    """Shade the diameters at which the largest intensity is at an edge of the band."""
    k, place = found["wavenumber"].values, found["spike_neighbour"].values
    at_edge = np.isin(found["spike_maximum"].values, k[[0, -1]])
    axes.fill_between(
        place, 0, 1, where=at_edge, transform=axes.get_xaxis_transform(), color="0.88", zorder=0
    )  # fmt: skip


def causes_figure(found: xr.Dataset) -> Figure:
    """Draw the slope with causes switched off, each cause's part, shares, scatter over the step."""
    figure = Figure(figsize=(10.5, 7.6))
    slope, part, shares, step = figure.subplots(2, 2).flat
    _slopes(slope, found)
    for name, colour in _COLOURS.items():
        if abs(float(found["cause_share"].sel(cause=name))) > 0.01:
            curve = found["cause_phase_slope"].sel(cause=name)
            part.plot(
                found["diameter"], curve, color=colour, linestyle=_DASHES[name], label=name,
                linewidth=1.2,
            )  # fmt: skip
    part.set_xlabel(label(found["diameter"]))
    part.set_ylabel(label(found["cause_phase_slope"], "part of the slope by its cause"))
    part.legend(ncols=2, fontsize=8)
    _shares(shares, found)
    for (marker, colour), name in zip(_LINES, found["series"].values, strict=True):
        step.plot(
            1e3 * found["half_step"], found["step_scatter"].sel(series=name), marker=marker,
            markersize=4, color=colour, label=name, linewidth=1.2,
        )  # fmt: skip
    step.set_xscale("log")
    step.set_ylim(0, 1.5 * step.get_ylim()[1])  # room for the legend
    step.set_xlabel("Step to each side of the difference (nm)")
    step.set_ylabel(label(found["step_scatter"], "scatter of the slope"))
    step.legend(fontsize=8, ncols=2, loc="upper right")
    figure.suptitle(title(found, "What makes the phase slope scatter"))
    return figure


def _slopes(axes: Axes, found: xr.Dataset) -> None:
    place = found["diameter"]
    axes.plot(place, found["phase_slope"], color=BLUE, linewidth=1.2, label="the run")
    axes.plot(
        place, found["phase_slope_without"].sel(cause="centre"), color=VERMILION, linewidth=1,
        linestyle=":", label="the true level subtracted",
    )  # fmt: skip
    beat, error = found["beat_phase_slope"], found["beat_phase_slope_error"]
    axes.fill_between(
        place, beat - error, beat + error, color=BLACK, alpha=0.25, linewidth=0,
        label="± its estimated error",
    )  # fmt: skip
    axes.plot(place, beat, color=BLACK, linestyle="--", label="the beat's own phase")
    mark_missing(axes, place, found["phase_slope"])
    axes.axhline(
        float(found["predicted_phase_slope"]), color=GREEN, linestyle="-.", linewidth=1,
        label="prediction",
    )  # fmt: skip
    axes.set_xlabel(label(place))
    axes.set_ylabel(label(found["phase_slope"], "phase slope"))
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.35 * (high - low))  # room for the legend
    axes.legend(fontsize=8, ncols=2, loc="upper right")


def _shares(axes: Axes, found: xr.Dataset) -> None:
    """Draw the shares of the variance; lines reach from the least to the largest of all orders."""
    names = [*found["cause"].values.tolist(), "trend", "unexplained"]
    rest = float(found["trend_share"]), float(found["unexplained_share"])
    values = 100 * np.array([*found["cause_share"].values, *rest])
    colours = [*(_COLOURS[str(name)] for name in names[:-2]), "0.5", "0.8"]
    row = np.arange(len(names))
    axes.barh(row, values, color=colours, height=0.6)
    least, largest = (100 * found[name].values for name in ("least_share", "largest_share"))
    axes.hlines(row[:-2], least, largest, color="0.25", linewidth=1.2)
    ends = np.maximum(values, [*largest, 0.0, 0.0])
    for y, value, end in zip(row, values, ends, strict=True):
        axes.annotate(
            f"{round(value, 1) + 0.0:.1f} %", (end, y), xytext=(6, 0), va="center",
            textcoords="offset points", fontsize=8,
        )  # fmt: skip
    axes.set_yticks(row, names)
    axes.invert_yaxis()
    axes.margins(x=0.12)
    axes.set_xlabel("Share of the slope's variance (%); line: over all orders")


FIGURES: Mapping[str, Callable[[xr.Dataset], Figure]] = {
    "spike": spike_figure,
    "causes": causes_figure,
}
"""By the names of their files."""
