"""What Slurm adds to each job of a small run, on a private Slurm of one node: `make bench-slurm`.

A job is a snakemake that Slurm starts; in it srun, in that another snakemake, in that the script.
"""

import csv
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from checkout import TINY, Checkout  # noqa: E402
from cluster import cluster  # noqa: E402

WAIT = int(sys.argv[1]) if len(sys.argv) > 1 else 10  # s until Slurm is asked first
PARTS = ("queued", "outer snakemake", "inner snakemake", "script", "unnoticed", "overhead")


def run(checkout: Checkout) -> dict[str, dict[str, float]]:
    """Give the seconds of each part of each job, by rule."""
    (checkout.folder / "mine.yaml").write_text(yaml.safe_dump(TINY), encoding="utf-8")
    command = [
        sys.executable, "-m", "snakemake", "--configfile", "mine.yaml", "--cores", "2",
        "--workflow-profile", "profiles/slurm", "--slurm-keep-successful-logs", "--verbose",
        "--slurm-init-seconds-before-status-checks", str(WAIT),
    ]  # fmt: skip
    submitted: dict[str, tuple[float, Path]] = {}
    noticed: dict[str, float] = {}
    with (
        cluster() as slurm,
        subprocess.Popen(
            command, cwd=checkout.folder, env=slurm.environment, text=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        ) as running,
    ):  # fmt: skip
        assert running.stderr is not None
        for line in running.stderr:
            if found := re.search(r"\(log: (.*/rule_(\w+)/.*\.log)\)", line):
                submitted[found[2]] = time.time(), Path(found[1])
            elif found := re.search(r"Finished jobid: \d+ \(Rule: (\w+)\)", line):
                noticed[found[1]] = time.time()
    if running.returncode != 0:
        sys.exit(f"snakemake failed; its logs are in {checkout.folder}")
    return {
        rule: parts(checkout, rule, began, log, noticed[rule])
        for rule, (began, log) in submitted.items()
    }


def parts(
    checkout: Checkout, rule: str, began: float, log: Path, noticed: float
) -> dict[str, float]:
    """Take one job's time apart."""
    birth = subprocess.run(["stat", "--format=%.3W", log], capture_output=True, check=True)
    started, ended = float(birth.stdout), log.stat().st_mtime
    inner = re.findall(r"Elapsed time: (\d+):(\d+):([\d.]+)", log.read_text())[0]
    elapsed = 3600 * int(inner[0]) + 60 * int(inner[1]) + float(inner[2])
    table = checkout.folder / "results" / "tiny" / "benchmarks" / f"{rule}.tsv"
    script = float(next(csv.DictReader(table.open(), delimiter="\t"))["s"])
    return dict(
        zip(
            PARTS,
            (
                started - began, ended - started - elapsed, elapsed - script, script,
                noticed - ended, noticed - began - script,
            ),
            strict=True,
        )
    )  # fmt: skip


def main() -> None:
    """Print a line a job and the medians."""
    with tempfile.TemporaryDirectory() as folder:
        jobs = run(Checkout(Path(folder)))
    print(f"seconds; Slurm is asked after {WAIT} s, then each time 10 s later than before")
    print(f"{'':12}" + "".join(f"{part:>17}" for part in PARTS))
    medians = {part: statistics.median(job[part] for job in jobs.values()) for part in PARTS}
    for name, job in {**jobs, "median": medians}.items():
        print(f"{name:12}" + "".join(f"{job[part]:17.2f}" for part in PARTS))


if __name__ == "__main__":
    main()
