"""Phase responses to all that may change in a neuron, and how well it is told apart."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from octsim.figures.marks import mark_points
from octsim.figures.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, label, title
from octsim.studies.responses.quantities import WITH_MEMBRANE

_COLOURS = (BLUE, ORANGE, GREEN, VERMILION, PURPLE, SKY, BLACK)
_MARKERS = "osv^DPX"
_ERRORS = {"error_alone": ":", "error_together": "-"}


def responses_figure(table: xr.Dataset) -> Figure:
    """Draw the phase's responses, the apparent expansion, and the errors of a spectrum's fit."""
    figure = Figure(figsize=(14, 4.6))
    moved, apparent, errors = figure.subplots(1, 3)
    # the scene that has most
    one = table.isel(variant=-1)
    _draw(moved, one, "phase_response", "Change of the phase (mrad)")
    _draw(apparent, one, "apparent_expansion", "Apparent expansion (nm)")
    _draw_errors(errors, one)
    scene = " of a neuron with a membrane" if one["variant"].item() == WITH_MEMBRANE else ""
    text = f"What else than the diameter moves the phase{scene}"
    figure.suptitle(title(table, text), fontsize=11)
    return figure


def _name(one: xr.Dataset, place: int) -> str:
    unit = str(one["quantity_unit"].values[place])
    return (
        f"{str(one['quantity'].values[place]).replace('_', ' ')}, a {unit.replace('1e-3', '10⁻³')}"
    )


def _draw(axes: Axes, one: xr.Dataset, name: str, text: str) -> None:
    """Draw something of the whole band's phase over the diameter, for each quantity."""
    values = one[name].sel(observable="whole")
    error = one.get(f"{name}_standard_error", xr.zeros_like(one[name])).sel(observable="whole")
    for place in range(one.sizes["quantity"]):
        curve, own = values.isel(quantity=place), error.isel(quantity=place)
        axes.fill_between(
            one["diameter"], curve - own, curve + own, color=_COLOURS[place % len(_COLOURS)],
            alpha=0.2, linewidth=0,
        )  # fmt: skip
        axes.plot(
            one["diameter"], curve, color=_COLOURS[place % len(_COLOURS)],
            marker=_MARKERS[place % len(_MARKERS)], markersize=4, label=_name(one, place),
        )  # fmt: skip
        mark_points(
            axes, one["diameter"], curve, one["accuracy_status"], _name(one, place),
        )  # fmt: skip
    axes.set_xlabel(label(one["diameter"], "diameter at rest"))
    axes.set_ylabel(text)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.35 * (high - low))  # room for the legend
    axes.legend(fontsize=8)


def _draw_errors(axes: Axes, one: xr.Dataset) -> None:
    """Draw the standard errors by a spectrum's shape: others known, and all unknown."""
    of_shape = one.sel(source="spectrum")
    for place in range(one.sizes["quantity"]):
        for name, line in _ERRORS.items():
            values = np.where(
                np.isfinite(of_shape[name][:, place]), of_shape[name][:, place], np.nan
            )
            axes.plot(
                one["diameter"], values, color=_COLOURS[place % len(_COLOURS)], linestyle=line,
                marker=_MARKERS[place % len(_MARKERS)], markersize=4,
                label=_name(one, place) if name == "error_together" else None,
            )  # fmt: skip
            if name == "error_together":
                status = of_shape["separability"][:, place]
                mark_points(axes, one["diameter"], values, status, _name(one, place))
    axes.plot([], [], ":", color=BLACK, label="all others known")
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.35)  # room for the legend
    axes.set_xlabel(label(one["diameter"], "diameter at rest"))
    axes.set_ylabel("Standard error by a spectrum (nm, or 10⁻³)")
    axes.legend(fontsize=8, ncols=2)
