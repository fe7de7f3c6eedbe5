"""Captions: a text beside each figure says what it shows, of which run and from which datasets."""

import json
from pathlib import Path

import pytest
import xarray as xr
from made_runs import WHOLE

import octsim
from octsim.config.processing import Processing
from octsim.datasets.files import write
from octsim.datasets.gallery import CAPTIONS, FORMS, all_run_figures
from octsim.figures.caption import caption_of
from octsim.figures.draw import draw, figure_of
from octsim.figures.style import look

FIGURES = all_run_figures()
CONFIG = octsim.load_config(WHOLE)


@pytest.mark.parametrize("name", sorted(set(FIGURES) - {"grid"}))
def test_a_caption_says_what_is_shown_and_all_that_legend_and_notes_say(
    name: str, stages: dict[str, xr.Dataset]
) -> None:
    dark = {"focus_scan": {"intensity": 0 * stages["focus_scan"]["intensity"]}}
    given = stages | {one: stages[one].assign(other) for one, other in dark.items()}
    with look():
        figure = figure_of(FIGURES[name], given, Processing())
    said = caption_of(FIGURES[name], figure, CONFIG)
    shows = CAPTIONS[name]
    assert said.startswith(f"{shows[:1].upper()}{shows[1:]}.\n\nRun whole")
    for source in FIGURES[name].sources:
        assert f"{source}.nc" in said
    legends = [*figure.legends, *(axes.get_legend() for axes in figure.axes)]
    for text in (text for legend in legends if legend for text in legend.get_texts()):
        assert text.get_text() in said
    if name == "figure_6":
        assert "no light at any focus" in said
    assert said.endswith("\n")


def test_every_figure_is_drawn_in_all_forms_with_the_caption_beside_it(
    stages: dict[str, xr.Dataset], tmp_path: Path
) -> None:
    scan, config = tmp_path / "focus_scan.nc", octsim.load_config(WHOLE)
    write(stages["focus_scan"], scan)
    chosen = {name: FIGURES[name] for name in ("figure_1", "figure_6")}
    draw(chosen, {"focus_scan": scan}, tmp_path / "figures", config)
    made = sorted(file.name for file in (tmp_path / "figures").iterdir())
    assert made == sorted(f"{name}.{form}" for name in chosen for form in FORMS)
    text = (tmp_path / "figures" / "figure_6.txt").read_text(encoding="utf-8")
    assert CAPTIONS["figure_6"][1:] in text
    assert f"Run {json.loads(stages['focus_scan'].attrs['config'])['run']}" in text
