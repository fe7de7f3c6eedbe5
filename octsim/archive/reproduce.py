"""Make anew, in another folder, what a run, an archive or one dataset records.

What is recorded is read as data alone: its config is checked as a user's is, the commands are this
checkout's, and all that is written stands in the folder.
"""

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from octsim.archive.recorded import Recorded
from octsim.archive.run_folder import run_in
from octsim.base.carried import workflow_folder
from octsim.base.errors import DatasetError, OctsimError
from octsim.base.files import require_empty, require_folder, whole
from octsim.base.say import WORDS
from octsim.config.load import load_config
from octsim.config.models import Cache, Measured
from octsim.config.resources import Budget, Scatter
from octsim.datasets.files import read, write
from octsim.studies.calibration.expansion_record import series_in

SERIES = "series.nc"
"""A measured series that an expansion was made from, in the folder."""
_OF_FILES = ("measured", "expansion", "match")
"""Datasets that are made from a lab's own spectra, where a config names some."""
LOG = "snakemake.log"


def chosen(original: Recorded, only: Sequence[str] | None) -> Recorded:
    """Return what is recorded, with some of its datasets only.

    Raises
    ------
    DatasetError
        If one of them is not there.
    """
    lacking = [stage for stage in only or () if stage not in original.datasets]
    if lacking:
        there = ", ".join(original.datasets)
        raise DatasetError(f"--only: {', '.join(lacking)} given, but there is {there}")
    kept = {s: file for s, file in original.datasets.items() if only is None or s in only}
    return original._replace(datasets=kept)


def reproduce(
    original: Recorded, folder: Path, cores: int, budget: Budget | None = None
) -> Recorded:
    """Make the datasets that are recorded anew in a folder, from their config alone.

    Parameters
    ----------
    original : Recorded
        What is recorded.
    folder : path
        Where to; absolute, and empty, not there yet, or one where the same was interrupted.
    cores : int
        For the workflow, 1 or more.
    budget : Budget, optional
        What it may take; by default that of a config that says nothing, whatever is recorded.

    Raises
    ------
    OctsimError
        If the config is refused, something that it needs is not recorded, or the run fails.
    """
    _require_recorded(original)
    config = _harmless(original, budget or Budget())
    load_config(config)
    expansion = original.datasets.get("expansion")
    series = _series(expansion) if expansion else None
    require_folder(folder)
    file, text = folder / "config.json", json.dumps(config, indent=1) + "\n"
    if not (file.is_file() and _goes_on(file.read_text(encoding="utf-8"), config)):
        require_empty(folder)
    with whole(file) as partial:
        partial.write_text(text, encoding="utf-8")
    if series is not None:
        write(series, folder / SERIES)
    results = Path("results") / original.config.run
    stages = ", ".join(original.datasets)
    print(f"octsim: making {stages} in {folder / results}; {LOG} there tells", file=sys.stderr)
    workflow = workflow_folder()
    command = [
        sys.executable, "-m", "snakemake", "--snakefile", str(workflow / "Snakefile"),
        "--profile", "none",  # none of the user's
        "--workflow-profile", str(workflow / "profiles" / "default"), "--directory", str(folder),
        "--configfile", str(file), "--cores", str(cores),
        *(str(results / f"{stage}.nc") for stage in original.datasets),
    ]  # fmt: skip
    with (folder / LOG).open("w", encoding="utf-8") as log:
        told = {**os.environ, WORDS: "verbose"}
        done = subprocess.run(command, cwd=folder, stdout=log, stderr=log, env=told, check=False)
    if done.returncode != 0:
        raise OctsimError(f"the run failed{_reason_in(folder / LOG)}; see {folder / LOG}")
    run = run_in(folder / results)
    made = {stage: run.datasets[stage] for stage in original.datasets}
    return Recorded(str(folder / results), run.config, made, whole=True)


def _goes_on(text: str, config: Mapping[str, Any]) -> bool:
    """Return whether what was interrupted was of the same config; the budget may be another."""
    try:
        before = json.loads(text)
    except ValueError:
        return False
    return isinstance(before, dict) and {**before, "budget": config["budget"]} == config


def _harmless(original: Recorded, budget: Budget) -> dict[str, Any]:
    """Return a config that names no file outside the folder, and takes what may be taken here."""
    own = {
        one: part.model_dump(mode="json")
        for one, part in (
            ("cache", Cache()),
            ("budget", budget),
            ("scatter", Scatter()),
        )
    }
    config: dict[str, Any] = original.config.to_dict() | own
    config["measured"] = Measured().model_dump(mode="json")
    config["expansion"]["series"] = SERIES if "expansion" in original.datasets else None
    return config


def _require_recorded(original: Recorded) -> None:
    """Refuse datasets that were made from a lab's own spectra: these files are not recorded."""
    if original.config.measured.spectra is None:
        return
    of_files = [name for name in _OF_FILES if name in original.datasets]
    if of_files:
        raise DatasetError(
            f"{original.datasets[of_files[0]]}: made from {original.config.measured.spectra}, that "
            f"is not recorded; leave {', '.join(of_files)} out by --only"
        )


def _series(expansion: Path) -> xr.Dataset:
    """Return the measured series that an expansion was made from."""
    try:
        return series_in(read(expansion, "expansion"))
    except DatasetError as error:
        raise DatasetError(f"{expansion}: {error}; leave expansion out by --only") from None


def _reason_in(log: Path) -> str:
    """Return the last line in a log that is for a user, as a part of a line."""
    lines = [line for line in log.read_text(encoding="utf-8").splitlines() if "octsim: " in line]
    reasons = [line for line in lines if "octsim: warning: " not in line]
    return f" ({reasons[-1].partition('octsim: ')[2].strip()})" if reasons else ""
