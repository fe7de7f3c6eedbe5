"""The detector's falloff and radius: ray noise, jumps, signal, and the distance from Maxwell's."""

import textwrap

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from octsim.figures.marks import mark_missing, mark_points
from octsim.figures.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, VERMILION, label, title
from octsim.studies.detector.recommended import chosen, own

_COLOURS = {
    "parabolic": BLUE, "top_hat": VERMILION, "cosine": ORANGE, "gaussian": GREEN, "fibre": PURPLE
}  # fmt: skip
_DASHES = {"top_hat": "-", "parabolic": "--", "gaussian": ":"}
_MARKERS = {"parabolic": "o", "top_hat": "s", "cosine": "^", "gaussian": "D", "fibre": "P"}
_LETTERS = 190
_APART = 0.15
_FAINT = 1e-6
"""mrad/nm; jumps below that are none, and not drawn."""


def detector_figure(table: xr.Dataset) -> Figure:
    """Draw what each falloff does over the radius, and some slopes over the diameter."""
    figure = Figure(figsize=(16, 8.2))
    panels = figure.subplots(2, 4).ravel().tolist()
    counted = table.sel(ray_scheme="vogel")
    _over_radius(panels[0], table["ray_noise"], "Ray noise of the slope, rms", log=True)
    edge = table["edge_phase_jump"].where(table["edge_phase_jump"] > _FAINT)
    _over_radius(panels[1], edge, "Jump by edge rays per nm, rms", log=True)
    without = [
        str(name) for name in table["falloff"].values if edge.sel(falloff=name).isnull().all()
    ]
    some = edge.sel(falloff=[str(name) for name in table["falloff"].values if name not in without])
    mark_missing(panels[1], some["detector_radius"], some.sum("falloff", skipna=False))
    none = [f"none: {' and '.join(without)}"] if without else []
    panels[1].set_title("; ".join([*none, "×: none of some other"]), fontsize=8)
    _over_radius(panels[2], counted["slope_scatter"], "Scatter of the slope", log=True)
    _over_radius(panels[3], counted["signal"], "Signal, mean intensity", log=True)
    _over_radius(panels[4], counted["line_slope"], "Slope of the line through the phase")
    exact = float(table["maxwell_line_slope"])
    if np.isfinite(exact):
        panels[4].axhline(exact, color=BLACK, linestyle="--")
        panels[4].annotate(
            "Maxwell's", (0.98, exact), xycoords=("axes fraction", "data"), fontsize=8, ha="right",
            xytext=(0, 3), textcoords="offset points",
            bbox={"facecolor": "white", "alpha": 0.7, "linewidth": 0, "pad": 0.5},
        )  # fmt: skip
    _over_radius(panels[5], counted["slope_difference"], "Slope less Maxwell's, rms")
    _over_radius(panels[6], counted["shape_difference"], "Spectrum's shape less Maxwell's, rms")
    _slopes(panels[7], table)
    taken = chosen(table)
    for axes in panels[:7]:
        axes.axvline(own(table).radius, color="0.4", linewidth=0.9, linestyle=":")
    if taken:
        at = float(table["ray_noise"].sel(taken.at))
        panels[0].plot(
            taken.radius, at, "o", markersize=14, markerfacecolor="none", markeredgecolor=BLACK
        )
    panels[3].legend(fontsize=8, loc="lower right")  # a signal grows with the radius
    what = "The detector's falloff and radius (dotted: the run's own)"
    figure.suptitle(title(table, what), fontsize=12)
    said = str(table.attrs["recommendation"])
    figure.supxlabel(
        "\n".join(textwrap.wrap(f"{said[:1].upper()}{said[1:]}.", _LETTERS)), fontsize=9
    )
    return figure


def _over_radius(axes: Axes, values: xr.DataArray, name: str, log: bool = False) -> None:
    """Draw a line for each falloff."""
    for falloff, colour in _COLOURS.items():
        one = values.sel(falloff=falloff)
        if one.isnull().all():
            continue
        axes.plot(
            one["detector_radius"], one, color=colour, marker=_MARKERS[falloff], markersize=4,
            label=falloff.replace("_", " "),
        )  # fmt: skip
    axes.set_xscale("log")
    if log:
        axes.set_yscale("log")
    radii = values["detector_radius"].values
    # of two that are close the names would lie on each other
    far = np.diff(radii, prepend=0.0) > _APART * radii
    axes.set_xticks(radii[far], [f"{radius:.3g}" for radius in radii[far]], fontsize=7)
    axes.minorticks_off()
    axes.set_xlabel("R_det (µm)")
    axes.set_ylabel(label(values, name))


def _slopes(axes: Axes, table: xr.Dataset) -> None:
    """Draw local slopes by counted rays at the run's own radius."""
    radius = own(table).radius
    slopes = table["ray_phase_slope"].sel(ray_scheme="vogel", detector_radius=radius)
    status = table["fringe_status"].sel(ray_scheme="vogel", detector_radius=radius)
    for falloff, line in _DASHES.items():
        axes.plot(
            table["diameter"], slopes.sel(falloff=falloff), color=_COLOURS[falloff], linestyle=line,
            label=falloff.replace("_", " "), linewidth=1.0,
        )  # fmt: skip
        mark_points(
            axes, table["diameter"], slopes.sel(falloff=falloff), status.sel(falloff=falloff),
            falloff.replace("_", " "),
        )  # fmt: skip
    axes.set_xlabel(label(table["diameter"], "diameter"))
    axes.set_ylabel(label(slopes, f"local slope at R_det {radius:.3g} µm"))
    axes.legend(fontsize=8)
