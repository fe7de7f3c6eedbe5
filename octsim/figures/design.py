"""The search for the best instrument: the map of its error, and what makes it."""

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from octsim.figures.marks import doubtful, mark_doubtful, mark_missing, named
from octsim.figures.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, label, title

_COLOURS = (BLUE, ORANGE, GREEN, PURPLE, VERMILION, SKY)
_MARKERS = "osv^DP"
_STATUSES = ("accuracy_status", "fringe_status")


def design_figure(table: xr.Dataset) -> Figure:
    """Draw the least error over fill and focus, over aperture and band, and by estimator."""
    figure = Figure(figsize=(14, 4.6))
    over_fill, over_aperture, by_estimator = figure.subplots(1, 3, width_ratios=(1.2, 1, 1))
    _draw_map(figure, over_fill, table)
    _draw_apertures(over_aperture, table)
    _draw_estimators(by_estimator, table)
    figure.suptitle(title(table, "How well an expansion is known"), fontsize=11)
    return figure


def _draw_map(figure: Figure, axes: Axes, table: xr.Dataset) -> None:
    """Draw the least error, of all else, over fill and focus."""
    error = table["rms_error"]
    least = error.min(set(error.dims) - {"fill", "focus_offset"}).transpose("fill", "focus_offset")
    places = np.arange(table.sizes["fill"])
    # a fill is one of a few; a colour stands for orders of magnitude
    mesh = axes.pcolormesh(
        table["focus_offset"], places, np.log10(least), shading="nearest",
        cmap=mpl.colormaps["viridis_r"].with_extremes(bad="0.85"),
    )  # fmt: skip
    bar = figure.colorbar(mesh, ax=axes)
    bar.set_label("log₁₀ of the least standard error (nm)")
    for row, values in enumerate(least.values):
        for focus, value in zip(table["focus_offset"].values, values, strict=True):
            text = f"{value:.2g}" if np.isfinite(value) else "none"
            axes.text(
                focus, row, text, ha="center", va="center", fontsize=7,
                bbox={"facecolor": "white", "alpha": 0.6, "linewidth": 0, "pad": 1},
            )  # fmt: skip
    axes.set_yticks(places, [f"{fill:g}" for fill in table["fill"].values])
    axes.set_xlabel(label(table["focus_offset"], "focus above the law's"))
    axes.set_ylabel("Fill of the pupil")
    axes.grid(visible=False)


def _draw_apertures(axes: Axes, table: xr.Dataset) -> None:
    """Draw the least error, of all else, over the aperture for each band."""
    error = table["rms_error"]
    least = error.min(set(error.dims) - {"aperture", "band"})
    for band, colour, marker in zip(table["band"].values, _COLOURS * 9, _MARKERS * 9, strict=False):
        values = least.sel(band=band)
        axes.plot(table["aperture"], values, color=colour, marker=marker, label=str(band))
        mark_missing(axes, table["aperture"], values)
        for aperture, value in zip(table["aperture"].values, values.values, strict=True):
            if why := _doubts(table.sel(band=band, aperture=aperture)):
                mark_doubtful(axes, [aperture], [value], why)
    axes.set_yscale("log")
    axes.set_xlabel("Numerical aperture")
    axes.set_ylabel(label(error, "least error, rms over the diameters"))
    axes.legend(fontsize=8)


def _doubts(one: xr.Dataset) -> str:
    """Say which doubtful statuses the best setting has, of those of one aperture and band."""
    if one["rms_error"].isnull().all():
        return ""
    best = one["rms_error"].argmin(...)
    statuses = (one[name].isel(best, missing_dims="ignore") for name in _STATUSES)
    said = [named(status, where) for status in statuses if (where := doubtful(status)).any()]
    return ", ".join(said)


def _draw_estimators(axes: Axes, table: xr.Dataset) -> None:
    """Draw what makes the error of each estimator, in the setting that is best for it."""
    places = np.arange(table.sizes["estimator"])
    statistical, systematic, bound = np.full((3, places.size), np.nan)
    for place in places:
        one = table.isel(estimator=place)
        error = one["rms_error"]
        if error.isnull().all():
            continue
        at = one.isel(error.argmin(error.dims))
        parts = (at["statistical_error"], at["systematic_error"], at["least_error"])
        statistical[place], systematic[place], bound[place] = (
            np.sqrt(float((part**2).mean())) for part in parts
        )
    axes.plot(places, statistical, "o", color=BLUE, label="by the photons")
    axes.plot(places, systematic, "s", color=VERMILION, label="by the tolerances")
    axes.plot(places, bound, "_", color=BLACK, markersize=14, label="Cramér–Rao bound")
    names = [str(name).replace("_", "\n") for name in table["estimator"].values]
    axes.set_xticks(places, names, fontsize=7)
    axes.set_yscale("log")
    axes.set_xlabel("Estimator, each in its best setting")
    axes.set_ylabel("Standard error (nm)")
    axes.legend(fontsize=8)
