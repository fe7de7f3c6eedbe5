"""Where compiled code is kept: the first of a few places that this process can write to.

Whatever the place, code lies below a name that all of its sources go into, so that what is found
there is of the sources that are there now. A place that only can be read serves what it holds.
"""

import os
import shutil
import tempfile
import time
from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from importlib.util import cache_from_source
from pathlib import Path

from platformdirs import user_cache_path

from octsim.base.carried import PACKAGE

VARIABLE = "NUMBA_CACHE_DIR"
"""Environment variable that names a place, as numba's own does."""
_PREFIX = "numba-"
SOURCES = "octsim-sources-"
"""How names of files begin that keep what sources say."""
_UNUSED = 30 * 24 * 3600.0  # s, after which code of other sources is removed


def places() -> tuple[Path, ...]:
    """Return where compiled code may lie, the first choice first.

    That which ``NUMBA_CACHE_DIR`` names, alone; or else beside the package's byte code, and the
    user's folder of caches, for a user who has a home.
    """
    if named := os.environ.get(VARIABLE):
        return (Path(named).absolute(),)
    beside = Path(cache_from_source(str(PACKAGE / "__init__.py"))).parent
    return tuple(place for place in (beside, user_cache_path("octsim")) if place.is_absolute())


@cache
def can_write(place: Path) -> bool:
    """Return whether files can be made in a folder, which is made if need be."""
    try:
        place.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=place):
            return True
    except OSError:  # access bits do not tell: of a read-only disk, a file server, another's folder
        return False


def writable(among: Iterable[Path]) -> Path | None:
    """Return the first place that can be written to, or None."""
    return next((place for place in among if can_write(place)), None)


def folder_for(digest: str, among: Iterable[Path]) -> Path | None:
    """Return the folder for code of a digest, or None if none of the places can be used."""
    name, among = _PREFIX + digest, tuple(among)
    for place in among:
        if can_write(place):
            return place / name
        with suppress(OSError):
            if any((place / name).rglob("*.nbi")):
                return place / name
    return None


def nowhere(among: Iterable[Path]) -> str:
    """Return what to say where no place can be written to."""
    tried = ", ".join(map(str, among))
    return (
        f"compiled code can't be kept, as {tried} can't be written to: each process compiles it "
        f"anew, which takes about a minute; set {VARIABLE} to a folder that can be written to"
    )


def use(folder: Path) -> None:
    """Note that a folder's code is in use, as far as that can be noted."""
    with suppress(OSError):
        os.utime(folder)


def remove_unused(place: Path) -> None:
    """Remove code that no process has used for a month. One that has it open goes on with it.

    So is what is kept of sources (`octsim.base.kept_syntax`), if nothing was added for as long.
    """
    with suppress(OSError):
        for kept in (*place.glob(f"{_PREFIX}*"), *place.glob(f"{SOURCES}*.json")):
            if kept.stat().st_mtime < time.time() - _UNUSED:
                kept.unlink() if kept.is_file() else shutil.rmtree(kept, ignore_errors=True)
