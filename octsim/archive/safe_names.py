"""Names of files in an archive: plain paths below its folder, the same on every system."""

import re
from collections.abc import Iterable
from itertools import accumulate

from octsim.base.errors import ArchiveError

_PART = re.compile(r"[A-Za-z0-9_](?:[A-Za-z0-9._-]{0,126}[A-Za-z0-9_-])?")
_DEVICES = re.compile(r"(?:con|prn|aux|nul|com[0-9]|lpt[0-9])(?:\..*)?", re.IGNORECASE)
_DEEPEST = 8


def is_plain(name: str) -> bool:
    """Return whether a name is a path below the folder that it is in, whatever the system.

    What is not listed here is none: no `..`, no `/` at the start, no backslash, drive letter,
    control character or letter that looks like another, no name that Windows keeps for a device.

    Examples
    --------
    >>> is_plain("figures/figure_12.svg"), is_plain("../figure_12.svg"), is_plain("C:/nul.nc")
    (True, False, False)
    """
    parts = name.split("/")
    return len(parts) <= _DEEPEST and all(
        _PART.fullmatch(part) and not _DEVICES.fullmatch(part) for part in parts
    )


def require_plain(names: Iterable[str]) -> None:
    """Check that names are plain, and that no two of them can be the same file or folder.

    Raises
    ------
    ArchiveError
        If one is not; of a name that is hostile only what can be printed is shown.
    """
    spelt: dict[str, str] = {}
    files: set[str] = set()
    folders: set[str] = set()
    for name in names:
        if not is_plain(name):
            raise ArchiveError(f"holds {shown(name)}, which is not a plain path below its folder")
        if name in files:
            raise ArchiveError(f"holds {name} twice")
        *above, _ = paths = list(accumulate(name.split("/"), "{}/{}".format))
        for path in paths:
            other = spelt.setdefault(path.casefold(), path)
            if other != path:
                raise ArchiveError(f"holds {path} beside {other}, the same but for its case")
        files.add(name)
        folders.update(above)
    for name in sorted(files & folders):
        raise ArchiveError(f"holds {name} as a file and as a folder")


def shown(name: str) -> str:
    """Return a name as text that a terminal may print."""
    text = ascii(name)
    return text if len(text) <= 80 else f"{text[:76]}...'"
