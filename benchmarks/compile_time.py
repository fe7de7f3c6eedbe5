"""Processor time that compiling takes from nothing, in two checkouts of octsim, in one run.

    .venv/bin/python benchmarks/compile_time.py /some/older/checkout [cores]

Small runs of each scheme are made in a copy of each checkout: first without compiled code, then
with what that has left. What the second needs less is compiling, wherever a run does it; nothing
is compiled when octsim is installed.
"""

import os
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import yaml

from octsim.base.provenance import PACKAGE

SMALL: dict[str, Any] = {
    "tracing": {"rays": 200},
    "spectrum": {"samples": 100},
    "focus_scan": {"focus": {"num": 5}},
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
    "sweep": {"diameters": {"num": 9}, "focus": {"slope": 0.58, "intercept": "69 nm"}},
}
RUNS = {"vogel": SMALL, "paths": SMALL | {"tracing": {"preset": "draft"}}}
PARTS = ("octsim", "config", "profiles", "workflow")


def copied(checkout: Path, folder: Path) -> Path:
    """Copy what runs of a checkout, without what it has compiled."""
    for part in PARTS:
        shutil.copytree(
            checkout / part, folder / part, ignore=shutil.ignore_patterns("__pycache__")
        )
    shutil.copy(checkout / "Snakefile", folder)
    return folder


def seconds(checkout: Path, folder: Path, cores: str) -> float:
    """Make the runs in a folder; return the processor time of all processes, s."""
    folder.mkdir()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    for name, config in RUNS.items():
        (folder / f"{name}.yaml").write_text(yaml.safe_dump({"run": name, **config}))
        command = [
            sys.executable, "-m", "snakemake", "--snakefile", str(checkout / "Snakefile"),
            "--workflow-profile", str(checkout / "profiles" / "default"), "--cores", cores,
            "--configfile", f"{name}.yaml",
        ]  # fmt: skip
        environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
        done = subprocess.run(
            command, cwd=folder, env=environment | {"PYTHONPATH": str(checkout)},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode != 0:
            sys.exit(f"{checkout}: the run {name} failed\n{done.stdout}{done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(older: Path, cores: str = "2") -> None:
    """Print what compiling takes in both."""
    compiling = {}
    with tempfile.TemporaryDirectory() as temporary:
        for name, checkout in (("older", older), ("this", PACKAGE.parent)):
            copy = copied(checkout, Path(temporary) / name)
            first, again = (seconds(copy, copy / run, cores) for run in ("first", "again"))
            compiling[name] = first - again
            print(f"{name}: {first:.1f} s of processor time, {again:.1f} s when compiled")
    print(f"compiling: {compiling['this'] / compiling['older']:.3f} of the older checkout's time")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), *sys.argv[2:])
