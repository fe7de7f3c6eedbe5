"""Which datasets and figures a run has, and which datasets each is drawn from."""

from collections.abc import Mapping

from octsim.config.models import Config
from octsim.datasets.catalog import stage_axes

STAGES = (
    "focus_scan", "focus_sweep", "gaussian_fits", "focus_law", "detections", "spectra", "paths",
    "fourier", "phase_slope",
)  # fmt: skip
"""Datasets of a run, in the order that light meets them."""
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

TARGETS: Mapping[str, tuple[str, ...]] = {
    "action_potential": ("action_potential",),
    "calibration": ("calibration",),
    "causes": ("causes", "spike"),
    "estimators": ("estimators",),
    "expansion": ("expansion",),
    "stability": ("stability",),
    "tradeoff": ("tradeoff",),
}
"""Targets beside a run, each one dataset, and the figures of each."""
CAPTIONS: Mapping[str, str] = {
    "figure_1": "spiral on which rays start",
    "figure_6": "detected rays and intensity over the focus",
    "figure_7": "foci of greatest intensity, and the line through them",
    "figure_8": "a spectrum on its way to its Fourier transform",
    "figure_9": "Fourier transform of a spectrum",
    "figure_10": "magnitude of the components over the diameter",
    "figure_11": "phase of the components over the diameter",
    "figure_12": "phase slope over the diameter",
    "paths": "what each light path has in the spectra",
    GRID: "phase slope across the grid",
    "action_potential": "an action potential that is recovered, with its errors",
    "calibration": "phase slope at a fixed focus, and what makes its error",
    "causes": "what makes the phase slope scatter",
    "estimators": "estimators of the phase compared",
    "expansion": "expansion that a measured series comes to, with its errors",
    "spike": "what makes the phase slope spike",
    "stability": "errors of rounding at the extremes",
    "tradeoff": "error over cost of each setting",
}
"""What each figure shows."""


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
