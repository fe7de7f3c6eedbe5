"""How far a long walk is, is shown on a terminal or by the run; a short one says nothing."""

import gc
import sys
from pathlib import Path

import pytest

from octsim.base import say, waiting
from octsim.base.waiting import bar, uncollected, watched

CODE = """
import sys
from octsim.base import waiting
waiting._LONG, waiting._BETWEEN = float(sys.argv[1]), 0.0
for _ in waiting.watched(range(200), 200, "looking"):
    pass
print("end", file=sys.stderr)
"""


@pytest.mark.parametrize(("long", "shown"), [(0.0, True), (1e9, False)])
def test_a_terminal_shows_a_bar_where_it_takes_long_and_none_is_left(
    long: float, shown: bool, tmp_path: Path
) -> None:
    from terminal import Terminal

    terminal = Terminal([sys.executable, "-c", CODE, str(long)], tmp_path)
    assert terminal.status() == 0
    assert ("octsim: looking: [######--------------] 64 of 200" in terminal.written) == shown
    assert terminal.screen() == ["end"]


def test_a_run_is_told_of_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(say.PROGRESS, str(tmp_path))
    monkeypatch.setattr(say._Job, "name", "reading")
    monkeypatch.setattr(waiting, "_LONG", 0.0)
    monkeypatch.setattr(waiting, "_BETWEEN", 0.0)
    walk = watched(range(200), 200, "looking")
    for thing in walk:
        if thing == 64:
            break
    assert (tmp_path / "reading").read_text() == f"looking: {bar(64, 200)}"


def test_all_things_are_walked_through_in_their_order() -> None:
    assert list(watched("abc", 3, "looking")) == ["a", "b", "c"]


def test_cycles_are_looked_for_again_afterwards() -> None:
    assert gc.isenabled()
    with uncollected():
        assert not gc.isenabled()
    assert gc.isenabled()
    gc.disable()
    try:
        with uncollected():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()
