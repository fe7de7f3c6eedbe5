"""The phase slope across the grid: its mean over the diameters, and its scatter."""

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from octsim.figures.marks import doubtful, mark_doubtful, mark_missing
from octsim.figures.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, label, title

_MOST_LINES = 8
_COLOURS = (BLUE, ORANGE, GREEN, VERMILION, SKY, PURPLE, BLACK, "0.5")
_MARKERS = "osD^v<>p"
_MOST_NAMES = 12  # along an axis
_MOST_LETTERS = 90  # of a line of the legend


def figure_grid(slopes: xr.Dataset) -> Figure:
    """Draw the mean phase slope and its scatter over the diameters, across the grid.

    The longest axis is drawn along x; the combinations of all others are lines, or, where there are
    many, rows of an image.
    """
    mean = slopes["mean_phase_slope"]
    along = max(map(str, mean.dims), key=lambda dim: (dim in _numeric(slopes), mean.sizes[dim]))
    others = [str(dim) for dim in mean.dims if dim != along]
    panels = {
        "mean_phase_slope": "mean slope",
        "phase_slope_standard_deviation": "scatter",
    }
    rows = {
        name: slopes[name].transpose(*others, along).values.reshape(-1, mean.sizes[along])
        for name in panels
    }
    count = len(rows["mean_phase_slope"])
    amiss = _amiss(slopes, [*others, along]).reshape(count, -1)
    figure = Figure(figsize=(6.4, 6.4))
    axes = figure.subplots(2, sharex=True)
    x, names = _positions(slopes, along)
    for panel, (name, text) in zip(axes, panels.items(), strict=True):
        if count > _MOST_LINES:
            colours = mpl.colormaps["viridis"].with_extremes(bad="0.85")
            image = panel.pcolormesh(
                x, np.arange(count), rows[name], shading="nearest", cmap=colours
            )
            if not np.isfinite(rows[name]).all():
                panel.set_title("grey: no value", fontsize=8, loc="right")
            figure.colorbar(image, ax=panel, label=label(slopes[name], text))
            panel.set_ylabel("Combination of " + ", ".join(others).replace("_", " "))
            panel.grid(visible=False)
            continue
        for number, values in enumerate(rows[name]):
            panel.plot(
                x, values, color=_COLOURS[number], marker=_MARKERS[number], markersize=4,
                linestyle="-" if along in _numeric(slopes) else "none",
                label=_told(slopes, others, number),
            )  # fmt: skip
            mark_missing(panel, x, values)
            mark_doubtful(panel, x[amiss[number]], values[amiss[number]], "some of the diameters")
        panel.set_ylabel(label(slopes[name], text))
    if names:
        axes[-1].set_xticks(x, names, rotation=30, ha="right")
    axes[-1].set_xlabel(label(slopes[along]) if along in slopes.coords else "Combination")
    axes[0].set_title(title(slopes, "Phase slope across the grid"))
    if 1 < count <= _MOST_LINES:
        lines, names = axes[0].get_legend_handles_labels()
        columns = 2 if max(map(len, names)) <= _MOST_LETTERS // 2 else 1
        figure.legend(lines, names, loc="outside lower center", ncols=columns, fontsize=8)
    return figure


def _amiss(slopes: xr.Dataset, order: list[str]) -> NDArray[np.bool_]:
    """Return at which combinations the slope is doubtful, or not known, at some diameters."""
    if "fringe_status" not in slopes:  # files of 0.1.0 don't have it
        return np.zeros([slopes.sizes[dim] for dim in order], bool)
    status, mean = slopes["fringe_status"], slopes["mean_phase_slope"]
    # of diameters, or of their numbers where the grid varies how many there are
    over = [dim for dim in status.dims if dim not in mean.dims]
    some = status.copy(data=doubtful(status)).any(over)
    return np.asarray(some.broadcast_like(mean).transpose(*order).values)


def _numeric(slopes: xr.Dataset) -> set[str]:
    return {str(name) for name, c in slopes.coords.items() if c.dtype.kind in "if"}


def _positions(slopes: xr.Dataset, along: str) -> tuple[Any, list[str]]:
    """Return where to draw along an axis, and names of the places if they are no numbers."""
    if along in _numeric(slopes):
        return slopes[along].values, []
    count = slopes.sizes[along]
    places = np.arange(count)
    beside = [c for c in slopes.coords.values() if c.dims == (along,)]
    if count > _MOST_NAMES:
        return places, []
    names = [", ".join(f"{c.values[place]}" for c in beside) for place in places]
    return places, [_shortened(name, _MOST_LETTERS // 3) for name in names]


def _told(slopes: xr.Dataset, others: list[str], number: int) -> str:
    """Name one combination of the other axes."""
    place = np.unravel_index(number, [slopes.sizes[dim] for dim in others]) if others else ()
    told = []
    for dim, row in zip(others, place, strict=True):
        if slopes.sizes[dim] == 1:
            continue
        for name, coordinate in slopes.coords.items():
            if coordinate.dims == (dim,):
                value = coordinate.values[row]
                text = f"{value:.6g}" if coordinate.dtype.kind == "f" else str(value)
                unit = {"um": " µm"}.get(str(coordinate.attrs["units"]), "")
                told.append(f"{str(name).replace('_', ' ')} {text}{unit}")
    return _shortened(", ".join(told), _MOST_LETTERS)


def _shortened(text: str, most: int) -> str:
    return text if len(text) <= most else text[: most - 1] + "…"
