"""What each light path has in the spectra, over the diameter."""

from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from octsim.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    label,
    tell,
    title,
)
from octsim.phase.fringe_status import FringeStatus

STRONGEST = 8
"""Paths that are drawn."""
LINES: tuple[tuple[str, Any], ...] = (
    (BLUE, "-"), (ORANGE, "--"), (GREEN, "-."), (VERMILION, ":"),
    (SKY, (0, (8, 2))), (PURPLE, (0, (5, 1, 1, 1, 1, 1))), (BLACK, (0, (1, 2))),
    ("0.5", (0, (3, 3))),
)  # fmt: skip
"""Colour and line of each path, the strongest first; each is another in grey too."""


def figure_paths(paths: xr.Dataset) -> Figure:
    """Draw amplitude, share of the intensity and optical path of the strongest light paths."""
    shown = paths.isel(path=slice(0, STRONGEST))
    figure = Figure(figsize=(6.4, 7.6))
    panels = figure.subplots(3, sharex=True)
    drawn = {
        "field_amplitude": "field amplitude",
        "share": "share of the intensity",
        "mean_optical_path_length": "mean optical path",
    }
    for axes, (name, text) in zip(panels, drawn.items(), strict=True):
        for number in range(shown.sizes["path"]):
            colour, line = LINES[number]
            values = shown[name].isel(path=number)
            if name == "field_amplitude":
                values = values.where(values > 0)
            axes.plot(
                shown["diameter"], values, color=colour, linestyle=line,
                label=str(shown["path"].values[number]),
            )  # fmt: skip
        axes.set_ylabel(label(shown[name], text))
    panels[0].set_yscale("log")
    panels[1].set_yscale("symlog", linthresh=1e-3)
    panels[-1].set_xlabel(label(shown["diameter"]))
    panels[0].set_title(title(paths, "Light paths"))
    handles, names = panels[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=2, fontsize=8, handlelength=4)
    if not (paths["field_amplitude"] > 0).any():
        tell(figure, [f"no light on any path: {FringeStatus.NO_LIGHT.remedy}"])
    return figure
