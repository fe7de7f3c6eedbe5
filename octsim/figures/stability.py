"""The stability matrix as a heat map: how much of the allowed error each cell uses."""

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from octsim.figures.style import VERMILION, title

_PANELS = (
    # quantity, heading, colour: None for the share of the bound, else the error itself
    ("phase", "Phase (rad)", None),
    ("amplitude", "Amplitude", None),
    ("phase_slope", "Phase slope\n(mrad/nm)", None),
    ("spectrum", "Sum", None),
    ("single_phase", "Phase in\nfloat32 (rad)", "single_phase_error"),
)
_MARKS = {"refused": "R", "no_such_ray": "–", "not_finite": "!"}
_NOTHING = 1e-30


def stability_figure(matrix: xr.Dataset) -> Figure:
    """Draw the errors of each cell: colour is the share of the bound, the number log10 of it."""
    factors = list(dict.fromkeys(matrix["factor"].values))
    settings = sorted(
        dict.fromkeys(zip(matrix["factor"].values, matrix["value"].values, strict=True)),
        key=lambda setting: factors.index(setting[0]),
    )
    corners = list(dict.fromkeys(matrix["corner"].values))
    places = [
        (settings.index((factor, value)), corners.index(corner))
        for factor, value, corner in zip(
            matrix["factor"].values, matrix["value"].values, matrix["corner"].values, strict=True
        )
    ]

    def grid(name: str) -> NDArray[np.float64]:
        filled = np.full((len(settings), len(corners)), np.nan)
        for place, value in zip(places, matrix[name].values, strict=True):
            filled[place] = value
        return filled

    figure = Figure(figsize=(11.5, 0.6 + 0.205 * len(settings) + 1.6))
    panels = figure.subplots(1, len(_PANELS), sharey=True)
    images: list[Any] = []
    for axes, (quantity, heading, colour) in zip(panels, _PANELS, strict=True):
        errors = grid(f"{quantity}_error")
        shown = errors if colour else grid(f"{quantity}_share")
        images.append(_draw(axes, shown, errors, single=bool(colour)))
        _mark(axes, grid("status"), matrix["status"])
        axes.set_title(heading, fontsize=9)
        axes.set_xticks(np.arange(len(corners)) + 0.5, corners, rotation=90, fontsize=8)
    _label_settings(panels[0], settings)
    figure.colorbar(
        images[0], ax=panels[:4], location="bottom", aspect=60, pad=0.01, extend="max",
        label="Error over the bound max(1e-9, 8 ε × condition number)",
    )  # fmt: skip
    figure.colorbar(
        images[-1], ax=panels[4:], location="bottom", aspect=15, pad=0.01, extend="both",
        label="Error (rad)",
    )  # fmt: skip
    figure.suptitle(
        title(matrix, "Stability") + "\n"
        "number: log10 of the error · R: refused · –: no such ray · empty: nothing to compare",
        fontsize=10,
    )
    return figure


def _draw(axes: Axes, shown: NDArray[np.float64], errors: NDArray[np.float64], single: bool) -> Any:
    """Colour the cells of a panel and write log10 of the error into each."""
    low, high = (1e-6, 1e2) if single else (1e-8, 1.0)
    colours = mpl.colormaps["cividis_r" if single else "YlGnBu"].with_extremes(
        over="0.15" if single else VERMILION, bad="0.93"
    )
    image = axes.pcolormesh(
        np.maximum(shown, _NOTHING), norm=LogNorm(low, high), cmap=colours,
        edgecolors="white", linewidth=0.6,
    )  # fmt: skip
    axes.grid(visible=False)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.set_xlim(0, shown.shape[1])
    axes.set_ylim(shown.shape[0], 0)
    for (row, column), error in np.ndenumerate(errors):
        if np.isfinite(error):
            power = round(float(np.log10(max(error, _NOTHING))))
            text = "none" if error < _NOTHING else f"{power}".replace("-", "−")
            red, green, blue, _ = image.to_rgba(np.maximum(shown[row, column], _NOTHING))
            light = 0.21 * red + 0.72 * green + 0.07 * blue
            axes.text(
                column + 0.5, row + 0.52, text, ha="center", va="center", fontsize=6,
                color="black" if light > 0.45 else "white",
            )  # fmt: skip
    return image


def _mark(axes: Axes, status: NDArray[np.float64], variable: xr.DataArray) -> None:
    """Write the mark of cells that have no number."""
    names = variable.attrs["flag_meanings"].split()
    marks = dict(zip(variable.attrs["flag_values"].tolist(), names, strict=True))
    for (row, column), code in np.ndenumerate(status):
        text = _MARKS.get(marks.get(code, ""), "")
        axes.text(
            column + 0.5, row + 0.52, text, ha="center", va="center", fontsize=6, color="0.35"
        )


def _label_settings(axes: Axes, settings: list[tuple[str, str]]) -> None:
    """Name the rows: their values beside them, each factor once before the first of its values."""
    starts = [i for i in range(len(settings)) if i == 0 or settings[i][0] != settings[i - 1][0]]
    values = [value or "as it is" for _, value in settings]
    axes.set_yticks(np.arange(len(settings)) + 0.5, values, fontsize=8)
    for place in starts[1:]:
        axes.axhline(place, xmin=-1.75, color="0.6", linewidth=0.6, clip_on=False)
        factor = settings[place][0]
        axes.text(
            -1.75, 1 - (place + 0.5) / len(settings), factor, transform=axes.transAxes,
            ha="left", va="center", fontsize=8, fontweight="bold",
        )  # fmt: skip
