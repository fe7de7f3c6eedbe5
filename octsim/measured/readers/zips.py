"""Members of a zip: looked at before they are unpacked, and never unpacked to disk."""

import struct
import zipfile
from contextlib import ExitStack
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np

from octsim.base.errors import FileError
from octsim.measured.readers.blocks import Source
from octsim.measured.readers.on_disk import Mapped, Streamed

_MOST = 50_000_000_000
"""Bytes that are unpacked of one member."""
_SMALL = 100_000_000
"""Bytes that may be unpacked of however few."""
_RATIO = 1000
"""How many times its packed size a member may have: deflate reaches 1032, of nothing but zeros."""
_LOCAL = struct.Struct("<4s22xHH")


class Zip(NamedTuple):
    """An open zip."""

    path: Path
    file: IO[bytes]
    archive: zipfile.ZipFile


def opened_zip(path: Path, stack: ExitStack) -> Zip:
    """Open a zip, until the stack is left."""
    file = stack.enter_context(path.open("rb"))
    return Zip(path, file, stack.enter_context(zipfile.ZipFile(file)))


def require_credible(name: str, unpacked: int, packed: int) -> None:
    """Check that what is said to be packed is not far more than its bytes can hold.

    Raises
    ------
    FileError
        If it is.
    """
    if unpacked > _MOST or unpacked > max(_SMALL, _RATIO * packed):
        raise FileError(
            f"{name}: {packed} bytes are said to hold {unpacked}, and it is not unpacked; write "
            "the file anew, not compressed"
        )


def member(opened: Zip, info: zipfile.ZipInfo, stack: ExitStack) -> IO[bytes]:
    """Open a member for reading, which is unpacked as it is read.

    Raises
    ------
    FileError
        If it is said to be too large, or a password is needed.
    """
    name = f"{opened.path}, {info.filename}"
    if info.flag_bits & 1:
        raise FileError(f"{name}: needs a password; give a file without one")
    require_credible(name, info.file_size, info.compress_size)
    return stack.enter_context(opened.archive.open(info))


def array_in(
    opened: Zip,
    info: zipfile.ZipInfo,
    dtype: np.dtype[Any],
    shape: tuple[int, ...],
    offset: int,
    stack: ExitStack,
) -> Source:
    """Return the numbers in a member: mapped where they are not packed, else as a stream.

    Parameters
    ----------
    opened : Zip
    info : ZipInfo
    dtype : dtype
    shape : tuple of int
        In the order of C.
    offset : int
        Bytes of the member before them.
    stack : ExitStack
        That closes what is opened.

    Raises
    ------
    FileError
        If they can't be in it.
    """
    needed = offset + dtype.itemsize * int(np.prod(shape, dtype=object))
    if needed > info.file_size:
        raise FileError(
            f"{opened.path}, {info.filename}: has {info.file_size} bytes, and {needed} are needed; "
            "copy the file anew"
        )
    stream = member(opened, info, stack)
    if info.compress_type != zipfile.ZIP_STORED or 0 in shape:
        return Streamed(stream, dtype, shape, offset)
    opened.file.seek(info.header_offset)
    _, name, extra = _LOCAL.unpack(opened.file.read(_LOCAL.size))
    begin = info.header_offset + _LOCAL.size + name + extra
    return Mapped(opened.file, dtype, shape, begin + offset)
