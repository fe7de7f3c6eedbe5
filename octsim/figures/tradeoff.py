"""What accuracy costs: error over cost, the efficient frontier, the presets and the run itself."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from octsim.figures.marks import mark_doubtful
from octsim.figures.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, VERMILION, label, title
from octsim.schemes.table import COUNTED_RAYS, FULL_WAVE, LIGHT_PATHS
from octsim.studies.tradeoff.settings import OF_WAVES

_Panels = tuple[tuple[str, str, str, str, str], ...]
_FACTORS: Mapping[str, tuple[str, str, str]] = {
    # key of the config: colour, marker, what the legend says
    "tracing.rays": (ORANGE, "s", f"{COUNTED_RAYS.name}: rays"),
    "tracing.min_amplitude": (PURPLE, "v", f"{COUNTED_RAYS.name}: min_amplitude"),
    "tracing.accuracy": (BLUE, "o", f"{LIGHT_PATHS.name}: accuracy"),
    OF_WAVES: (VERMILION, "*", f"{FULL_WAVE.name}: accuracy"),
    "tracing.max_intersections": (GREEN, "^", f"{LIGHT_PATHS.name}: max_intersections"),
    "run": (BLACK, "D", "the run's own"),
}
_LIMITS: _Panels = (
    # cost, error, efficient, axis labels
    (
        "segments_per_diameter", "worst_intensity_error", "frontier",
        "segments traced a diameter", "error of I(k) over its maximum, worst",
    ),
    (
        "cpu_seconds", "phase_slope_rms_error", "phase_slope_frontier",
        "processor time of the sweep, one thread", "error of the phase slope, rms",
    ),
)  # fmt: skip
_TRUTH: _Panels = (
    (
        "cpu_seconds", "maxwell_spectrum_worst_error", "maxwell_frontier",
        "processor time of the sweep", "error of the spectrum's shape, worst",
    ),
    (
        "cpu_seconds", "maxwell_slope_rms_error", "maxwell_slope_frontier",
        "processor time of the sweep", "error of the phase slope, rms",
    ),
)  # fmt: skip


def tradeoff_figure(measured: xr.Dataset) -> Figure:
    """Draw the error of the intensity over segments, and that of the phase slope over time.

    Each is that from the limit of the setting's own scheme; of waves no segments are traced.
    """
    figure, panels = _panels(measured, _LIMITS)
    _law(panels[0], measured)
    return _finished(figure, title(measured, "What accuracy costs"))


def truth_figure(measured: xr.Dataset) -> Figure:
    """Draw the errors from Maxwell's equations over time: of the spectrum, and of the slope."""
    figure, _ = _panels(measured, _TRUTH)
    said = f"Errors from Maxwell's equations\n{measured.attrs['maxwell']}"
    return _finished(figure, title(measured, said))


_LEVEL = 0.3  # decades


def _panels(measured: xr.Dataset, panels: _Panels) -> tuple[Figure, Sequence[Axes]]:
    """Draw errors over costs, side by side."""
    figure = Figure(figsize=(10.5, 5.2))
    drawn = list(figure.subplots(1, 2))
    for axes, (cost, error, efficient, *names) in zip(drawn, panels, strict=True):
        _draw(axes, measured, cost, error)
        _mark(axes, measured, cost, error)
        _frontier(axes, measured, cost, error, efficient)
        _name(axes, measured, cost, error)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel(label(measured[cost], names[0]))
        axes.set_ylabel(label(measured[error], names[1]))
        axes.margins(0.09)
    return figure, drawn


def _finished(figure: Figure, heading: str) -> Figure:
    """Give a figure its title, and one legend of what any of its panels shows."""
    figure.suptitle(heading, fontsize=11)
    shown: dict[str, Artist] = {}
    for axes in figure.axes:
        shown |= {
            text: handle for handle, text in zip(*axes.get_legend_handles_labels(), strict=True)
        }
    figure.legend(
        list(shown.values()), list(shown), loc="outside lower center", ncols=4, fontsize=8
    )
    return figure


def _draw(axes: Axes, measured: xr.Dataset, cost: str, error: str) -> None:
    """Draw the points of each factor; those of part of the sweep are hollow."""
    whole = measured["diameters_traced"] == measured["diameters_traced"].where(
        measured["default"] == 1
    ).max()  # fmt: skip
    for factor, (colour, marker, text) in _FACTORS.items():
        of_factor = (measured["factor"] == factor) & (measured[error] > 0)
        for part, face in ((whole, colour), (~whole, "white")):
            # of waves there are no segments, and no place over them
            shown = measured.isel(setting=of_factor & part & measured[cost].notnull())
            if shown.sizes["setting"]:
                axes.plot(
                    shown[cost], shown[error], linestyle="none", marker=marker, markersize=5,
                    color=colour, markerfacecolor=face,
                    label=text if part is whole else f"{text}, some diameters", zorder=3,
                )  # fmt: skip


def _mark(axes: Axes, measured: xr.Dataset, cost: str, error: str) -> None:
    """Mark the settings that say themselves that they are not as accurate as was asked."""
    late = measured.isel(setting=(measured["unreached"] > 0) & (measured[error] > 0))
    why = "accuracy not reached at some diameters"
    mark_doubtful(axes, late[cost], late[error], why)


def _frontier(axes: Axes, measured: xr.Dataset, cost: str, error: str, efficient: str) -> None:
    """Draw the line through the points that no other one beats."""
    best = measured.isel(setting=measured[efficient] == 1).sortby(cost)
    axes.plot(
        best[cost], best[error], color="0.35", linewidth=1.2, drawstyle="steps-post",
        label="efficient frontier", zorder=2,
    )  # fmt: skip


def _law(axes: Axes, measured: xr.Dataset) -> None:
    """Draw the power law of counted rays."""
    segments = measured["segments_per_diameter"].where(measured["factor"] == "tracing.rays")
    ends = np.array([float(segments.min()), float(segments.max())])
    exponent = float(measured["rays_law_exponent"])
    if np.isfinite(exponent):
        axes.plot(
            ends, float(measured["rays_law_factor"]) * ends**exponent, color=ORANGE,
            linewidth=1, linestyle="--", zorder=1,
            label=f"power law, error ∝ segments$^{{{exponent:.2f}}}$",
        )  # fmt: skip


def _name(axes: Axes, measured: xr.Dataset, cost: str, error: str) -> None:
    """Ring and name the presets and the run's own setting."""
    named: list[float] = []
    for number in range(measured.sizes["setting"]):
        one = measured.isel(setting=number)
        own, preset = bool(one["default"] == 1), str(one["preset"].item())
        if not (own or preset) or not (float(one[error]) > 0 and float(one[cost]) > 0):
            continue
        place = float(one[cost]), float(one[error])
        colour = VERMILION if own else BLACK
        axes.plot(
            *place, linestyle="none", marker="o", markersize=11, markerfacecolor="none",
            color=colour, zorder=4,
        )  # fmt: skip
        text = f"{preset}, this run" if own and preset else preset or "this run"
        # presets are on the frontier: what is to their left is empty, or below those that are level
        level = sum(abs(math.log10(place[1] / other)) < _LEVEL for other in named)
        if not own:
            named.append(place[1])
        axes.annotate(
            text, place, xytext=(9, 5) if own else (-9, -9 - 12 * level),
            textcoords="offset points",
            ha="left" if own else "right", fontsize=9, color=colour, fontweight="bold", zorder=5,
        )  # fmt: skip
