"""Figure 1: the spiral on which rays start."""

from matplotlib.figure import Figure

from octsim.figures.style import BLUE
from octsim.optics.beam import vogel_spiral

POINTS = 300


def figure_1() -> Figure:
    """Draw the Vogel spiral of 300 points on the unit disk (thesis fig. 1)."""
    figure = Figure(figsize=(4.4, 4.4))
    axes = figure.subplots()
    axes.scatter(*vogel_spiral(POINTS, 1.0), s=8, color=BLUE)
    axes.set_aspect("equal")
    axes.set_xlabel("x (radius of the aperture)")
    axes.set_ylabel("y (radius of the aperture)")
    axes.set_title(f"Vogel spiral, {POINTS} points")
    return figure
