"""What is around a neuron, and in its sheath, does to the phase slope: by rays and by Maxwell."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from octsim.figures.marks import mark_missing_rows
from octsim.figures.style import BLACK, BLUE, ORANGE, title

_SCHEMES = (("vogel", "0.6", "v"), ("paths", BLUE, "o"), ("fullwave", ORANGE, "s"))
_MODES = {"follows": "focus follows", "held": "focus held"}
_LINEAR = 0.01
"""Change, mrad/nm, below which the axis is linear."""


def scenes_figure(table: xr.Dataset) -> Figure:
    """Draw the change of the slope of each scene, mean and scatter over the diameters."""
    cases = table["case"].values[1:].tolist()
    figure = Figure(figsize=(9.0, 1.8 + 0.21 * len(cases)))
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (mode, said) in zip(panels, _MODES.items(), strict=True):
        _panel(axes, table.sel(focus_mode=mode, estimator="sinusoid").isel(case=slice(1, None)))
        axes.set_title(said, fontsize=9)
        axes.set_xlabel("Change of the phase slope (mrad/nm)")
    panels[0].set_yticks(np.arange(len(cases)), cases, fontsize=8)
    panels[0].invert_yaxis()
    handles, names = panels[0].get_legend_handles_labels()
    figure.legend(
        handles, names, loc="outside lower center", ncols=3, fontsize=8,
        title="mean over the diameters, and the scatter", title_fontsize=8,
    )  # fmt: skip
    figure.suptitle(title(table, "Scenes beside the configured one"))
    return figure


def _panel(axes: Axes, table: xr.Dataset) -> None:
    place = np.arange(table.sizes["case"])
    for number, (scheme, colour, marker) in enumerate(_SCHEMES):
        one = table.sel(scheme=scheme)
        axes.errorbar(
            one["scene_mean_change"], place + 0.22 * (number - 1),
            xerr=one["scene_change_scatter"], color=colour, marker=marker, markersize=3.5,
            linestyle="none", linewidth=0.8, label=scheme,
        )  # fmt: skip
        lacking = "not by this scheme, or too long"
        mark_missing_rows(axes, place + 0.22 * (number - 1), one["scene_mean_change"], lacking)
    axes.axvline(0, color=BLACK, linewidth=0.6)
    axes.set_xscale("symlog", linthresh=_LINEAR)
    quantities = table["quantity"].values
    for at in np.flatnonzero(quantities[1:] != quantities[:-1]).tolist():
        axes.axhline(at + 0.5, color="0.8", linewidth=0.6)
