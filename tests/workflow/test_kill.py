"""Nothing is lost: killed at any moment, a run goes on where it stopped, to the same bits."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import yaml
from checkout import DATASETS, TINY, Checkout, Finished
from trials import trials

KILLS = int(os.environ.get("OCTSIM_KILLS", "4"))
COMMAND = [sys.executable, "-m", "snakemake", "--configfile", "mine.yaml"]


def start(checkout: Checkout, *arguments: str) -> subprocess.Popen[bytes]:
    (checkout.folder / "mine.yaml").write_text(yaml.safe_dump(TINY))
    return subprocess.Popen(
        [*COMMAND, *arguments], cwd=checkout.folder, start_new_session=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip


@pytest.mark.parametrize("seed", [0, *trials(*range(1, KILLS))])
def test_a_killed_run_resumes_to_the_same_bits(
    seed: int, finished: Finished, tmp_path: Path
) -> None:
    draw = random.Random(seed)
    checkout = Checkout(tmp_path)
    # figures too, each fourth time
    asked, part = ((), 1.0) if seed % 4 == 3 else (DATASETS, 0.5)
    running = start(checkout, *asked)
    time.sleep(draw.uniform(0.1, part) * finished.seconds)
    if draw.random() < 0.5:
        running.kill()  # the jobs are left alone, and must end by themselves
    else:
        os.killpg(running.pid, signal.SIGKILL)
    running.wait()
    checkout.run(TINY, *asked)
    assert checkout.datasets() == finished.checkout.datasets()
    if not asked:
        assert checkout.results() == finished.checkout.results()
    hidden = [p for p in (tmp_path / "results").rglob(".*") if p.name != ".lock"]
    assert len(hidden) <= 1  # at most the unfinished file of the moment


def test_a_second_run_of_the_same_name_is_refused_and_another_is_not(tmp_path: Path) -> None:
    checkout, one = Checkout(tmp_path), "focus_scan"
    waits, goes_on = tmp_path / "waits", tmp_path / "goes_on"
    checkout.at_start(
        one,
        "goes_on = lambda: 'tiny' not in snakemake.output[0] or Path('goes_on').exists()\n"
        "    Path('waits').touch(); [time.sleep(0.1) for _ in iter(goes_on, True)]",
    )
    first = start(checkout, "--until", one)
    while not waits.exists() and first.poll() is None:
        time.sleep(0.02)
    second = checkout.snakemake(TINY, "--until", one)
    other = checkout.snakemake({**TINY, "run": "other"}, "--until", one)
    goes_on.touch()
    assert first.wait() == 0
    assert second.returncode != 0
    assert "octsim: another run is at work on results/tiny" in second.stderr
    assert other.returncode == 0, other.stderr
    assert set(checkout.results()) == {"tiny/focus_scan.nc", "other/focus_scan.nc"}


def test_a_results_folder_that_is_none_is_one_line(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    (tmp_path / "results").write_text("mine")
    done = checkout.snakemake(TINY)
    assert done.returncode != 0
    assert "octsim: results/tiny: can't be a folder, as results is a file" in done.stderr
    assert "Traceback" not in done.stderr
    assert (tmp_path / "results").read_text() == "mine"


@pytest.mark.parametrize("damage", ["truncated", *trials("foreign")])
def test_a_damaged_dataset_stops_what_reads_it_and_stays(
    damage: str, finished: Finished, tmp_path: Path
) -> None:
    checkout = finished.copy(tmp_path)
    file = tmp_path / "results" / "tiny" / "spectra.nc"
    bad = file.read_bytes()[:1000] if damage == "truncated" else b"somebody's notes"
    time.sleep(0.05)
    file.write_bytes(bad)
    done = checkout.snakemake(TINY)
    assert done.returncode != 0
    assert "octsim: results/tiny/spectra.nc: can't be read" in done.stderr
    assert "move it away and run again" in done.stderr
    assert "Traceback" not in done.stderr
    assert file.read_bytes() == bad
    file.rename(tmp_path / "away.nc")
    checkout.run(TINY, *DATASETS)
    assert checkout.datasets() == finished.checkout.datasets()
