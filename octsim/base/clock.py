"""Files from a clock ahead of this machine's: another machine's, a file server's, a USB stick's.

What is made of such a file is older than it, and a workflow would take it for out of date.
"""

import os
import time
from datetime import datetime
from pathlib import Path

from octsim.base.errors import FileError

_STEP = 1000  # ns between files, so that the order in which they were made stays
_SAID = 60.0  # s; a file server is ahead by less without that anything is amiss


def set_back(folder: Path) -> str | None:
    """Set times that are ahead of this machine's clock to now, in the order of the files.

    Parameters
    ----------
    folder : Path
        Where they are, at any depth; it may be missing.

    Returns
    -------
    str, optional
        What a user should know, if a clock was wrong by more than that of a file server may be.

    Raises
    ------
    FileError
        If the time of a file can't be set.
    """
    now = time.time_ns()
    ahead = sorted((at, path) for path in folder.rglob("*") if (at := _time_of(path)) > now)
    for place, (given, path) in enumerate(reversed(ahead)):
        at = now - _STEP * place
        try:
            os.utime(path, ns=(at, at))
        except OSError:
            raise FileError(
                f"{_compared(path, given, now)}, and can't be set; set the clock that is wrong, or "
                f"touch the file: touch {path}"
            ) from None
    if not ahead or ahead[-1][0] - now < 1e9 * _SAID:
        return None
    given, path = ahead[-1]
    more = f", and {len(ahead) - 1} more" if len(ahead) > 1 else ""
    return f"{_compared(path, given, now)}{more}: set to now; see that both clocks are right"


def _time_of(path: Path) -> int:
    try:
        return path.stat().st_mtime_ns
    except OSError:  # gone meanwhile
        return 0


def _compared(path: Path, given: int, now: int) -> str:
    file, clock = (datetime.fromtimestamp(at // 10**9) for at in (given, now))
    return f"{path}: its time, {file}, is ahead of this machine's clock, {clock}"
