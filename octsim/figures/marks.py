"""Marks that mean the same in every figure: doubtful points, missing ones, curves that go out."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from octsim.figures.style import VERMILION

FINE = frozenset(
    {
        "reached", "not_controlled", "visible", "known", "fitted", "fitted_through", "measured",
        "separable", "among_others", "by_maxwell", "compared",
    }
)  # fmt: skip
"""Meanings of statuses that are no reason for doubt; a number of rays has no accuracy to miss."""
DOUBTFUL: Mapping[str, Any] = {
    "color": VERMILION, "marker": "s", "markersize": 8, "fillstyle": "none"
}  # fmt: skip
"""Look of the mark of a point that is to be doubted."""
MISSING: Mapping[str, Any] = {"color": "0.35", "marker": "x", "markersize": 5}
"""Look of the mark of what has no value."""
_MANY = 30
_EDGE = 0.015
"""Of the axes' height, between its edge and a mark there."""

Floats = NDArray[np.float64]


def doubtful(status: xr.DataArray) -> NDArray[np.bool_]:
    """Return where a status, as its flags say what it means, is a reason for doubt."""
    amiss = [code for code, name in _flags(status).items() if name not in FINE]
    return np.asarray(np.isin(status.values, amiss))


def named(status: xr.DataArray, where: NDArray[np.bool_]) -> str:
    """Say in words which statuses there are at some points, those of the lowest code first."""
    there = set(status.values[where].tolist())
    return ", ".join(
        name.replace("_", " ") for code, name in _flags(status).items() if code in there
    )


def mark_points(
    axes: Axes, x: ArrayLike, y: ArrayLike, status: xr.DataArray | None, curve: str = ""
) -> None:
    """Mark the points (N,) of a doubtful status, and at the lower edge those without a value.

    Both stand in the legend once, with what the status is.

    Parameters
    ----------
    axes : Axes
        Where the points are drawn.
    x, y : array_like, shape (N,)
        The points; NaN where there is no value.
    status : DataArray, shape (N,), optional
        Its flags say what it means. Old files have none.
    curve : str
        Name of the curve, where there are several.
    """
    if status is None:
        mark_missing(axes, x, y)
        return
    place, value = np.asarray(x, float), np.asarray(y, float)
    known, amiss = np.isfinite(value), doubtful(status)
    marked = known & amiss
    if marked.sum() > _MANY and (marked == known).all():
        # marks on all would hide the curve, and tell no point from another
        of = f"every point of {curve}" if curve else "every point"
        _enter(axes, f"doubtful, at {of}: {named(status, marked)}", **DOUBTFUL)
    else:
        mark_doubtful(axes, place[marked], value[marked], named(status, marked))
    mark_missing(axes, place, value, named(status, amiss & ~known))


def mark_doubtful(axes: Axes, x: ArrayLike, y: ArrayLike, why: str) -> None:
    """Mark points (N,) that are doubtful by a hollow square, and say why in the legend, once."""
    if np.size(x):
        text = _once(axes, f"doubtful: {why}")
        axes.plot(x, y, linestyle="none", zorder=3, label=text, **DOUBTFUL)


def mark_missing(axes: Axes, x: ArrayLike, y: ArrayLike, why: str = "") -> None:
    """Mark at the lower edge of axes the points (N,) without a value."""
    missing = ~np.isfinite(np.asarray(y, float))
    text = f"no value: {why}" if why else "no value"
    _mark_missing(axes, np.asarray(x, float)[missing], text)


def mark_missing_rows(axes: Axes, rows: ArrayLike, values: ArrayLike, why: str) -> None:
    """Mark at the left edge of axes the rows (N,) whose values there are not."""
    missing = ~np.isfinite(np.asarray(values, float))
    if missing.any():
        axes.plot(
            np.full(int(missing.sum()), _EDGE), np.asarray(rows, float)[missing], linestyle="none",
            transform=axes.get_yaxis_transform(), label=_once(axes, f"no value: {why}"), **MISSING,
        )  # fmt: skip


def mark_clipped(axes: Axes) -> None:
    """Mark where curves leave axes whose limits are set, and say how far they go.

    A triangle at the edge points the way, in the colour of the curve; the legend has one entry.
    """
    low, high = axes.get_ylim()
    scale = axes.yaxis.get_transform()
    furthest: list[float] = []
    for line in axes.get_lines():
        if line.get_transform() != axes.transData:
            continue
        x, y = (np.asarray(values, float) for values in line.get_data())
        # what an axis has no place for, as 0 of a log axis, leaves it nowhere
        y = np.where(np.isfinite(scale.transform(y)) & np.isfinite(y), y, np.nan)
        for beyond, edge, marker in ((y > high, 1 - _EDGE, "^"), (y < low, _EDGE, "v")):
            if beyond.any():
                level = scale.transform(np.array([high if marker == "^" else low]))[0]
                at = _crossings(x, scale.transform(y), beyond, level)
                furthest.append(float(y[beyond].max() if marker == "^" else y[beyond].min()))
                axes.plot(
                    at, np.full(at.size, edge), marker, color=line.get_color(), markersize=6,
                    transform=axes.get_xaxis_transform(), zorder=4,
                )  # fmt: skip
    if furthest:
        ends = dict.fromkeys((min(furthest), max(furthest)))
        told = " and ".join(f"{end:.4g}" for end in ends).replace("-", "−")
        _enter(axes, f"leaves the axes, to {told}", marker="^", color="0.4")


def _flags(status: xr.DataArray) -> dict[int, str]:
    """Return what each value of a status means."""
    codes = np.atleast_1d(status.attrs["flag_values"]).tolist()
    return dict(zip(codes, str(status.attrs["flag_meanings"]).split(), strict=True))


def _crossings(x: Floats, y: Floats, beyond: NDArray[np.bool_], edge: float) -> Floats:
    """Return where a curve, of lines between its points, crosses an edge; else what is beyond."""
    change = np.flatnonzero(beyond[1:] != beyond[:-1])
    step = y[change + 1] - y[change]
    inside = np.isfinite(step)
    change, step = change[inside], step[inside]
    crossed: Floats = x[change] + (edge - y[change]) / step * (x[change + 1] - x[change])
    return crossed if crossed.size else x[beyond]


def _mark_missing(axes: Axes, place: Floats, text: str) -> None:
    if place.size:
        axes.plot(
            place, np.full(place.size, _EDGE), linestyle="none", zorder=3,
            transform=axes.get_xaxis_transform(), label=_once(axes, text), **MISSING,
        )  # fmt: skip


def _once(axes: Axes, text: str) -> str | None:
    """Return what a legend is to say, or None if it says so already."""
    return None if text in axes.get_legend_handles_labels()[1] else text


def _enter(axes: Axes, text: str, **look: Any) -> None:
    """Give the axes' legend an entry of its own, unless it has it."""
    if label := _once(axes, text):
        axes.add_line(Line2D([], [], linestyle="none", label=label, **look))
