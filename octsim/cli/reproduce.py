"""Make anew what a run, an archive or one dataset records, in another folder, and compare.

    .venv/bin/python workflow/reproduce.py results/thesis/thesis.zip /some/folder

What is recorded is read as data alone: its config is checked as a user's is, the commands are this
checkout's, and all that is written stands in the folder.
"""

import argparse
import json
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import xarray as xr

from octsim.archive.compare import contrast
from octsim.archive.compare_text import lines
from octsim.archive.recorded import Recorded, recorded
from octsim.archive.run_folder import run_in
from octsim.base.errors import DatasetError, OctsimError, OctsimWarning
from octsim.base.files import require_empty, require_folder, whole
from octsim.base.provenance import PACKAGE
from octsim.cli.compare import tolerance
from octsim.cli.main import Parser
from octsim.config.load import load_config
from octsim.config.models import Cache
from octsim.datasets.files import read, write
from octsim.studies.calibration.expansion import series_in

ROOT = PACKAGE.parent
SERIES = "series.nc"
"""A measured series that an expansion was made from, in the folder."""
LOG = "snakemake.log"


def main() -> int:
    """Reproduce what the arguments name; give the exit status."""
    parser = Parser(
        description="Make anew what a run, an archive or a dataset records, and compare.",
        epilog="Exit status: 0 if every number is within the tolerance, 1 if one is not, 2 if "
        "nothing could be compared: wrong arguments, a file that can't be read, a failed run.",
    )
    parser.add_argument("file", type=Path, help="a run's folder, its archive, or a dataset")
    parser.add_argument("folder", type=Path, help="where to make it; empty, or not there yet")
    parser.add_argument(
        "--tolerance", type=tolerance,
        help="1e-12, or of another environment what the condition of each variable allows",
    )  # fmt: skip
    parser.add_argument("--cores", type=_cores, default=2, help="%(default)s")
    parser.add_argument("--only", nargs="+", metavar="STAGE", help="some of the datasets")
    given = parser.parse_args()
    warnings.simplefilter("ignore", OctsimWarning)  # the workflow says these
    try:
        with recorded(given.file) as found:
            then = _chosen(found, given.only)
            now = reproduced(then, given.folder.absolute(), given.cores)
            result = contrast(then, now, given.tolerance)
    except OctsimError as error:
        print(f"octsim: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("octsim: interrupted; the same command goes on from here", file=sys.stderr)
        return 130
    print(*lines(result), sep="\n")
    return int(result.differs)


def _cores(text: str) -> int:
    """Read a number of cores: with none, snakemake would wait for ever."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text} given; give 1 or more")
    return int(text)


def _chosen(found: Recorded, only: list[str] | None) -> Recorded:
    """Give the stages that are asked for."""
    lacking = [stage for stage in only or () if stage not in found.datasets]
    if lacking:
        there = ", ".join(found.datasets)
        raise DatasetError(f"--only: {', '.join(lacking)} given, but there is {there}")
    kept = {s: file for s, file in found.datasets.items() if only is None or s in only}
    return found._replace(datasets=kept)


def reproduced(then: Recorded, folder: Path, cores: int) -> Recorded:
    """Make the datasets that are recorded anew in a folder, from their config alone.

    Raises
    ------
    OctsimError
        If the config is refused, something that it needs is not recorded, or the run fails.
    """
    config = _harmless(then)
    load_config(config)
    series = _series(then.datasets["expansion"]) if "expansion" in then.datasets else None
    require_folder(folder)
    file, text = folder / "config.json", json.dumps(config, indent=1) + "\n"
    if not (file.is_file() and file.read_text(encoding="utf-8") == text):  # else it goes on there
        require_empty(folder)
    with whole(file) as partial:
        partial.write_text(text, encoding="utf-8")
    if series is not None:
        write(series, folder / SERIES)
    results = Path("results") / then.config.run
    task = f"octsim: making {', '.join(then.datasets)} in {folder / results}; {LOG} there tells"
    print(task, file=sys.stderr)
    command = [
        sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"),
        "--workflow-profile", str(ROOT / "profiles" / "default"), "--directory", str(folder),
        "--configfile", str(file), "--cores", str(cores),
        *(str(results / f"{stage}.nc") for stage in then.datasets),
    ]  # fmt: skip
    with (folder / LOG).open("w", encoding="utf-8") as log:
        done = subprocess.run(command, cwd=folder, stdout=log, stderr=log, check=False)
    if done.returncode != 0:
        raise OctsimError(f"the run failed{_said(folder / LOG)}; see {folder / LOG}")
    run = run_in(folder / results)
    made = {stage: run.datasets[stage] for stage in then.datasets}
    return Recorded(str(folder / results), run.config, made, whole=True)


def _harmless(then: Recorded) -> dict[str, Any]:
    """Give a config that names no file outside the folder."""
    config: dict[str, Any] = then.config.to_dict() | {"cache": Cache().model_dump(mode="json")}
    config["expansion"]["series"] = SERIES if "expansion" in then.datasets else None
    return config


def _series(expansion: Path) -> xr.Dataset:
    """Give the measured series that an expansion was made from."""
    try:
        return series_in(read(expansion, "expansion"))
    except DatasetError as error:
        raise DatasetError(f"{expansion}: {error}; leave expansion out by --only") from None


def _said(log: Path) -> str:
    """Give the last line in a log that is for a user, as a part of a line."""
    told = [line for line in log.read_text(encoding="utf-8").splitlines() if "octsim: " in line]
    why = [line for line in told if "octsim: warning: " not in line]
    return f" ({why[-1].partition('octsim: ')[2].strip()})" if why else ""


if __name__ == "__main__":
    sys.exit(main())
