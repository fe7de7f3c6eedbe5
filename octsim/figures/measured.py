"""Measured spectra: their mean beside the source, and the phase of each."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from octsim.figures.envelope import band, extremes
from octsim.figures.expansion import TIME_UNIT
from octsim.figures.marks import mark_points
from octsim.figures.style import BLACK, BLUE, ORANGE, title
from octsim.phase.fringe_status import WITH_PHASE, FringeStatus

_SHOWN = 256
"""Spectra at the start, whose mean is shown."""


def measured_figure(found: xr.Dataset) -> Figure:
    """Draw the mean of the first spectra, and phases over time."""
    figure = Figure(figsize=(11, 4.4))
    spectrum, phases = figure.subplots(1, 2)
    _draw_mean(spectrum, found)
    _draw_phases(phases, found)
    figure.suptitle(title(found, f"{found.sizes['time']} measured spectra"), fontsize=11)
    return figure


def _draw_mean(axes: Axes, found: xr.Dataset) -> None:
    nm = 1e3 * found["wavelength"].values
    first = found["counts"].isel(time=slice(_SHOWN)).mean("time").values
    dark, power = found["dark_level"].values, found["source_power"].values
    axes.plot(nm, first, color=BLUE, linewidth=1, label="mean of the first spectra")
    fitted = np.isfinite(power)
    net = np.where(fitted, first - dark, np.nan)
    # as bright as the mean, by least squares
    scale = np.nansum(net * power) / np.nansum(power**2)
    axes.plot(
        nm,
        dark + scale * power,
        color=ORANGE,
        linestyle="--",
        linewidth=1,
        label="source, as bright",
    )
    full = float(found["full_scale"])
    if np.isfinite(full) and first.max() > 0.5 * full:
        axes.axhline(full, color=BLACK, linestyle=":", linewidth=1, label="full scale")
    axes.set_xlabel("Wavelength (nm)")
    axes.set_ylabel("Counts")
    axes.legend()


def _draw_phases(axes: Axes, found: xr.Dataset) -> None:
    time, phase = TIME_UNIT * found["time"].values, found["fringe_phase"].values.copy()
    status = found["spectrum_status"].values
    known = np.isin(status, WITH_PHASE) & np.isfinite(phase)
    phase[known] = np.unwrap(phase[known])
    full = status == FringeStatus.SATURATED
    mark_points(axes, time, phase, found["spectrum_status"])
    phase[full] = np.nan
    error = found["fringe_phase_error"].values
    axes.fill_between(
        *band(time, phase - error, phase + error), color=BLUE, alpha=0.3, linewidth=0,
        label="± its standard error",
    )  # fmt: skip
    shown = extremes(time, phase)
    axes.plot(
        time[shown], phase[shown], color=BLUE, linewidth=1, markersize=3,
        marker="." if shown.size == time.size else "",
    )  # fmt: skip
    axes.set_xlabel("Time (ms)")
    axes.set_ylabel("Phase of the fringe (rad)")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.25 * (high - low))
    # above all, as to look for the best place among very many marks takes long
    axes.legend(loc="upper right", fontsize=8)
