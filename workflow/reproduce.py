"""Make anew what a run, an archive or one dataset records, in another folder, and compare.

    .venv/bin/python workflow/reproduce.py results/thesis/thesis.zip /some/folder

What is recorded is read as data alone: its config is checked as a user's is, the commands are this
checkout's, and all that is written stands in the folder.
"""

import argparse
import json
import shutil
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any, NoReturn

from octsim.compare_command import tolerance
from octsim.config import Cache
from octsim.contrast import TOLERANCE, contrast
from octsim.contrast_text import lines
from octsim.errors import DatasetError, FileError, OctsimError, OctsimWarning
from octsim.files import require_folder, whole
from octsim.loading import load_config
from octsim.recorded import Recorded, located, recorded
from octsim.runs import run_in

ROOT = Path(__file__).resolve().parents[1]
INPUTS = "inputs"
"""Folder of what a run was given besides its config, in an archive."""
LOG = "snakemake.log"


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say in one line what is wrong with the arguments."""
        self.exit(2, f"octsim: {message}; `{self.prog} --help` says what there is\n")


def main() -> int:
    """Reproduce what the arguments name; give the exit status."""
    parser = _Parser(
        description="Make anew what a run, an archive or a dataset records, and compare.",
        epilog="Exit status: 0 if every number is within the tolerance, 1 if one is not, 2 if "
        "nothing could be compared: wrong arguments, a file that can't be read, a failed run.",
    )
    parser.add_argument("file", type=Path, help="a run's folder, its archive, or a dataset")
    parser.add_argument("folder", type=Path, help="where to make it; empty, or not there yet")
    parser.add_argument("--tolerance", type=tolerance, default=TOLERANCE, help="%(default)s")
    parser.add_argument("--cores", type=_cores, default=2, help="%(default)s")
    parser.add_argument("--only", nargs="+", metavar="STAGE", help="some of the datasets")
    given = parser.parse_args()
    warnings.simplefilter("ignore", OctsimWarning)  # the workflow says these
    try:
        with located(given.file) as place, recorded(place) as found:
            then = _chosen(found, given.only)._replace(name=str(given.file))
            inputs = place / INPUTS if place.is_dir() else None
            now = reproduced(then, inputs, given.folder.absolute(), given.cores)
            result = contrast(then, now, given.tolerance)
    except OctsimError as error:
        print(f"octsim: {error}", file=sys.stderr)
        return 2
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


def reproduced(then: Recorded, inputs: Path | None, folder: Path, cores: int) -> Recorded:
    """Make the datasets that are recorded anew in a folder, from their config alone.

    Raises
    ------
    OctsimError
        If the config is refused, something that it needs is not recorded, or the run fails.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise FileError(f"{folder}: not empty; give a folder that is, or one that is not there yet")
    config, series = _harmless(then, inputs)
    load_config(config)
    require_folder(folder)
    file = folder / "config.json"
    with whole(file) as partial:
        partial.write_text(json.dumps(config, indent=1) + "\n", encoding="utf-8")
    if series:
        (folder / INPUTS).mkdir()
        shutil.copyfile(series, folder / INPUTS / series.name)
    results = Path("results") / then.config.run
    print(f"octsim: making {', '.join(then.datasets)} in {folder / results}", file=sys.stderr)
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


def _harmless(then: Recorded, inputs: Path | None) -> tuple[dict[str, Any], Path | None]:
    """Give a config that names no file outside the folder, and the measured series it needs."""
    config: dict[str, Any] = then.config.to_dict() | {"cache": Cache().model_dump(mode="json")}
    named, config["expansion"]["series"] = config["expansion"]["series"], None
    if "expansion" not in then.datasets or named is None:
        return config, None
    series = _series(named, inputs) if inputs else None
    if series is None:
        raise DatasetError(
            f"{then.datasets['expansion']}: its measured series {named} is not recorded beside it; "
            "give an archive of the run, or leave expansion out by --only"
        )
    config["expansion"]["series"] = f"{INPUTS}/{series.name}"
    return config, series


def _series(named: str, inputs: Path) -> Path | None:
    """Give the archived series; one whose name is none for an archive has another there."""
    places = (inputs / Path(named).name, *sorted(inputs.glob("series.*")))
    return next((place for place in places if place.is_file() and not place.is_symlink()), None)


def _said(log: Path) -> str:
    """Give the last line in a log that is for a user, as a part of a line."""
    told = [line for line in log.read_text(encoding="utf-8").splitlines() if "octsim: " in line]
    why = [line for line in told if "octsim: warning: " not in line]
    return f" ({why[-1].partition('octsim: ')[2].strip()})" if why else ""


if __name__ == "__main__":
    sys.exit(main())
