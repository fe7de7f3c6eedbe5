"""What effects change: ranked bars of the phase slope, beside the spectrum's shape and the cost."""

import textwrap

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from octsim.figures.marks import mark_points
from octsim.figures.style import BLACK, BLUE, GREEN, ORANGE, VERMILION, title
from octsim.studies.effects.variants import EffectStatus

_LEAST = 1e-3  # % of the slope, where the axis begins
_LETTERS = 150
_GREY = "0.7"
_HATCHES = {VERMILION: "////", GREEN: "...."}
"""Tell bars apart where their colours can't be seen."""
_MISSING = {
    EffectStatus.NOT_BY_THIS_SCHEME: "not by this scheme",
    EffectStatus.NOT_IN_THIS_SCENE: "not in this scene",
    EffectStatus.NO_FRINGE: "without a fringe",
}


def effects_figure(table: xr.Dataset) -> Figure:
    """Draw each effect by the size of its change of the mean slope, then the pairs."""
    shown = table.isel(effect=np.flatnonzero(table["rank"].values > 0))
    shown = shown.isel(effect=np.argsort(shown["rank"].values))
    effects, pairs = shown.sizes["effect"], table.sizes["pair"]
    rows = effects + (1 + pairs if pairs else 0)
    figure = Figure(figsize=(11.5, 2.6 + 0.24 * rows))
    slope, shape, cost = figure.subplots(1, 3, sharey=True, width_ratios=(3, 1.3, 1.3))
    place, below = np.arange(effects), effects + 1 + np.arange(pairs)
    colours = _colours(shown)
    _slopes(slope, table, shown, place, colours)
    _bars(shape, place, shown["shape_change"].values, colours)
    _bars(cost, place, shown["cost_ratio"].values, colours)
    if pairs:
        _pairs(slope, table, below)
        _bars(shape, below, table["pair_shape_change"].values, [GREEN] * pairs)
        _bars(cost, below, table["pair_cost_ratio"].values, [GREEN] * pairs)
    cost.axvline(1, color=BLACK, linewidth=0.8)
    shape.set_xlabel("Change of I\nover its mean")
    cost.set_xlabel("Processor time of a\npoint, over that without")
    names = [*shown["effect"].values.tolist(), *([""] if pairs else [])]
    names += [_pair_name(table, number) for number in range(pairs)]
    slope.set_yticks(np.arange(rows), names, fontsize=8)
    slope.set_ylim(rows - 0.4, -0.6)
    for axes in (slope, shape, cost):
        axes.set_xscale("log")
        axes.tick_params(axis="y", length=0)
        axes.grid(visible=False, axis="y")
    slope.set_xlim(left=_LEAST)
    _legend(figure, table)
    _captions(figure, table)
    return figure


def _colours(shown: xr.Dataset) -> list[str]:
    """Return vermilion for what is needed, grey for what is not told from the noise."""
    needed = shown["needed"].values == 1
    resolved = (shown["resolved"].values == 1) & (shown["undecided"].values == 0)
    return [
        VERMILION if must else BLUE if known else _GREY
        for must, known in zip(needed, resolved, strict=True)
    ]


def _slopes(
    axes: Axes, table: xr.Dataset, shown: xr.Dataset, place: NDArray[np.int64], colours: list[str]
) -> None:
    """Draw the change of the mean slope with its noise, and the largest of the local slope."""
    change = 100 * np.abs(shown["calibration_change"].values)
    _bars(axes, place, np.maximum(change, 1.1 * _LEAST), colours)
    noise = 100 * np.abs(shown["calibration_change_noise"].values)
    axes.plot(np.maximum(noise, _LEAST), place, "|", color=BLACK, markersize=8)
    scale = 100 / abs(float(table["baseline_slope"]))
    worst = scale * shown["worst_slope_change"].values
    axes.plot(np.maximum(worst, _LEAST), place, "o", markersize=4, markerfacecolor="none",
              color=ORANGE)  # fmt: skip
    axes.axvline(100 * table.attrs["mean_tolerance"], color=BLACK, linewidth=0.8)
    axes.axvline(100 * table.attrs["local_tolerance"], color=ORANGE, linewidth=0.8, linestyle="--")
    mark_points(axes, np.maximum(change, _LEAST), place, shown["accuracy_status"])
    axes.set_xlabel(f"Change of the phase slope (%); what is less stands at {_LEAST:g} %")


def _pairs(axes: Axes, table: xr.Dataset, below: NDArray[np.int64]) -> None:
    """Draw pairs, with the sums of their parts."""
    scale = 100 / abs(float(table["baseline_slope"]))
    change = 100 * np.abs(table["pair_calibration_change"].values)
    _bars(axes, below, np.maximum(change, 1.1 * _LEAST), [GREEN] * below.size)
    total = scale * np.abs(table["pair_sum"].values)
    axes.plot(np.maximum(total, _LEAST), below, "D", color=BLACK, markersize=4)


def _bars(
    axes: Axes, place: NDArray[np.int64], values: NDArray[np.float64], colours: list[str]
) -> None:
    hatches = [_HATCHES.get(colour, "") for colour in colours]
    axes.barh(
        place, values, color=colours, height=0.7, log=True, hatch=hatches, edgecolor="white",
        linewidth=0,
    )  # fmt: skip


def _pair_name(table: xr.Dataset, number: int) -> str:
    first, second = (str(table[f"pair_{one}"].values[number]) for one in ("first", "second"))
    return f"{first} + {second}"


def _legend(figure: Figure, table: xr.Dataset) -> None:
    slope = figure.axes[0]
    marks = {
        "noise of the mean": ("|", BLACK), "largest at a diameter": ("o", ORANGE)
    } | ({"sum of a pair's parts": ("D", BLACK)} if table.sizes["pair"] else {})  # fmt: skip
    for name, (mark, colour) in marks.items():
        slope.plot(
            [], [], mark, color=colour, markersize=5, label=name,
            markerfacecolor="none" if mark == "o" else colour,
        )  # fmt: skip
    drawn = slope.get_legend_handles_labels()[0]
    mean, local = (f"{100 * table.attrs[f'{one}_tolerance']:g} %" for one in ("mean", "local"))
    patches = [
        _patch(VERMILION, f"needed: above {mean} (line), or {local} anywhere (dashed)"),
        _patch(BLUE, "may stay off"),
        _patch(_GREY, "not told from the noise"),
        *([_patch(GREEN, "a pair")] if table.sizes["pair"] else []),
    ]
    figure.legend(handles=[*patches, *drawn], loc="outside lower center", ncols=3, fontsize=8)


def _patch(colour: str, text: str) -> Patch:
    return Patch(
        facecolor=colour, edgecolor="white", linewidth=0, hatch=_HATCHES.get(colour, ""), label=text
    )


def _captions(figure: Figure, table: xr.Dataset) -> None:
    """Write the sentence above, and below it what is not measured."""
    lines = textwrap.wrap(str(table.attrs["sentence"]), _LETTERS)
    status = table["effect_status"].values
    for code, said in _MISSING.items():
        names = table["effect"].values[status == code].tolist()
        lines += textwrap.wrap(f"{said}: {', '.join(names)}", _LETTERS) if names else []
    head = title(table, "Effects, each alone against the run as configured; below, pairs")
    figure.suptitle("\n".join([head, *lines]), fontsize=8)
