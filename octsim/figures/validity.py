"""Where rays can be believed: the error of their slope, case by case over the diameter."""

import itertools

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from octsim.figures.style import BLACK, label, title

_NAMES = {"follows": "focus follows", "held": "focus held", "fft": "FFT", "sinusoid": "sinusoid"}


def validity_figure(table: xr.Dataset) -> Figure:
    """Draw the error of the slope by light paths: a step of colour at each bound, and its sign."""
    shown = table["ray_slope_error"].sel(ray_scheme="paths")
    bounds = [100 * float(bound) for bound in table["bound_of_error"]]
    edges = [-bound for bound in reversed(bounds)] + bounds
    colours = mpl.colormaps["RdBu_r"].resampled(len(edges) + 1).with_extremes(bad="0.85")
    norm = BoundaryNorm(edges, colours.N, extend="both")
    cases = table["case"].values.tolist()
    figure = Figure(figsize=(11.0, 1.6 + 0.22 * len(cases)))
    panels = figure.subplots(1, 4, sharey=True)
    kinds = itertools.product(table["focus_mode"].values, table["estimator"].values)
    for axes, (mode, estimator) in zip(panels, kinds, strict=True):
        values = shown.sel(focus_mode=mode, estimator=estimator).transpose("case", "diameter")
        image = axes.pcolormesh(
            table["diameter"], np.arange(len(cases)), 100 * values.values, norm=norm, cmap=colours,
            shading="nearest",
        )  # fmt: skip
        _signs(axes, table["diameter"].values, values.values)
        axes.grid(visible=False)
        axes.set_title(f"{_NAMES[str(mode)]}, {_NAMES[str(estimator)]}", fontsize=9)
        axes.set_xlabel(label(table["diameter"], "diameter"))
        axes.tick_params(length=0)
    panels[0].set_yticks(np.arange(len(cases)), cases, fontsize=8)
    panels[0].invert_yaxis()
    quantities = table["quantity"].values
    for place in np.flatnonzero(quantities[1:] != quantities[:-1]).tolist():
        for axes in panels:
            axes.axhline(place + 0.5, color="0.3", linewidth=0.8)
    figure.colorbar(
        image, ax=panels, location="bottom", aspect=60, pad=0.02, ticks=edges, format="%+g %%",
        label="Error of the phase slope by rays (+ or −: its sign; ×: no fringe)",
    )  # fmt: skip
    figure.suptitle(title(table, "Rays beside Maxwell's equations"))
    return figure


def _signs(axes: Axes, diameter: NDArray[np.float64], error: NDArray[np.float64]) -> None:
    """Write the sign of each error, which a colour does not tell in grey."""
    for (row, column), value in np.ndenumerate(error):
        sign = ("+" if value > 0 else "−") if np.isfinite(value) else "×"
        axes.text(
            float(diameter[column]), row, sign, ha="center", va="center", fontsize=7, color=BLACK,
            clip_on=True, path_effects=[withStroke(linewidth=1, foreground="white")],
        )  # fmt: skip
