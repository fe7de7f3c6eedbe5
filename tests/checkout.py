"""A checkout of the workflow in a folder of its own, and small configs for it."""

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import yaml

ROOT = Path(__file__).parents[1]
TINY: dict[str, Any] = {
    "run": "tiny",
    "tracing": {"rays": 200},
    "focus_scan": {"focus": {"num": 5}},
    "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
    "sweep": {"diameters": {"num": 9}},
}
DATASETS = ("--omit-from", "figures")
"""What asks snakemake for a whole run without its figures, which take about half of a small one."""
GIVEN = {"sweep": {"focus": {"slope": 0.58, "intercept": "69 nm"}}}


class Checkout:
    """A checkout of the workflow in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        shutil.copy(ROOT / "Snakefile", folder)
        for part in ("workflow", "profiles"):
            shutil.copytree(
                ROOT / part, folder / part, ignore=shutil.ignore_patterns("__pycache__")
            )

    def snakemake(
        self, overlay: dict[str, Any], *arguments: str
    ) -> subprocess.CompletedProcess[str]:
        file = self.folder / "mine.yaml"
        file.write_text(yaml.safe_dump(overlay), encoding="utf-8")
        command = [sys.executable, "-m", "snakemake", "--configfile", str(file), *arguments]
        return subprocess.run(
            command, cwd=self.folder, capture_output=True, text=True, check=False, env=os.environ
        )

    def run(self, overlay: dict[str, Any], *arguments: str) -> None:
        done = self.snakemake(overlay, *arguments)
        assert done.returncode == 0, done.stdout + done.stderr

    def would_run(self, overlay: dict[str, Any], *arguments: str) -> set[str]:
        """Rules that a run would execute now."""
        done = self.snakemake(overlay, "--dry-run", *arguments)
        assert done.returncode == 0, done.stdout + done.stderr
        if "Job stats:" not in done.stdout:
            return set()
        table = done.stdout.split("Job stats:")[1].split("total")[0].splitlines()[3:]
        return {line.split()[0] for line in table if line.strip()} - {"all"}

    def at_start(self, stage: str, statement: str) -> None:
        """Make a stage's job do something before its work."""
        script = self.folder / "workflow" / "scripts" / "job.py"
        name = "snakemake.wildcards.get('stage', Path(snakemake.log[0]).stem)"
        before, work = script.read_text().split("status = ask(task)")
        script.write_text(
            f"{before}if {name} == '{stage}':\n    import time; from octsim.cli import job\n"
            f"    job.end_with_the_run(Path(task['folder'])); {statement}\nstatus = ask(task){work}"
        )

    def results(self) -> dict[str, bytes]:
        folder = self.folder / "results"
        return {
            str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(folder.rglob("*"))
            if path.suffix in {".nc", ".png", ".svg", ".pdf", ".txt"}
        }

    def datasets(self) -> dict[str, bytes]:
        return {name: held for name, held in self.results().items() if name.endswith(".nc")}


class Finished(NamedTuple):
    """A run that was made from nothing to its end."""

    checkout: Checkout
    seconds: float
    """That it took."""

    def copy(self, folder: Path) -> Checkout:
        """Return a checkout of its own with what was made, and the times of its files."""
        checkout = Checkout(folder)
        for part in ("results", ".snakemake", ".octsim"):
            shutil.copytree(self.checkout.folder / part, folder / part)
        return checkout


def finished_in(folder: Path) -> Finished:
    """Run the small config to its end in a folder."""
    checkout, began = Checkout(folder), time.monotonic()
    checkout.run(TINY)
    return Finished(checkout, time.monotonic() - began)


def merged(*overlays: dict[str, Any]) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for overlay in overlays:
        for key, value in overlay.items():
            below = result.get(key)
            result[key] = (
                merged(below, value)
                if isinstance(below, dict) and isinstance(value, dict)
                else value
            )
    return result


def counts(checkout: Checkout, run: str) -> dict[str, dict[str, int]]:
    logs = checkout.folder / "results" / run / "logs"
    return {file.stem: json.loads(file.read_text()) for file in sorted(logs.glob("*.json"))}


GRID: dict[str, Any] = merged(
    TINY,
    GIVEN,
    {
        "run": "grid",
        "grid": {"scene.gap": ["5 nm", "20 nm"], "processing.window": ["hann", "hamming"]},
    },
)


def scattered(count: int) -> dict[str, Any]:
    """Give a config whose sweep is scattered over so many jobs, one for each combination."""
    gaps = {"start": "5 nm", "stop": "50 nm", "num": count}
    few = {"sweep": {"diameters": {"num": 2}}, "scatter": {"minutes": 1e-6}}
    return merged(TINY, GIVEN, few, {"run": "scattered", "grid": {"scene.gap": gaps}})
