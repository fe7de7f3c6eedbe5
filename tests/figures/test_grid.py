"""The figure of a run over a grid, whatever its axes are."""

from typing import Any

import matplotlib.pyplot as plt
import pytest
from gridded import GIVEN, SMALL
from made_runs import every_stage

from octsim.config.load import load_config
from octsim.figures.grid import figure_grid

WINDOWS = {"processing.window": ["hann", "hamming"]}


@pytest.mark.parametrize(
    ("grid", "lines"),
    [
        ({"scene.gap": ["5 nm", "20 nm"], **WINDOWS}, 2),
        ({"sweep.diameters.num": [5, 9, 3], **WINDOWS}, 2),
        ({"sweep.diameters.num": [5, 9, 3]}, 1),
        ({"combine": "zip", "sweep.diameters.num": [5, 9], **WINDOWS}, 1),
    ],
)
def test_it_has_a_line_for_each_combination_of_the_other_axes(
    grid: dict[str, Any], lines: int
) -> None:
    slopes = every_stage(load_config(SMALL, GIVEN, {"grid": grid}))["phase_slope"]
    figure = figure_grid(slopes)
    for panel in figure.axes:
        drawn = [line for line in panel.lines if len(line.get_xdata()) > 1]  # type: ignore[arg-type]
        assert len(drawn) == lines
    plt.close(figure)
