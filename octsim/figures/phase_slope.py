"""The phase slope over the diameter (figure 12)."""

import json

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from octsim.figures.marks import mark_clipped, mark_points
from octsim.figures.style import BLACK, GREEN, component_colour, label, tell_doubts, title

_MARKERS = ".x+1234"


def draw_components(
    axes: Axes, diameter: NDArray[np.float64], strongest: NDArray[np.int64], values: xr.DataArray
) -> NDArray[np.float64]:
    """Draw each component in use: solid where it is the strongest, dotted elsewhere.

    Returns the values of the strongest, (D,).
    """
    for number in np.unique(strongest).tolist():
        colour, curve = component_colour(number), values.isel(component=number).values
        axes.plot(diameter, curve, color=colour, linestyle=":", linewidth=1.0)
        axes.plot(
            diameter, np.where(strongest == number, curve, np.nan),
            color=colour, marker=_MARKERS[(number - 1) % len(_MARKERS)], markersize=3,
            label=f"component {number}",
        )  # fmt: skip
    drawn: NDArray[np.float64] = np.take_along_axis(values.values, strongest[:, np.newaxis], 1)[
        :, 0
    ]
    return drawn


def _exact(slopes: xr.Dataset) -> NDArray[np.bool_]:
    """Return at which diameters the slope by Maxwell's equations is known, (D,)."""
    if "exact_phase_slope" not in slopes:  # files of 0.3.0 and before don't have it
        return np.zeros(slopes.sizes["diameter"], bool)
    return np.asarray(np.isfinite(slopes["exact_phase_slope"].values))


def figure_12(slopes: xr.Dataset) -> Figure:
    """Draw the phase slope by component, the ideal curve and the prediction (thesis fig. 12)."""
    figure = Figure(figsize=(6.4, 4.6))
    axes = figure.subplots()
    diameter = slopes["diameter"]
    draw_components(
        axes, diameter.values, slopes["strongest_component"].values, slopes["component_phase_slope"]
    )
    estimator = json.loads(slopes.attrs["config"])["processing"]["estimator"]
    if estimator != "fft":
        name = estimator.replace("_", " ")
        axes.plot(diameter, slopes["phase_slope"], color=BLACK, linewidth=2, label=f"by {name}")
    axes.plot(
        diameter, slopes["ideal_phase_slope"],
        color=GREEN, linestyle="--", label="ideal spectrum cos(2ndk)",
    )  # fmt: skip
    exact = _exact(slopes)
    if exact.any():
        axes.plot(
            diameter[exact], slopes["exact_phase_slope"][exact],
            color=BLACK, linestyle="none", marker="D", markersize=5, markerfacecolor="white",
            label="Maxwell's equations", zorder=3,
        )  # fmt: skip
    predicted = float(slopes["predicted_phase_slope"])
    axes.axhline(
        predicted, color=BLACK, linestyle="-.", label=f"prediction {predicted:.2f} mrad/nm"
    )
    shown = np.concatenate([slopes[name].values for name in ("phase_slope", "ideal_phase_slope")])
    if exact.any():
        shown = np.append(shown, slopes["exact_phase_slope"].values[exact])
    shown = shown[np.isfinite(shown)] if np.isfinite(shown).any() else np.array([predicted])
    margin = 0.15 * max(float(np.ptp(shown)), 0.1)
    axes.set_ylim(shown.min() - margin, shown.max() + margin)
    mark_points(axes, diameter, slopes["phase_slope"], slopes.get("fringe_status"))
    mark_clipped(axes)
    axes.set_xlabel(label(diameter))
    axes.set_ylabel(label(slopes["phase_slope"], "phase slope"))
    axes.set_title(title(slopes, "Phase slope (solid where strongest)"))
    figure.legend(loc="outside lower center", ncols=3, fontsize=9)
    tell_doubts(figure, slopes)
    return figure
