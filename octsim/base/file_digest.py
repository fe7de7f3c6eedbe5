"""A digest of a file's bytes at its own end: one flipped bit of a dataset is seen by who reads it.

Behind all that HDF5 reads of its file stands one line more, of ASCII: a mark and a SHA-256. Other
programs do not see it, and those that change a file in its place drop it. What is digested is the
number of bytes before the line, and of each `_ROW` of them the sum of their words of 64 bits,
modulo 2⁶⁴: that is as fast as memory, which a SHA-256 of all is not, and one flipped bit changes a
sum.
"""

import errno
import hashlib
import os
from pathlib import Path
from typing import IO

_MARK = b"octsim digest 1 "
_LINE = len(_MARK) + 64 + 1
_ROW = 4096
"""Bytes that one sum is of."""
_PIECE = 32 * _ROW
"""Bytes that are read at a time: what a processor's own memory holds."""


def add_digest(path: Path) -> None:
    """Add the digest to a file that is complete and has none."""
    with path.open("r+b") as file:
        size = file.seek(0, os.SEEK_END)
        found = _digest(file, size)
        file.seek(size)
        file.write(_MARK + found.encode("ascii") + b"\n")


def is_as_written(path: Path) -> bool | None:
    """Return whether a file's bytes are those that its digest is of; None where it has none.

    Raises
    ------
    OSError
        If it can't be read.
    """
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END) - _LINE
        if size < 0:
            return None
        file.seek(size)
        line = file.read(_LINE)
        if not line.startswith(_MARK):
            return None
        return line == _MARK + _digest(file, size).encode("ascii") + b"\n"


def require_undamaged(path: Path) -> bool:
    """Check a file's bytes, if there is a digest of them; return whether there is.

    Raises
    ------
    OSError
        If they are not those that were written, or can't be read.
    """
    as_written = is_as_written(path)
    if as_written is False:
        raise OSError(
            errno.EIO, "it is damaged: its bytes are not those that octsim wrote", str(path)
        )
    return as_written is not None


def _digest(file: IO[bytes], size: int) -> str:
    """Return the digest of a file's first bytes, in lower-case hexadecimal."""
    import numpy as np  # which those who look at an archive alone do without

    words = np.empty((_PIECE // _ROW, _ROW // 8), "<u8")
    sums, room = np.empty(len(words), "<u8"), words.data.cast("B")
    found = hashlib.sha256(size.to_bytes(8, "little"))
    file.seek(0)
    while size:
        part = room[: min(size, _PIECE)]
        if file.readinto(part) < len(part):  # type: ignore[attr-defined]
            raise EOFError("the file became shorter while it was read")
        room[len(part) :] = bytes(_PIECE - len(part))
        np.add.reduce(words, axis=1, out=sums)
        found.update(sums.data)
        size -= len(part)
    return found.hexdigest()
