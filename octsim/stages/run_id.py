"""Which run of a name is the latest: jobs of an earlier one end, on whichever machine they are.

A run that is killed leaves its jobs on a cluster to themselves. Those that wait or work must not
write beside the jobs of the next run.
"""

import os
import uuid
from pathlib import Path

from octsim.base.files import remove_unfinished

_NAME = "OCTSIM_RUN_ID"  # a job has it from its run


def begin(folder: Path) -> None:
    """Note in a run's folder that a run begins, from now on the latest; its jobs inherit which."""
    os.environ[_NAME] = uuid.uuid4().hex
    file = _file(folder)
    file.parent.mkdir(parents=True, exist_ok=True)
    # in place: a network file system shows a new text to who opens the file, a new file later
    file.write_text(os.environ[_NAME], encoding="utf-8")
    remove_unfinished(folder)  # of runs that were killed: a folder has one at a time


def is_latest(folder: Path) -> bool:
    """Whether no other run has begun in a folder since this process's own; so if none has one."""
    mine = os.environ.get(_NAME)
    if mine is None:
        return True
    try:
        found = _file(folder).read_text(encoding="utf-8")
    except OSError:  # moved away, or a network file system that stalls: the next look tells
        return True
    return found in ("", mine)  # it is empty while it is written


def _file(folder: Path) -> Path:
    return folder / "logs" / "run_id"
