"""Files that appear whole or not at all, what is a file at all, and reading in bounds."""

import contextlib
import errno
import hashlib
import os
import re
import secrets
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from octsim.base.errors import FileError


def reason(error: BaseException) -> str:
    """Return what an error says, in one line."""
    said = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return " ".join(said.split()) or type(error).__name__


def require_regular(path: str | Path) -> None:
    """Check that a path is a file with an end: no folder, no pipe that is waited for, no device.

    Raises
    ------
    OSError
        If it is not, or is not there, or may not be read. Nothing is opened.
    """
    try:
        mode = Path(path).stat().st_mode
    except ValueError:
        raise OSError(errno.EINVAL, "its name holds a byte 0", str(path)) from None
    _require_file(mode, path)
    if not os.access(path, os.R_OK):
        raise PermissionError(errno.EACCES, "permission denied", str(path))


def _require_file(mode: int, path: str | Path) -> None:
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, "a folder, and no file", str(path))
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "no file, but a pipe or a device", str(path))


def is_regular(path: str | Path) -> bool:
    """Return whether a path is a file that can be read, whatever stands there."""
    try:
        require_regular(path)
    except OSError:
        return False
    return True


def is_folder(path: str | Path) -> bool:
    """Return whether a path is a folder, whatever stands there."""
    try:
        return stat.S_ISDIR(Path(path).stat().st_mode)
    except (OSError, ValueError):
        return False


# snakemake's own notes and the copies that it keeps of files being replaced need some room too
SPACE = 32_000_000
_FULL = 1_000_000
_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
_UNFINISHED = re.compile(r"[.].+[.]partial([.].+)?")


def standing(path: Path) -> Path:
    """Return what is there of a path: itself, or the nearest folder above it."""
    return next(place for place in (path, *path.absolute().parents) if place.exists())


def require_folder(path: Path) -> None:
    """Check that a folder is there or can be made, and has room and a name that netCDF takes.

    Raises
    ------
    FileError
        If it can't; nothing is made.
    """
    there, whole_path = standing(path), os.fsencode(path.absolute())
    if b"\\" in whole_path or not _is_utf_8(whole_path):
        raise FileError(
            f"{path}: can't hold netCDF files, as the name of a folder above it, "
            f"{path.absolute().parent}, has a backslash or a character that is not UTF-8; rename "
            "that, or run elsewhere"
        )
    if not there.is_dir():
        raise FileError(f"{path}: can't be a folder, as {there.name} is a file; move that away")
    if not os.access(there, os.W_OK | os.X_OK):
        raise FileError(f"{path}: can't be written; make {there} writable or run elsewhere")
    free = shutil.disk_usage(there).free
    if free < SPACE:
        raise FileError(
            f"{path}: the disk is full ({free / 1e6:.0f} MB free, {SPACE / 1e6:.0f} MB needed); "
            "make room and run again"
        )


def _is_utf_8(name: bytes) -> bool:
    try:
        name.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def require_empty(folder: Path) -> None:
    """Check that a folder holds nothing, or is not there yet.

    Raises
    ------
    FileError
        If it does.
    """
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise FileError(
            f"{folder}: not an empty folder; give one that is, or that is not there yet"
        )


def read_bounded(path: str | Path, most: int) -> bytes:
    """Return what a file holds, of at most so many bytes, and never wait for who would write it.

    Raises
    ------
    OSError
        If it can't be read, holds more, or is a folder, a pipe or a device.
    """
    try:
        # a pipe is opened at once, and seen to be one
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    except ValueError:
        raise OSError(errno.EINVAL, "its name holds a byte 0") from None
    with os.fdopen(descriptor, "rb") as stream:
        found = os.fstat(descriptor)
        _require_file(found.st_mode, path)
        content = b"" if found.st_size > most else stream.read(most + 1)
    if max(found.st_size, len(content)) > most:
        size = max(found.st_size, len(content)) / 1e6
        raise OSError(errno.EFBIG, f"it holds {size:.3g} MB, of {most / 1e6:.3g} MB at most")
    return content


def digest(stream: IO[bytes]) -> str:
    """Return the SHA-256 of what a stream holds, in lower-case hexadecimal."""
    # a stream that is open for bytes can read into a buffer, which its type does not say
    return hashlib.file_digest(stream, "sha256").hexdigest()  # type: ignore[arg-type]


def digest_of(path: Path) -> str:
    """Return the SHA-256 of what a file holds, in lower-case hexadecimal."""
    with path.open("rb") as stream:
        return digest(stream)


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Return a temporary file beside `path`, that is renamed to it once the file is complete.

    It is made anew, under a name that nobody can guess: no link that was laid there is followed.

    Raises
    ------
    FileError
        If the file can't be written; what stood at `path` before is still there.
    """
    temporary = path.with_name(f".{path.stem}.{secrets.token_hex(8)}.partial{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        os.close(os.open(temporary, _NEW, 0o666))
        yield temporary
        temporary.replace(path)
    except (OSError, RuntimeError) as error:
        full = shutil.disk_usage(temporary.parent).free < _FULL if path.parent.is_dir() else False
        why = "the disk is full" if full else reason(error)
        raise FileError(f"{path}: can't be written ({why}); what was there is unchanged") from None
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink()


def remove_unfinished(folder: Path) -> None:
    """Remove what killed processes have left in a folder, where nobody else is at work."""
    for file in folder.rglob(".*.partial*"):
        if _UNFINISHED.fullmatch(file.name) and not file.is_dir():
            with contextlib.suppress(OSError):
                file.unlink()
