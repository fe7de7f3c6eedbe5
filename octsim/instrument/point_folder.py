"""Where the folder of a point store lies, whose it is, and files in it that appear at once."""

import json
import os
import re
from contextlib import suppress
from pathlib import Path

from octsim.base.errors import CacheError, ConfigError

VERSION = 2  # 1 was a database, of octsim 0.2.0
_DESCRIPTION = "octsim-points.json"
_OURS = re.compile("[0-9a-f]{2}|octsim-.*")  # names of what stores are made of
_DATABASE = b"OCTP"  # in bytes 68 to 71 of it


def expanded_path(named: str) -> Path:
    """Return the path that ``cache.file`` names, as this machine has it here and now.

    Raises
    ------
    ConfigError
        If an environment variable is not set.
    """
    # as os.path.expandvars finds them, which leaves alone those that are not set
    variables = (name.strip("{}") for name in re.findall(r"\$(\w+|\{[^}]*\})", named))
    unset = [name for name in variables if name not in os.environ]
    if unset:
        raise ConfigError(
            f"cache.file: {named!r} given, but the environment variable {unset[0]} is not set "
            "here; set it, or name a file without it"
        )
    return Path(os.path.expandvars(named)).expanduser()


def folder_of(file: Path) -> Path:
    """Return where the store of a name has its folder: there, or beside a cache of octsim 0.2.0.

    What can't be looked into is put up with: who reads or writes there says why that fails.

    Raises
    ------
    CacheError
        If something else is there, or a store of a later version.
    """
    beside = Path(f"{file}.store")
    with suppress(OSError):
        # it stays there when the old file has been deleted
        is_beside = old_cache(file) == file or (beside.exists() and not file.exists())
        folder = beside if is_beside else file
        if folder.exists():
            _require_store(folder)
        return folder
    return file


def _require_store(folder: Path) -> None:
    names = [path.name for path in folder.iterdir()] if folder.is_dir() else [""]
    if _DESCRIPTION not in names and not all(map(_OURS.fullmatch, names)):
        raise CacheError(f"{folder}: is not a point cache of octsim; move it away or name another")
    version = described(folder).get("version", VERSION)
    if version > VERSION:
        raise CacheError(
            f"{folder}: is a point cache of a later octsim (version {version}, known here are up "
            f"to {VERSION}); move it away or name another"
        )


def old_cache(file: Path) -> Path | None:
    """Return the point cache of octsim 0.2.0 at a name, or at it with the suffix of its default."""
    for place in (file, Path(f"{file}.sqlite")):
        with suppress(OSError):
            if place.is_file():
                with place.open("rb") as stream:
                    header = stream.read(72)
                if not header or header[68:] == _DATABASE:  # it could be killed before it wrote
                    return place
    return None


def old_cache_remark(old: Path) -> str:
    """Return the line that says what to do with such a file."""
    return f"{old}: a point cache of octsim 0.2.0, which is not used any more; it can be deleted"


def described(folder: Path) -> dict[str, int]:
    """Return the numbers that describe a store; none of what is missing or damaged."""
    try:
        held = json.loads((folder / _DESCRIPTION).read_bytes())
    except (FileNotFoundError, ValueError):
        return {}
    numbers = held.items() if isinstance(held, dict) else ()
    return {name: number for name, number in numbers if isinstance(number, int)}


def make_folder(folder: Path, allowed: int) -> None:
    """Make a store's folder, if there is none, and write down how many bytes are allowed."""
    description = {"version": VERSION, "allowed": allowed}
    if described(folder) != description:
        write(folder / _DESCRIPTION, json.dumps(description).encode())


def write(file: Path, content: bytes) -> None:
    """Write a file that is there whole or not at all, and its folder, where there is none."""
    partial = file.with_name(f"{file.name}.{os.urandom(8).hex()}~")
    try:
        try:
            _write_new(partial, content)
        except FileNotFoundError:
            file.parent.mkdir(parents=True, exist_ok=True)
            _write_new(partial, content)
        partial.replace(file)
    except BaseException:
        with suppress(OSError):
            partial.unlink()
        raise


def _write_new(file: Path, content: bytes) -> None:
    """Write a file that is not there yet: no link that was laid there is followed."""
    with file.open("xb") as stream:
        stream.write(content)
