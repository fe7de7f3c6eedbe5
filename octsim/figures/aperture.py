"""The objective's aperture: where rays start, coloured by the light path that they take."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from octsim.figures.paths import LINES
from octsim.figures.recorded import config_in, middle_of
from octsim.figures.style import title
from octsim.instrument.drawn_rays import lit_aperture

_DARK = "0.88"
_MARKS = "osD^v<>P"
"""Of the paths, so that they are told apart in grey."""
_LONG = 45
"""Letters of a name that leave room for no other beside."""


def aperture_figure(spectra: xr.Dataset) -> Figure:
    """Draw the aperture at the middle diameter of a sweep, as the scene is drawn at it."""
    config, (diameter, focus) = config_in(spectra), middle_of(spectra)
    lit = lit_aperture(config, diameter, focus)
    figure = Figure(figsize=(6.4, 7.2))
    axes = figure.subplots()
    labels = ["not detected", *lit.names, "on a fainter path"]
    colours = [_DARK, *(colour for colour, _ in LINES[: len(lit.names)]), "0.7"]
    marks = ["o", *_MARKS[: len(lit.names)], "x"]
    for number, (name, colour, mark) in enumerate(zip(labels, colours, marks, strict=True)):
        there = np.flatnonzero(lit.path == number - 1)
        if there.size:
            axes.plot(
                lit.x[there], lit.y[there], linestyle="none", marker=mark, markersize=2.5,
                color=colour, markeredgewidth=0.5, label=f"{name}: {there.size}",
            )  # fmt: skip
    angle = np.linspace(0, 2 * np.pi, 200)
    axes.plot(np.cos(angle), np.sin(angle), color="0.2", linewidth=0.8)
    axes.set(aspect="equal", xlim=(-1.05, 1.05), ylim=(-1.05, 1.05))
    axes.set_xlabel("x (radius of the aperture)")
    axes.set_ylabel("y (radius of the aperture)")
    axes.grid(visible=False)
    axes.set_title(title(spectra, f"Aperture at d = {diameter:.4g} µm, focus {focus:.4g} µm"))
    figure.legend(
        loc="outside lower center", fontsize=7, markerscale=2.5, title_fontsize=8,
        ncols=1 if max(map(len, labels)) > _LONG else 2,
        title="light path on which most of a ray is detected, and rays",
    )  # fmt: skip
    return figure
