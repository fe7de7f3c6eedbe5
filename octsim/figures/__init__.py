"""The figures of a run, each a function from stored datasets to a matplotlib figure."""

from collections.abc import Callable, Mapping

import xarray as xr
from matplotlib.figure import Figure

from octsim.config.processing import Processing
from octsim.figures.beam import figure_1
from octsim.figures.focus_law import figure_7
from octsim.figures.focus_scan import figure_6
from octsim.figures.fourier import figure_9, figure_10, figure_11
from octsim.figures.grid import figure_grid
from octsim.figures.paths import figure_paths
from octsim.figures.phase_slope import figure_12
from octsim.figures.spectra import figure_8

Draw = Callable[[Mapping[str, xr.Dataset], Processing], Figure]

FIGURES: Mapping[str, Draw] = {
    "figure_1": lambda _, __: figure_1(),
    "figure_6": lambda stages, _: figure_6(stages["focus_scan"]),
    "figure_7": lambda stages, _: figure_7(stages["gaussian_fits"], stages["focus_law"]),
    "figure_8": lambda stages, processing: figure_8(stages["spectra"], processing),
    "figure_9": lambda stages, _: figure_9(stages["fourier"]),
    "figure_10": lambda stages, _: figure_10(stages["fourier"], stages["phase_slope"]),
    "figure_11": lambda stages, _: figure_11(stages["fourier"], stages["phase_slope"]),
    "figure_12": lambda stages, _: figure_12(stages["phase_slope"]),
    "paths": lambda stages, _: figure_paths(stages["paths"]),
    "grid": lambda stages, _: figure_grid(stages["phase_slope"]),
}
"""How each figure is drawn from the stages' datasets, by name, and the run's processing."""
