"""An archive of a run: verified to the last bit, and unpacked.

Nothing in an archive is run or unpickled; nothing of it is written before all of it is verified.
"""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from octsim.archive import zip_file as zipped
from octsim.archive.checksums import LARGEST, SUMS, differences, digest, parsed, pieces_of
from octsim.base.errors import ArchiveError, FileError
from octsim.base.files import reason, require_empty


def problems(path: Path) -> list[str]:
    """Say what of an archive is not as it was packed, a line each; nothing if all is.

    Parameters
    ----------
    path : path
        A zip, or the folder that one was unpacked to.

    Raises
    ------
    ArchiveError
        If it is not an archive of octsim, or one that is not safe to unpack.
    """
    try:
        if path.is_dir():
            return _in_folder(path)
        with path.open("rb") as stream:
            return _in_zip(stream)
    except ArchiveError as error:
        raise ArchiveError(f"{path}: {error}") from None
    except OSError as error:
        raise ArchiveError(f"{path}: can't be read ({reason(error)})") from None


def verify(path: Path) -> None:
    """Check that an archive, a zip or an unpacked folder, is as it was packed, to the last bit.

    Raises
    ------
    ArchiveError
        If it is not; with a line for each file that is missing, changed or additional.
    """
    said = problems(path)
    if said:
        raise ArchiveError("\n".join(f"{path}: {line}" for line in said))


def unpack(file: Path, folder: Path) -> None:
    """Verify an archive, then unpack it.

    Parameters
    ----------
    file : path
        The zip.
    folder : path
        Where to; not there yet, or empty.

    Raises
    ------
    ArchiveError
        If the archive is not as it was packed; nothing is written.
    FileError
        If the folder holds something, or can't be written; nothing is left in it.
    """
    if file.is_dir():
        raise ArchiveError(f"{file}: is a folder; give an archive's zip")
    require_empty(folder)
    verify(file)
    try:
        place = folder.resolve()
        place.parent.mkdir(parents=True, exist_ok=True)
        # beside it first: what is killed or runs out of disk leaves the folder as it was
        with tempfile.TemporaryDirectory(prefix=f".{place.name}.", dir=place.parent) as name:
            beside = Path(name)
            with file.open("rb") as stream:
                zipped.extract(stream, beside)
            verify(beside)  # what was written, not only what was read
            place.mkdir(exist_ok=True)
            for one in sorted(beside.iterdir()):
                one.rename(place / one.name)
    except OSError as error:
        raise FileError(f"{folder}: can't be written ({reason(error)})") from None


@contextmanager
def unpacked(file: Path) -> Iterator[Path]:
    """Give a temporary folder with what an archive holds, verified.

    Raises
    ------
    ArchiveError, FileError
        As `unpack`.
    """
    with tempfile.TemporaryDirectory(prefix="octsim-") as name:
        folder = Path(name) / "run"
        unpack(file, folder)
        yield folder


def _in_zip(stream: IO[bytes]) -> list[str]:
    found = zipped.contents(stream)
    if found.sums is None:
        raise ArchiveError(f"holds no {SUMS}; not an archive of octsim")
    if not found.sums_intact:
        return [f"{SUMS}: changed"]
    said = differences(parsed(found.sums), {k: v for k, v in found.digests.items() if k != SUMS})
    if not said and not found.canonical:
        said = ["its headers or its directory: changed"]
    return said


def _in_folder(folder: Path) -> list[str]:
    sums = folder / SUMS
    if not sums.is_file() or sums.is_symlink():
        raise ArchiveError(f"holds no {SUMS}; not an archive of octsim that was unpacked")
    if sums.stat().st_size > LARGEST:
        raise ArchiveError(f"its {SUMS} is larger than that of any archive")
    listed = parsed(sums.read_bytes())
    found: dict[str, str] = {}
    for above, folders, files in os.walk(folder):
        # what is no plain file is not opened: a link leads elsewhere, a pipe may have no end
        for name in (*files, *(one for one in folders if (Path(above) / one).is_symlink())):
            file = Path(above) / name
            plain = file.is_file() and not file.is_symlink()
            known = file.relative_to(folder).as_posix()
            found[known] = digest(pieces_of(file)) if plain and known in listed else "not a file"
    del found[SUMS]
    return differences(listed, found)
