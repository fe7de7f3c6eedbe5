"""Estimators compared: their slopes, how these scatter, and what noise leaves of the diameter."""

from collections.abc import Mapping
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

_DRAWN: Mapping[str, tuple[str, str, Any]] = {
    # estimator: colour, marker, line
    "fft": (ORANGE, "s", "-"),
    "fringe": (PURPLE, "v", (0, (3, 1, 1, 1))),
    "sinusoid_plain": (SKY, "^", (0, (8, 2))),
    "sinusoid_fitted_depth": (BLUE, "o", "-."),
    "sinusoid_common_envelope": (VERMILION, "D", (0, (5, 1, 1, 1, 1, 1))),
    "maximum_likelihood": (GREEN, "x", ":"),
}


def estimators_figure(compared: xr.Dataset) -> Figure:
    """Draw slopes over the diameter, their scatter, and the resolution over the noise."""
    figure = Figure(figsize=(13.5, 4.8))
    slopes, scatter, noise = figure.subplots(1, 3)
    _slopes(slopes, compared)
    _scatter(scatter, compared)
    _resolution(noise, compared)
    figure.suptitle(title(compared, "Estimators of the phase"), fontsize=11)
    handles, names = noise.get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=4, fontsize=8, handlelength=4)
    return figure


def _slopes(axes: Axes, compared: xr.Dataset) -> None:
    """Draw the slopes by counted rays, and that of the light's own phase."""
    diameter = compared["diameter"]
    for name, (colour, _, line) in _DRAWN.items():
        slope = compared["phase_slope"].sel(estimator=name)
        if np.isfinite(slope).any():
            axes.plot(diameter, slope, color=colour, linestyle=line, linewidth=1.0)
    axes.plot(diameter, compared["path_phase_slope"], color=BLACK, linestyle="--", linewidth=1.0)
    axes.set_xlabel(label(diameter))
    axes.set_ylabel(label(compared["phase_slope"], "phase slope, by counted rays"))


def _scatter(axes: Axes, compared: xr.Dataset) -> None:
    """Draw the scatter about the trend, of counted rays and of converged spectra."""
    shown = compared.isel(estimator=np.isfinite(compared["scatter"]))
    place = np.arange(shown.sizes["estimator"])
    # below this it is rounding: of maximum likelihood on its own model
    least = 1e-3
    for off, name, colour, text in (
        (-0.2, "scatter", ORANGE, "counted rays"),
        (0.2, "converged_scatter", BLUE, "light paths"),
    ):
        axes.barh(place + off, np.maximum(shown[name], least), 0.4, color=colour, label=text)
    names = [str(one).replace("_", " ") for one in shown["estimator"].values]
    axes.set_yticks(place, names, fontsize=7)
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.set_xlim(left=least)
    name = f"{label(compared['scatter'], 'scatter about the trend')}; without a bar it is rounding"
    axes.set_xlabel(name)
    axes.legend(fontsize=8)


def _resolution(axes: Axes, compared: xr.Dataset) -> None:
    """Draw the error of the diameter under shot noise over the ratio, and its bound."""
    picometres = 1e6  # per µm
    for name, (colour, marker, line) in _DRAWN.items():
        error = picometres * compared["resolution"].sel(estimator=name)
        axes.plot(
            compared["snr"], error, color=colour, marker=marker, markersize=5, linestyle=line,
            linewidth=1.0, label=name.replace("_", " "),
        )  # fmt: skip
        mark_missing(axes, compared["snr"], error)
    axes.plot(
        compared["snr"], picometres * compared["bound"], color=BLACK, linestyle="--",
        label="Cramér–Rao bound; left, the light's own phase",
    )  # fmt: skip
    axes.set_yscale("log")
    axes.set_xlabel(label(compared["snr"], "signal-to-noise ratio"))
    axes.set_ylabel("Error of the diameter (pm)")
