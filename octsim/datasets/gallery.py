"""The figures of a run: which there are, and what each shows."""

from collections.abc import Mapping
from typing import NamedTuple

from octsim.config.models import Config
from octsim.datasets.catalog import CATALOG, STAGES
from octsim.datasets.keys import stage_axes, stages_of
from octsim.datasets.stage import Figure

SPIRAL = Figure("figure_1", "octsim.figures.beam:figure_1", "spiral on which rays start")
"""The figure of a run that needs no dataset."""
ANIMATION = Figure(
    "animation", "octsim.figures.animation:animate",
    "the focus scan: the scene with its rays, focus after focus, and the intensity",
    of=("focus_scan",),
)  # fmt: skip
"""Of a run, made when it is asked for: ``figures/animation.gif``."""
CAPTIONS: Mapping[str, str] = {
    one.name: one.caption for one in (SPIRAL, *(f for row in CATALOG.values() for f in row.figures))
}
"""What each figure shows."""
FORMS: Mapping[str, str] = {
    "png": "image/png",
    "svg": "image/svg+xml",
    "pdf": "application/pdf",
    "txt": "text/plain",
}
"""Endings of the files of each figure, and their media types; the text is its caption."""


class Drawn(NamedTuple):
    """A figure, and the datasets that it is drawn from."""

    figure: Figure
    sources: tuple[str, ...]


def drawn_with(stage: str) -> dict[str, Drawn]:
    """Return the figures of one dataset by their names."""
    return {one.name: Drawn(one, one.of or (stage,)) for one in CATALOG[stage].figures}


def all_run_figures() -> dict[str, Drawn]:
    """Return all figures that a run may have, by their names."""
    found = {SPIRAL.name: Drawn(SPIRAL, ())}
    for stage in STAGES:
        found |= drawn_with(stage)
    return found


def run_figures(config: Config) -> dict[str, Drawn]:
    """Return the figures of a run by their names.

    A figure of one spectrum, or of one curve, is not drawn from a dataset over a grid; the slope
    across the grid is.
    """

    def has(one: Drawn) -> bool:
        return any(stage_axes(source, config) for source in one.sources) == one.figure.over_grid

    there = stages_of(config)
    every = {
        name: Drawn(one.figure, tuple(source for source in one.sources if source in there))
        for name, one in all_run_figures().items()
    }
    return {name: one for name, one in every.items() if has(one)}


def figures_of(config: Config) -> dict[str, tuple[str, ...]]:
    """Return the names of a run's figures, and the datasets that each is drawn from."""
    return {name: one.sources for name, one in run_figures(config).items()}
