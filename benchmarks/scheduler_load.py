"""What a run of many jobs asks of a cluster's scheduler, and what it takes to submit them.

Run by `make bench-scheduler`, which writes docs/cluster.md; minutes. The scheduler's commands are
stand-ins (tests/scheduler.py): a job is accepted, not run, and told of as completed at once.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import yaml
from marked import write_part

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from checkout import Checkout, scattered  # noqa: E402
from scheduler import asked, scheduler, times_of  # noqa: E402

AT_A_TIME = 400
RESULTS = Path("results", "scattered")


class Took(NamedTuple):
    """What a run of so many shares took."""

    wall: float
    """s."""
    planned: float
    """s, until the first job was submitted."""
    apart: float
    """s, from one job to the next while jobs are submitted: the median."""
    processor: float
    """s, of snakemake and of all the stand-ins."""
    megabytes: float
    """Largest memory of snakemake."""
    asked: Counter[str]
    """How often, of each command."""
    files: int
    """That are left until shares are gathered."""


def measured(shares: int, folder: Path) -> Took:
    """Let a run of so many shares be submitted."""
    checkout, commands = folder / "checkout", folder / "commands"
    for made in (checkout, commands):
        made.mkdir()
    Checkout(checkout)
    (checkout / "mine.yaml").write_text(yaml.safe_dump(scattered(shares)), encoding="utf-8")
    command = [
        sys.executable, "-m", "snakemake", "--configfile", "mine.yaml", "--cores", "4", "--notemp",
        "--workflow-profile", "profiles/slurm", "--jobs", str(AT_A_TIME),
        str(RESULTS / "detections.nc"),
    ]  # fmt: skip
    before = {file for file in checkout.rglob("*") if file.is_file()}
    begin = time.time()
    running = subprocess.Popen(
        command, cwd=checkout, env=scheduler(commands, str(RESULTS)),
        stdout=subprocess.DEVNULL, stderr=(folder / "said").open("w"),
    )  # fmt: skip
    _, status, used = os.wait4(running.pid, 0)
    wall = time.time() - begin
    if status:
        sys.exit((folder / "said").read_text()[-2000:])
    submitted = times_of(commands)
    steps = sorted(later - one for one, later in pairwise(submitted))
    left = {file for file in checkout.rglob("*") if file.is_file()} - before
    return Took(
        wall, submitted[0] - begin, steps[len(steps) // 2], used.ru_utime + used.ru_stime,
        used.ru_maxrss / 1024, Counter(words[0] for words in asked(commands)), len(left),
    )  # fmt: skip


def lines(found: dict[int, Took]) -> list[str]:
    """Return the part's lines: a table, and what is the same for all jobs."""
    told = [
        "| shares | until the first is submitted | from each to the next | whole run | "
        "snakemake's memory | `sbatch` | `squeue` | `scontrol` | files, until they are gathered |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for shares, took in found.items():
        told.append(
            f"| {shares:,} | {took.planned:.0f} s | {1e3 * took.apart:.0f} ms | "
            f"{took.wall:.0f} s | {took.megabytes:.0f} MiB | {took.asked['sbatch']:,} | "
            f"{took.asked['squeue']} | {took.asked['scontrol']} | {took.files:,} |"
        )
    most = max(
        60 * (took.asked["squeue"] + took.asked["scontrol"]) / took.wall for took in found.values()
    )
    last = found[max(found)]
    each = 1e3 * last.processor / last.asked["sbatch"]
    told += [
        "",
        f"`squeue` and `scontrol` are asked {most:.0f} times a minute at most, whatever the number "
        f"of jobs. Of {max(found):,} shares each takes {each:.0f} ms of processor time, the "
        "stand-ins' own included.",
    ]
    return told


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__, prog="scheduler_load.py")
    parser.add_argument("shares", type=int, nargs="*", default=[100, 1000, 10_000])
    parser.add_argument("--write", action="store_true", help="write docs/cluster.md")
    given = parser.parse_args()
    found = {}
    for shares in given.shares:
        with tempfile.TemporaryDirectory() as folder:
            found[shares] = measured(shares, Path(folder))
        print(shares, found[shares], flush=True)
    print(*lines(found), sep="\n")
    if given.write:
        write_part(ROOT / "docs" / "cluster.md", "scheduler", lines(found))


if __name__ == "__main__":
    main()
