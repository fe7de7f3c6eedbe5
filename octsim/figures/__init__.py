"""The thesis's figures, each a function from stored datasets to a matplotlib figure."""

from collections.abc import Callable, Mapping

from matplotlib.figure import Figure

from octsim.figures.focus import figure_6, figure_7
from octsim.figures.phase import figure_12

FIGURES: Mapping[str, tuple[Callable[..., Figure], tuple[str, ...]]] = {
    "figure_6": (figure_6, ("focus_scan",)),
    "figure_7": (figure_7, ("gaussian_fits", "focus_law")),
    "figure_12": (figure_12, ("phase_slope",)),
}
"""Each figure's function and the stages whose datasets it draws."""
