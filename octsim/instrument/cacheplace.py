"""Where the point cache lies on the machine that asks."""

import contextlib
import os
import re
import stat
import tempfile
from pathlib import Path

from octsim.base.errors import CacheError, ConfigError

_JOB = "SLURM_JOB_ID"


def cache_file(named: str) -> Path:
    """Give the file that ``cache.file`` names, as this machine has it.

    A home folder and environment variables are expanded here and now. In a job of a cluster a
    relative name lies in the node's own folder for temporary files: the folder of the run is on a
    network file system there, over which several nodes can't share a cache.

    Parameters
    ----------
    named : str
        As in the config.

    Raises
    ------
    ConfigError
        If a variable is not set.
    CacheError
        If others can write the node's folder: they could put anything there.
    """
    # as os.path.expandvars finds them, which leaves alone those that are not set
    variables = (name.strip("{}") for name in re.findall(r"\$(\w+|\{[^}]*\})", named))
    unset = [name for name in variables if name not in os.environ]
    if unset:
        raise ConfigError(
            f"cache.file: {named!r} given, but the environment variable {unset[0]} is not set "
            "here; set it, or name a file without it"
        )
    file = Path(os.path.expandvars(named)).expanduser()
    return file if file.is_absolute() or _JOB not in os.environ else _on_this_node(file)


def _on_this_node(file: Path) -> Path:
    folder = Path(tempfile.gettempdir()) / f"octsim-{os.getuid()}"
    with contextlib.suppress(FileExistsError):
        folder.mkdir(mode=0o700, parents=True)
    found = folder.lstat()
    others = stat.S_IWGRP | stat.S_IWOTH
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & others:
        raise CacheError(
            f"{folder}: not a folder that only you can write; move it away, or give cache.file a "
            "name that starts with /"
        )
    return folder / file
