"""A measured spectrum beside the modelled ones, and what fits best."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import ScalarFormatter

from octsim.figures.marks import mark_clipped, mark_points
from octsim.figures.style import BLACK, BLUE, ORANGE, title

_BRIGHT = 0.05
"""Of the largest count, from which a ratio is shown."""
_LEAST = 0.01
"""Of a ratio, to each side of 1, that is shown."""


def match_figure(found: xr.Dataset) -> Figure:
    """Draw the spectra, their ratio, and each parameter beside what is believed."""
    figure = Figure(figsize=(12, 4.6))
    spectra, ratio, parameters = figure.subplots(1, 3, width_ratios=(3, 3, 2))
    nm = 1e3 * found["wavelength"].values
    measured, error = found["measured_spectrum"].values, found["measured_spectrum_error"].values
    spectra.fill_between(
        nm, measured - error, measured + error, color=BLACK, alpha=0.3, linewidth=0,
        label="± its standard error",
    )  # fmt: skip
    spectra.plot(nm, measured, color=BLACK, linewidth=1, label="measured, at rest")
    bright = measured > _BRIGHT * measured.max()
    for axes, over in ((spectra, 1.0), (ratio, measured)):
        for name, colour, line, text in (
            ("modelled_spectrum", ORANGE, "--", "as configured"),
            ("matched_spectrum", BLUE, "-", "best fit"),
        ):
            values = found[name].values
            with np.errstate(divide="ignore", invalid="ignore"):
                drawn = values if axes is spectra else np.where(bright, over / values, np.nan)
            axes.plot(nm, drawn, color=colour, linestyle=line, linewidth=1, label=text)
        axes.set_xlabel("Wavelength (nm)")
    spectra.set_ylabel("Counts without the dark")
    ratio.set_ylabel("Measured over modelled")
    off = np.nanquantile(np.abs(measured / found["matched_spectrum"].values - 1)[bright], 0.99)
    ratio.set_ylim(1 - max(2 * off, _LEAST), 1 + max(2 * off, _LEAST))
    mark_clipped(ratio)
    for axes in (spectra, ratio):
        axes.legend()
    _draw_parameters(parameters, found)
    figure.suptitle(
        title(found, f"Misfit {float(found['misfit']):.2%}, as configured "
              f"{float(found['configured_misfit']):.2%}"),
        fontsize=11,
    )  # fmt: skip
    return figure


def _draw_parameters(axes: Axes, found: xr.Dataset) -> None:
    """Draw each parameter in units of its tolerance, from what is believed."""
    scale = found["match_tolerance"].values
    scale = np.where(scale > 0, scale, 1.0)
    off = (found["matched"] - found["believed"]).values / scale
    error = np.minimum(found["matched_error"].values / scale, 1e3)
    rows = np.arange(off.size)
    axes.axvspan(-1, 1, color=BLACK, alpha=0.1, linewidth=0, label="tolerance")
    axes.errorbar(off, rows, xerr=error, fmt="o", color=BLUE, label="best fit")
    mark_points(axes, off, rows, found["match_status"])
    axes.set_yticks(rows, [str(name) for name in found["parameter"].values])
    axes.set_xscale("symlog", linthresh=3)
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.set_ylim(off.size - 0.5, -2.0)  # the first on top, below the legend
    axes.set_xlabel("From what is believed (tolerances)")
    axes.legend(loc="upper left", fontsize=9)
