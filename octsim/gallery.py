"""Which figures a run has, and which datasets each is drawn from."""

from collections.abc import Mapping

from octsim.config import Config
from octsim.reading import stage_axes

DRAWN_FROM: Mapping[str, tuple[str, ...]] = {
    "figure_1": (),
    "figure_6": ("focus_scan",),
    "figure_7": ("gaussian_fits", "focus_law"),
    "figure_8": ("spectra",),
    "figure_9": ("fourier",),
    "figure_10": ("fourier", "phase_slope"),
    "figure_11": ("fourier", "phase_slope"),
    "figure_12": ("phase_slope",),
    "paths": ("paths",),
}
"""Stages of each figure of a run without a grid."""
GRID = "grid"
"""Figure of the phase slope across the grid."""


NOT_DRAWN: Mapping[str, tuple[str, ...]] = {GRID: ("component_phase_slope",)}
"""Variables of a figure's datasets that it does not need, and that may be large."""


def figures_of(config: Config) -> dict[str, tuple[str, ...]]:
    """Give the figures of a run, and the stages that each is drawn from.

    A figure of one spectrum, or of one curve, is not drawn from a dataset over a grid; the slope
    across the grid is.
    """
    drawn = {
        figure: stages
        for figure, stages in DRAWN_FROM.items()
        if not any(stage_axes(stage, config) for stage in stages)
    }
    return drawn | ({GRID: ("phase_slope",)} if stage_axes("phase_slope", config) else {})
