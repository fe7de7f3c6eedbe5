"""Two runs in one figure: their entries stand side by side, with or without marks."""

import pytest
import xarray as xr

from octsim.datasets.files import flags
from octsim.figures.compare import figure_compare
from octsim.phase.fringe_status import FringeStatus


@pytest.mark.parametrize("doubted", [(), (0,), (1,)])
def test_each_run_has_a_column_of_the_legend_and_marks_stand_below(
    doubted: tuple[int, ...], stages: dict[str, xr.Dataset]
) -> None:
    slopes = [stages["phase_slope"].copy(deep=True) for _ in range(2)]
    for number in doubted:
        status = slopes[number]["fringe_status"].values.copy()
        status[2] = FringeStatus.POOR_FIT
        values, attributes = flags(FringeStatus, status)
        slopes[number]["fringe_status"] = "diameter", values, attributes
    figure = figure_compare((slopes[0], slopes[1]), ("one", "two"))
    said = [text.get_text() for text in figure.legends[0].get_texts()]
    half = len(said) // 2
    assert len(said) == 2 * half
    assert said[0] == "one"
    assert said[half] == "two"
    assert ("doubtful: poor fit" in said) == bool(doubted)
