"""Targets beside a run."""

from collections.abc import Callable
from pathlib import Path

from octsim.datasets.catalog import CATALOG, TARGETS


def test_targets_have_their_names_and_are_no_part_of_a_run(
    planned: Callable[..., str], tmp_path: Path
) -> None:
    (tmp_path / "phases.csv").write_text("time,phase\n0,0\n", encoding="utf-8")
    (tmp_path / "mine.yaml").write_text("expansion: {series: phases.csv}\n", encoding="utf-8")
    asked, run = planned(*TARGETS, "--configfile", "mine.yaml"), planned()
    for name in TARGETS:
        assert CATALOG[name].message in asked
        assert CATALOG[name].message not in run


def test_a_report_is_asked_for_by_its_name_and_is_no_part_of_a_run(
    planned: Callable[..., str],
) -> None:
    assert "Write the report" in planned("report")
    assert "Write the report" not in planned()


def test_an_animation_is_asked_for_by_its_name_and_is_no_part_of_a_run(
    planned: Callable[..., str],
) -> None:
    assert "Animate the focus scan" in planned("animation")
    assert "Animate the focus scan" not in planned()
