"""A scheduler's side alone: commands by Slurm's names, that note each question and run nothing.

A job counts as completed once it is submitted; the files that it would leave are made empty.
"""

import os
import re
import shlex
import sys
import time
from collections.abc import Sequence
from pathlib import Path

REMEMBERED = 300  # s after its end that a job is told of: Slurm's own MinJobAge
_ANSWERS = {
    "scontrol": f"MinJobAge = {REMEMBERED} sec\nMaxArraySize = 1001",
    "sinfo": "all*",
    "sacct": "",
    "scancel": "",
}
_TARGET = re.compile(r"--target-jobs '(?P<rule>\w+):(?P<wildcards>\S*)'")
_ENTRY = 18  # bytes of a job in the list of jobs: where it ends there tells its number


def scheduler(folder: Path, run: str) -> dict[str, str]:
    """Make the commands in a folder; give the environment in which they stand for Slurm's.

    Parameters
    ----------
    folder : path
    run : str
        Whose jobs are submitted, from where its workflow is.
    """
    for name in ("sbatch", "squeue", *_ANSWERS):
        answer = [sys.executable, "-IS", __file__, str(folder), run, name]
        (folder / name).write_text(f'#!/bin/sh\nexec {shlex.join(answer)} "$@"\n')
        (folder / name).chmod(0o755)
    return {**os.environ, "PATH": f"{folder}{os.pathsep}{os.environ.get('PATH', os.defpath)}"}


def asked(folder: Path) -> list[list[str]]:
    """Return each command that was given, in order, as its words."""
    return [shlex.split(line) for line in (folder / "asked").read_text().splitlines()]


def times_of(folder: Path) -> list[float]:
    """Return when each job was submitted, by their numbers."""
    jobs = folder / "jobs"
    return [float(at) for at in jobs.read_bytes().split()] if jobs.exists() else []


def files_of(run: Path, rule: str, wildcards: str) -> list[Path]:
    """Return what a job leaves: what it makes, and its log."""
    if rule != "share":
        return [run / f"{rule}.nc", run / "logs" / f"{rule}.log"]
    of = dict(one.split("=") for one in wildcards.split(","))
    share = f"{of['stage']}-{of['number']}-of-{of['of']}"
    return [run / "shares" / f"{share}.npz", run / "logs" / "shares" / f"{share}.log"]


def submitted(folder: Path, run: Path, arguments: Sequence[str]) -> str:
    """Do what is left of a job; return its number."""
    with (folder / "jobs").open("ab") as file:  # of two that come at once, each has its own end
        file.write(f"{time.time():<{_ENTRY - 1}.5f}\n".encode())
        file.flush()
        number = str(file.tell() // _ENTRY)
    target = _TARGET.search(arguments[-1])
    assert target is not None
    told = Path(arguments[arguments.index("--output") + 1].replace("%j", number))
    for made in (told, *files_of(run, *target.groups())):
        made.parent.mkdir(parents=True, exist_ok=True)
        made.touch()
    return number


def queue(folder: Path) -> str:
    """Return the jobs that are remembered, all of them ended."""
    since = time.time() - REMEMBERED
    there = [number for number, at in enumerate(times_of(folder), 1) if at >= since]
    return "\n".join(f"{number}|COMPLETED" for number in there)


def main(folder: Path, run: Path, name: str, *arguments: str) -> None:
    """Note a command and answer it."""
    with (folder / "asked").open("a") as file:
        file.write(shlex.join([name, *arguments]).replace("\n", " ") + "\n")
    if name == "sbatch":
        print(submitted(folder, run, arguments))
    else:
        print(queue(folder) if name == "squeue" else _ANSWERS[name])


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), *sys.argv[3:])
