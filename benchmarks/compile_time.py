"""Processor time that compiling takes from nothing, in two checkouts of octsim, in one run.

    .venv/bin/python benchmarks/compile_time.py /some/older/checkout [rounds]

A process finds the light, spectra and paths of a few points by each scheme, which compiles all that
a run needs, in a copy of each checkout: first without compiled code, then with what that has left.
What it needs less then is compiling. Nothing is compiled when octsim is installed.
"""

import compileall
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from octsim.base.carried import PACKAGE

WORK = """
import octsim
for tracing in {"rays": 200}, {"preset": "draft"}:
    config = octsim.load_config({
        "tracing": tracing,
        "spectrum": {"samples": 100},
        "sweep": {
            "diameters": {"start": "1 um", "stop": "1.1 um", "num": 3},
            "focus": {"slope": 0.58, "intercept": "69 nm"},
        },
    })
    found = octsim.detections(config)
    octsim.spectra(config, found), octsim.light_paths(config, found)
"""


def seconds(checkout: Path) -> float:
    """Do the work in a checkout, with the libraries of this one's; return processor time, s."""
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [sys.executable, "-c", WORK], env=environment | {"PYTHONPATH": str(checkout)},
        cwd=checkout, check=True,
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def compiling(checkout: Path) -> float:
    """Return the processor time that compiling takes in a copy of a checkout, s."""
    with tempfile.TemporaryDirectory() as folder:
        package = PACKAGE.name
        shutil.copytree(
            checkout / package, Path(folder) / package,
            ignore=shutil.ignore_patterns("__pycache__"),
        )  # fmt: skip
        compileall.compile_dir(folder, quiet=1)  # byte code, which is no machine code
        seconds_first, seconds_again = (seconds(Path(folder)) for _ in range(2))
    print(f"{checkout}: {seconds_first:.1f} s, {seconds_again:.1f} s when all is compiled")
    return seconds_first - seconds_again


def main(older: Path, rounds: int = 1) -> None:
    """Print how much of the older checkout's time compiling takes in this one."""
    ratios = []
    for _ in range(rounds):
        before = compiling(older)
        ratios.append(compiling(PACKAGE.parent) / before)
    print(f"compiling takes {statistics.median(ratios):.3f} of what it took")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), *map(int, sys.argv[2:]))
