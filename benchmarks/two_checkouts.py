"""Whether two checkouts of octsim give the same numbers: same configs, run in both, and compared.

    .venv/bin/python benchmarks/two_checkouts.py /some/older/checkout [case ...]

Each case is a config and its targets; the datasets that the older checkout makes of it are compared
by `octsim compare` of this one, with no tolerance at all. Clocks and memory are not judged.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from octsim.archive.compare import compare
from octsim.archive.compare_text import lines
from octsim.base.carried import PACKAGE

PATHS = {"tracing": {"preset": "standard"}}
SMALL: dict[str, Any] = {
    "tracing": {"rays": 300},
    "focus_scan": {"focus": {"num": 11}},
    "focus_law": {"diameters": {"num": 4}, "fraction": {"num": 15}},
    "sweep": {"diameters": {"num": 16}},
    "calibration": {"diameters": {"num": 8}},
}
KEYS: dict[str, Any] = {
    "scene.gap": ["0 nm", "5 nm", "20 nm"],
    "tracing.scheme": ["vogel", "paths", "vogel"],
    "processing.estimator": ["fft", "sinusoid", "esprit"],
}
BESIDE = ("calibration", "action_potential", "causes", "estimators")
CASES: Mapping[str, tuple[Mapping[str, Any], tuple[str, ...]]] = {
    "thesis": ({}, ("all", "calibration")),
    "paths": (PATHS, ("all",)),
    "product": (
        SMALL | {"grid": {"scene.gap": ["0 nm", "5 nm"], "processing.window": ["hann", "hamming"]}},
        ("all",),
    ),
    "zip": (SMALL | {"grid": {**KEYS, "combine": "zip"}}, ("all",)),
    "beside": (SMALL, BESIDE),
    "beside_paths": (SMALL | {"tracing": {"preset": "draft"}}, ("calibration", "causes")),
    "tradeoff": (SMALL, ("tradeoff",)),
    "stability": (SMALL, ("stability",)),
}
"""Config and targets of each case."""


def run(checkout: Path, folder: Path, name: str) -> Path:
    """Run a case in a checkout, with the libraries of this one's environment."""
    overlay, targets = CASES[name]
    folder.mkdir(parents=True)
    (folder / "case.yaml").write_text(yaml.safe_dump({"run": name, **overlay}), encoding="utf-8")
    command = [
        sys.executable, "-m", "snakemake", *targets, "--snakefile", str(checkout / "Snakefile"),
        "--workflow-profile", str(checkout / "profiles" / "default"), "--cores", "2",
        "--configfile", "case.yaml",
    ]  # fmt: skip
    environment = os.environ | {"PYTHONPATH": str(checkout)}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        sys.exit(f"{checkout}: the case {name} failed\n{done.stdout}{done.stderr}")
    return folder / "results" / name


def main(older: Path, names: list[str]) -> int:
    """Compare the cases; return 1 if any number differs."""
    differs = 0
    with tempfile.TemporaryDirectory() as temporary:
        for name in names or CASES:
            places = Path(temporary) / "older" / name, Path(temporary) / "newer" / name
            then = run(older, places[0], name)
            found = compare(then, run(PACKAGE.parent, places[1], name), 0.0)
            # another code is no difference by itself
            told = [line for line in lines(found) if "source_digest" not in line]
            print(f"== {name}: {'DIFFERENT' if found.differs else 'the same'}", *told, sep="\n")
            differs |= int(found.differs)
    return differs


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), sys.argv[2:]))
