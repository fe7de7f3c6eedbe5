"""An archive of a run: verified to the last bit, and unpacked.

Nothing in an archive is run or unpickled; nothing of it is written before all of it is verified.
"""

import os
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO

from octsim.archive.checksums import DAMAGED, LARGEST, SUMS, differences, parse_sums
from octsim.archive.zip_file import digests_in, is_canonical, safe_zip
from octsim.base.errors import ArchiveError, FileError
from octsim.base.files import digest, is_folder, reason, require_empty, require_regular


def problems(path: Path) -> list[str]:
    """Return what of an archive is not as it was packed, a line each; none if all is.

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
        if is_folder(path):
            return _problems_in_folder(path)
        require_regular(path)
        with path.open("rb") as stream:
            return problems_in_zip(stream)
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
    lines = problems(path)
    if lines:
        raise ArchiveError(*(f"{path}: {line}" for line in lines))


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
    if is_folder(file):
        raise ArchiveError(f"{file}: is a folder; give an archive's zip")
    require_empty(folder)
    verify(file)
    try:
        place = folder.resolve()
        place.parent.mkdir(parents=True, exist_ok=True)
        # beside it first: what is killed or runs out of disk leaves the folder as it was
        with tempfile.TemporaryDirectory(prefix=f".{place.name}.", dir=place.parent) as name:
            beside = Path(name)
            with file.open("rb") as stream, safe_zip(stream) as archive:
                archive.extractall(beside)
            verify(beside)  # what was written, not only what was read
            place.mkdir(exist_ok=True)
            for one in sorted(beside.iterdir()):
                one.rename(place / one.name)
    except OSError as error:
        raise FileError(f"{folder}: can't be written ({reason(error)})") from None


@contextmanager
def unpacked(file: Path) -> Iterator[Path]:
    """Return a temporary folder with what an archive holds, verified.

    Raises
    ------
    ArchiveError
        If the archive is not as it was packed.
    FileError
        If there is no room for it among the temporary files.
    """
    with ExitStack() as held:
        try:
            name = held.enter_context(tempfile.TemporaryDirectory(prefix="octsim-"))
            folder = Path(name) / "run"
            unpack(file, folder)
        except (OSError, FileError) as error:
            raise FileError(
                f"{file}: can't be unpacked among the temporary files ({reason(error)}); make room "
                "there, or give another folder for them: TMPDIR=..."
            ) from None
        yield folder


def problems_in_zip(stream: IO[bytes]) -> list[str]:
    """Return what of a zip is not as it was packed; see `problems`."""
    with safe_zip(stream) as archive:
        present = digests_in(archive)
        if SUMS not in present:
            raise ArchiveError(f"holds no {SUMS}; not an archive of octsim")
        if present.pop(SUMS) == DAMAGED:
            return [f"{SUMS}: changed"]
        lines = differences(parse_sums(archive.read(SUMS)), present)
        if not lines and not is_canonical(archive, stream):
            lines = ["its headers or its directory: changed"]
        return lines


def _problems_in_folder(folder: Path) -> list[str]:
    sums = folder / SUMS
    if not sums.is_file() or sums.is_symlink():
        raise ArchiveError(f"holds no {SUMS}; not an archive of octsim that was unpacked")
    if sums.stat().st_size > LARGEST:
        raise ArchiveError(f"its {SUMS} is larger than that of any archive")
    listed = parse_sums(sums.read_bytes())
    present: dict[str, str] = {}
    for above, folders, files in os.walk(folder):
        # what is no plain file is not opened: a link leads elsewhere, a pipe may have no end
        for name in (*files, *(one for one in folders if (Path(above) / one).is_symlink())):
            file = Path(above) / name
            path = file.relative_to(folder).as_posix()
            present[path] = DAMAGED
            if path in listed and file.is_file() and not file.is_symlink():
                with file.open("rb") as stream:
                    present[path] = digest(stream)
    del present[SUMS]
    return differences(listed, present)
