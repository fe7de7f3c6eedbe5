"""What a process says to a person, on a terminal in the place of what tells of progress there."""

import os
import sys
from pathlib import Path

PROGRESS = "OCTSIM_PROGRESS"
"""Environment variable with the folder where jobs note how far they are, for who shows it."""
WORDS = "OCTSIM_WORDS"
"""Environment variable: whose words a run shows, ``quiet`` or ``verbose``; else octsim's."""
CLEAR = "\r\x1b[K"
"""Takes what stands on a terminal's line away."""


def say(text: str) -> None:
    """Print a line of octsim's to who waits."""
    clear = CLEAR if sys.stderr.isatty() else ""
    print(f"{clear}octsim: {text}", file=sys.stderr, flush=True)


class _Job:
    name = ""


def noting_for(name: str) -> None:
    """Have what this process notes be of a job."""
    _Job.name = name


def note(text: str) -> bool:
    """Note how far this process's job is, in some words; return whether that is shown."""
    folder = os.environ.get(PROGRESS)
    if not (folder and _Job.name):
        return False
    file = Path(folder, _Job.name)
    try:
        file.with_suffix(".partial").write_text(text, encoding="utf-8")
        file.with_suffix(".partial").replace(file)
    except OSError:  # who shows it has ended
        return False
    return True
