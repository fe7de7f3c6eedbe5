"""A run that is told to stop ends with one line, leaves no process and loses nothing."""

import os
import re
import signal
import sys
import time
from pathlib import Path

import pytest
import yaml
from checkout import DATASETS, ROOT, TINY, Checkout, Finished
from terminal import Terminal, processes_in

LINE = "octsim: stopped; run the same command again to go on"
RUN = [sys.executable, "-m", "octsim", "run", "mine.yaml"]
SNAKEMAKE = [sys.executable, "-m", "snakemake", "--configfile", "mine.yaml"]
MAKE = ["make", "-o", ".venv/run", "results", "CONFIG=mine.yaml"]
# once the job that writes it has begun, the first of them while it compiles
BEGIN, SCAN, SWEEP, DRAW = (
    ".snakemake", "logs/focus_scan.log", "logs/detections.log", "logs/figures.log",
)  # fmt: skip


def checkout_in(folder: Path) -> Checkout:
    (folder / "mine.yaml").write_text(yaml.safe_dump(TINY))
    for file in ("Makefile", "requirements.lock", "pyproject.toml"):
        (folder / file).symlink_to(ROOT / file)
    (folder / ".venv").symlink_to(sys.prefix)
    return Checkout(folder)


def stopped_at(
    moment: str, command: list[str], folder: Path, number: signal.Signals
) -> tuple[list[str], int]:
    """Stop a run once a file is there; give its screen and status."""
    # of the job that compiles no code is there
    code = str(folder / "code") if "focus_scan" in moment else os.environ.get("NUMBA_CACHE_DIR", "")
    terminal = Terminal(command, folder, NUMBA_CACHE_DIR=code)
    file = folder / ("results/tiny" if "/" in moment else "") / moment
    assert not file.exists()
    terminal.until(file.exists)
    if number == signal.SIGINT:
        terminal.press_ctrl_c()
    else:
        terminal.kill(number)
    status = terminal.status()
    while processes_in(folder):  # jobs of a bare snakemake look for it ten times a second
        time.sleep(0.05)
    return terminal.screen(), status


# a bare snakemake that is just being loaded has no code of octsim's yet
@pytest.mark.parametrize(
    ("command", "number", "moments"),
    [
        (RUN, signal.SIGINT, (BEGIN, SCAN, SWEEP, DRAW)),
        pytest.param(RUN, signal.SIGTERM, (BEGIN, SCAN), marks=pytest.mark.trial),
        pytest.param(SNAKEMAKE, signal.SIGINT, (SCAN, SWEEP), marks=pytest.mark.trial),
        pytest.param(SNAKEMAKE, signal.SIGTERM, (DRAW,), marks=pytest.mark.trial),
        pytest.param(MAKE, signal.SIGINT, (BEGIN, SWEEP), marks=pytest.mark.trial),
    ],
    ids=["run-INT", "run-TERM", "snakemake-INT", "snakemake-TERM", "make-INT"],
)
def test_a_run_stopped_again_and_again_says_one_line_each_time_and_comes_to_the_same_bits(
    command: list[str],
    number: signal.Signals,
    moments: tuple[str, ...],
    finished: Finished,
    tmp_path: Path,
) -> None:
    checkout = checkout_in(tmp_path)
    for moment in moments:
        screen, status = stopped_at(moment, command, tmp_path, number)
        text = "\n".join(screen)
        assert "Traceback" not in text
        assert text.count("octsim: stopped") == 1
        assert [line.removeprefix("^C") for line in screen][-1 - (command is MAKE)].endswith(LINE)
        if command is MAKE:
            assert re.match(r"make(\[\d+\])?: \*\*\* \[", screen[-1])  # within another make too
        else:
            assert status == 128 + number
    drawn = DRAW in moments
    checkout.run(TINY, *(() if drawn else DATASETS))
    assert checkout.datasets() == finished.checkout.datasets()
    if drawn:
        assert checkout.results() == finished.checkout.results()


def test_a_run_whose_command_is_killed_ends_too(tmp_path: Path) -> None:
    checkout_in(tmp_path)
    terminal = Terminal(RUN, tmp_path)
    terminal.until((tmp_path / "results" / "tiny" / "logs" / "focus_scan.log").exists)
    terminal.kill(signal.SIGKILL)
    assert terminal.status() == 128 + signal.SIGKILL
    while processes_in(tmp_path):
        time.sleep(0.05)


def test_make_that_is_told_to_end_ends_the_run(tmp_path: Path) -> None:
    checkout_in(tmp_path)
    terminal = Terminal(MAKE, tmp_path)
    terminal.until((tmp_path / "results" / "tiny" / "logs" / "focus_scan.log").exists)
    terminal.kill(signal.SIGTERM)
    assert terminal.status() == 128 + signal.SIGTERM
    while processes_in(tmp_path):
        time.sleep(0.05)
    assert "\n".join(terminal.screen()).count(LINE) == 1


def test_a_run_goes_on_where_signals_are_to_be_ignored(tmp_path: Path) -> None:
    checkout_in(tmp_path)
    terminal = Terminal(
        ["sh", "-c", 'trap "" HUP; exec "$0" "$@"', *RUN, "results/tiny/focus_scan.nc"], tmp_path
    )
    terminal.until((tmp_path / "results" / "tiny" / "logs" / "focus_scan.log").exists)
    terminal.kill(signal.SIGHUP)
    assert terminal.status() == 0
    assert (tmp_path / "results" / "tiny" / "focus_scan.nc").is_file()


def test_a_stopped_run_leaves_no_temporary_files(tmp_path: Path) -> None:
    checkout_in(tmp_path)
    temporary = tmp_path / "tmp"
    temporary.mkdir()
    terminal = Terminal(RUN, tmp_path, TMPDIR=str(temporary))
    terminal.until((tmp_path / "results" / "tiny" / "logs" / "focus_scan.log").exists)
    assert list(temporary.iterdir())
    terminal.press_ctrl_c()
    assert terminal.status() == 130
    assert not list(temporary.iterdir())
