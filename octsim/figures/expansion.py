"""An expansion over time with its statistical and systematic error."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from octsim.figures.envelope import band, extremes
from octsim.figures.marks import mark_doubtful
from octsim.figures.style import BLUE, SKY, title
from octsim.phase.rest_error import ErrorStatus
from octsim.studies.responses.separability import Separability

TIME_UNIT = 1e3  # ms for each s
FROM = {
    ErrorStatus.ROUNDING: "of rounding: the scatter at rest is less",
    ErrorStatus.UNKNOWN: "not known: all samples at rest are equal",
}
"""What a statistical error is, where it is not that of the phase's scatter."""


def standard_error(found: xr.Dataset) -> NDArray[np.float64]:
    """Statistical and systematic error together, nm."""
    both: NDArray[np.float64] = np.hypot(found["statistical_error"], found["systematic_error"])
    return both


def draw_expansion(axes: Axes, found: xr.Dataset) -> None:
    """Draw an expansion over time, with bands of its errors; of a long one, what can be seen."""
    time, change = TIME_UNIT * found["time"].values, found["expansion"].values
    for error, colour, text in (
        (standard_error(found), SKY, "± both errors"),
        (found["statistical_error"].values, BLUE, "± statistical error"),
    ):
        axes.fill_between(
            *band(time, change - error, change + error),
            color=colour, alpha=0.35, linewidth=0, label=text,
        )  # fmt: skip
    shown = extremes(time, change)
    axes.plot(
        time[shown], change[shown], color=BLUE, linewidth=1, markersize=3, label="recovered",
        marker="." if shown.size == time.size else "",
    )  # fmt: skip
    axes.set_xlabel("Time (ms)")
    axes.set_ylabel("Change of the diameter (nm)")


def expansion_figure(found: xr.Dataset) -> Figure:
    """Draw the expansion that a measured series comes to."""
    if "quantity" in found.dims:
        return _fit_figure(found)
    figure = Figure()
    axes = figure.subplots()
    draw_expansion(axes, found)
    if "outlier" in found:
        alone = found.isel(time=found["outlier"].values > 0)
        time, change = TIME_UNIT * alone["time"].values, alone["expansion"].values
        mark_doubtful(axes, time, change, "outliers, alone among others")
    status = ErrorStatus(int(found.get("error_status", ErrorStatus.SCATTER)))
    if status in FROM:
        axes.plot([], [], " ", label=f"statistical error {FROM[status]}")
    axes.set_title(
        title(found, f"Change of a diameter of {float(found['diameter']):.4g} µm"), fontsize=11
    )
    axes.legend()
    return figure


def _fit_figure(found: xr.Dataset) -> Figure:
    """Draw all that has changed by phases in several bands."""
    count = found.sizes["quantity"]
    figure = Figure(figsize=(6 * count, 4.4))
    for number, axes in enumerate(np.atleast_1d(figure.subplots(1, count))):
        one = found.isel(quantity=number)
        name, unit = str(one["quantity"].item()), str(one["quantity_unit"].item())
        kinds = ("statistical_error", "systematic_error")
        errors = {kind: one[f"change_{kind}"] for kind in kinds}
        draw_expansion(axes, one.assign({"expansion": one["change"], **errors}))
        status = Separability(int(one["separability"]))
        if status != Separability.SEPARABLE:
            axes.plot([], [], " ", label=status.name.lower().replace("_", " "))
        axes.set_ylabel(f"Change of the {name.replace('_', ' ')} ({unit.replace('1e-3', '10⁻³')})")
        axes.legend()
    figure.suptitle(title(found, f"A neuron of {float(found['diameter']):.4g} µm"), fontsize=11)
    return figure
