"""The soak draws the same for a seed, notices what is wrong, and says what it found."""

from pathlib import Path
from random import Random
from signal import SIGINT, SIGKILL, SIGTERM, Signals

import pytest
from soak.__main__ import one_round
from soak.drawn import drawn
from soak.page import Found
from soak.runs import Run, Seen, Stop, differing, moments

LINE = "octsim: stopped; run the same command again to go on"


def test_of_a_seed_the_same_is_drawn_and_every_kind_of_run_comes() -> None:
    every = [drawn(Random(f"octsim {number}")) for number in range(40)]
    assert every == [drawn(Random(f"octsim {number}")) for number in range(40)]
    schemes = {one.overlay["tracing"]["scheme"] for one in every}
    assert schemes == {"vogel", "paths", "fullwave"}
    for kinds in (
        {"grid" in one.overlay for one in every},
        {one.scattered for one in every},
        {one.targets == () for one in every},
    ):
        assert kinds == {True, False}


def test_each_signal_comes_as_often_as_the_others() -> None:
    drawing = moments(Random(1), 5.0)
    numbers = [next(drawing)[0] for _ in range(30)]
    assert {number: numbers.count(number) for number in (SIGKILL, SIGINT, SIGTERM)} == {
        SIGKILL: 10, SIGINT: 10, SIGTERM: 10,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("number", "status", "screen", "wrong"),
    [
        (SIGINT, 130, ["octsim: x", LINE], ""),
        (SIGTERM, 143, [LINE], ""),
        (SIGKILL, 137, ["octsim: x"], ""),
        (SIGINT, 0, ["octsim: done"], ""),
        (SIGINT, 130, [LINE, LINE], "2 lines that say stopped"),
        (SIGTERM, 143, ["octsim: x"], "0 lines that say stopped"),
        (SIGINT, 0, [LINE], "1 lines that say stopped"),
        (SIGTERM, 1, [LINE], "status 1"),
        (SIGKILL, 137, ["Traceback (most recent call last):"], "Traceback"),
        (SIGINT, 130, ["Traceback (most recent call last):", LINE], "Traceback"),
    ],
)
def test_a_stop_is_wrong_by_its_status_its_lines_or_a_traceback(
    number: Signals, status: int, screen: list[str], wrong: str
) -> None:
    said = Stop(number, Seen(status, screen), 0.1).wrong
    assert said.startswith(wrong)
    assert bool(said) == bool(wrong)


def test_a_file_that_differs_is_missing_or_is_one_too_many_is_named() -> None:
    right = {"a.nc": b"1", "b.nc": b"2", "c.nc": b"3"}
    assert differing(right, right) == []
    assert differing({"a.nc": b"1", "b.nc": b"x", "d.nc": b""}, right) == ["b.nc", "c.nc", "d.nc"]


def test_what_was_found_is_told_with_its_numbers() -> None:
    found = Found("mine", configs=3, schemes={"vogel": 3}, stops={"SIGINT": 7, "SIGKILL": 8})
    found.longest["SIGINT"] = 1.25
    text = "\n".join(found.lines())
    assert "seed `mine`" in text
    assert "| SIGINT | 7 | 1.25 s |" in text
    assert "| SIGKILL | 8 |  |" in text
    assert "nothing was other than it should be" in text
    found.wrong.append("config 2: b.nc")
    assert "1 were not as they should be: config 2: b.nc" in "\n".join(found.lines())


@pytest.mark.trial
def test_a_round_without_a_fault_of_the_packages_finds_none(tmp_path: Path) -> None:
    found = Found("octsim")
    one_round(tmp_path, Random("octsim 4"), 6, found)
    assert found.wrong == []
    assert (found.configs, found.together) == (1, 1)
    assert found.compared == 3


@pytest.mark.trial
def test_a_round_whose_results_are_changed_behind_its_back_is_noticed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    results = Run.results

    def changed(run: Run) -> dict[str, bytes]:
        found = results(run)
        return found if run.folder.name == "whole" else {**found, "soak/spectra.nc": b""}

    monkeypatch.setattr(Run, "results", changed)
    found = Found("octsim")
    one_round(tmp_path, Random("octsim 4"), 1, found)
    assert found.wrong == ["config 1, the same command again: soak/spectra.nc"]
