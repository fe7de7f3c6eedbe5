"""The diffraction limit by defocus: figure 6 and the phase slope, beside Maxwell's equations."""

import xarray as xr
from matplotlib.figure import Figure

from octsim.figures.marks import mark_clipped
from octsim.figures.style import BLUE, GREEN, ORANGE, PURPLE, SKY, label, title

_LOOKS = ((ORANGE, "-"), (PURPLE, "--"), (SKY, ":"), (BLUE, "-"), (GREEN, "-."))


def diffraction_figure(table: xr.Dataset) -> Figure:
    """Draw the intensity over the focus, each over its highest, and the slope over the diameter."""
    figure = Figure(figsize=(6.4, 7.2))
    light, slope = figure.subplots(2)
    for place, (colour, line) in enumerate(_LOOKS):
        one = table.isel(case=place)
        shown = one["intensity"] / one["intensity"].max()
        name = str(one["case"].item())
        light.semilogy(one["focus"], shown, color=colour, linestyle=line, label=name)
        slope.plot(one["diameter"], one["phase_slope"], color=colour, linestyle=line)
    light.set_ylim(1e-7, 2)
    mark_clipped(light)
    light.set_xlabel(label(table["focus"]))
    light.set_ylabel("Mean intensity (highest = 1)")
    light.set_title(title(table, "Diffraction limit by defocus"))
    slope.set_xlabel(label(table["diameter"]))
    slope.set_ylabel(label(table["phase_slope"], "phase slope"))
    figure.legend(loc="outside lower center", ncols=2, fontsize=9)
    return figure
