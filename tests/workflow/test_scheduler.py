"""What a run of many jobs asks of a cluster's scheduler, and what it leaves on a file system."""

import re
import sys
import time
from collections import Counter
from pathlib import Path
from subprocess import run
from typing import NamedTuple

import pytest
import yaml
from checkout import Checkout, scattered
from made_once import Once
from scheduler import asked, scheduler

pytest.importorskip("snakemake_executor_plugin_slurm", reason="it comes by `make slurm`")
SHARES = 40
INTERVAL = 3  # s, between two looks at the jobs
RESULTS = "results/scattered"


class Ran(NamedTuple):
    """A run, whose jobs nobody did, and what was asked for it."""

    folder: Path
    asked: list[list[str]]
    seconds: float

    def of(self, name: str) -> list[list[str]]:
        return [words for words in self.asked if words[0] == name]


@pytest.fixture(scope="module")
def ran(once: Once) -> Ran:
    return once.made("ran", ran_in)


def ran_in(place: Path) -> Ran:
    folder, commands = place / "run", place / "commands"
    for one in (folder, commands):
        one.mkdir()
    Checkout(folder)
    (folder / "mine.yaml").write_text(yaml.safe_dump(scattered(SHARES)), encoding="utf-8")
    command = [
        sys.executable, "-m", "snakemake", "--configfile", "mine.yaml", "--cores", "1", "--notemp",
        "--workflow-profile", "profiles/slurm", "--jobs", str(SHARES),
        "--slurm-init-seconds-before-status-checks", str(INTERVAL), f"{RESULTS}/detections.nc",
    ]  # fmt: skip
    begin = time.monotonic()
    done = run(
        command, cwd=folder, env=scheduler(commands, RESULTS),
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return Ran(folder, asked(commands), time.monotonic() - begin)


def test_each_job_is_submitted_once_and_what_gathers_them_comes_last(ran: Ran) -> None:
    targets = [re.findall(r"--target-jobs '(\S*)'", words[-1]) for words in ran.of("sbatch")]
    *shares, last = [target for (target,) in targets]
    assert sorted(shares) == sorted(
        f"share:stage=detections,number={number},of={SHARES}" for number in range(1, SHARES + 1)
    )
    assert last == "detections:"


def test_each_job_is_submitted_with_its_memory_and_its_time_on_one_core(ran: Ran) -> None:
    for words in ran.of("sbatch"):
        assert "--cpus-per-task=1" in words
        assert int(words[words.index("--mem") + 1]) > 600
        assert int(words[words.index("-t") + 1]) > 60


def test_all_jobs_are_asked_after_together_and_no_more_often_than_is_said(ran: Ran) -> None:
    looks = ran.of("squeue")
    assert len({tuple(words) for words in looks}) == 1  # of the run, not of a job
    assert 2 <= len(looks) <= ran.seconds / INTERVAL + 1


def test_whatever_else_is_asked_does_not_grow_with_the_jobs(ran: Ran) -> None:
    counts = Counter(words[0] for words in ran.asked)
    assert counts.pop("sbatch") == SHARES + 1
    looks = counts.pop("squeue")
    # for how long jobs are remembered, at each look, and three times at the start
    assert counts.pop("scontrol") <= looks + 3
    # the account and the partition, by the two that submit at first
    assert set(counts) == {"sacct", "sinfo"}
    assert max(counts.values()) <= 2


def test_a_share_leaves_itself_its_log_and_a_note_and_nothing_of_the_scheduler(ran: Ran) -> None:
    kept = Counter(
        str(path.parent.relative_to(ran.folder)) for path in ran.folder.rglob("*") if path.is_file()
    )
    assert {folder: count for folder, count in kept.items() if count >= SHARES} == {
        f"{RESULTS}/shares": SHARES,
        f"{RESULTS}/logs/shares": SHARES,
        ".snakemake/metadata": SHARES + 1,
    }
    assert not list((ran.folder / ".snakemake" / "slurm_logs").rglob("*"))
