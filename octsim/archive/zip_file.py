"""A zip whose bytes follow from its contents alone, and what is found in one that claims to be.

Members are stored, not compressed, so that no version of a compressor matters, under sorted names,
with one date and one mode. There is one such zip of given contents: a check writes it anew, against
the bytes that are there, so that not a bit of a header can differ.
"""

import hashlib
import io
import stat
import zipfile
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import IO, NamedTuple

from octsim.archive.checksums import LARGEST, SUMS
from octsim.archive.safe_names import require_plain, shown
from octsim.base.errors import ArchiveError

_DATE = (1980, 1, 1, 0, 0, 0)
_MODE = (stat.S_IFREG | 0o644) << 16
_UNIX = 3
_PIECE = 1 << 20


class Member(NamedTuple):
    """A file to be put in."""

    name: str
    size: int
    """Bytes."""
    pieces: Callable[[], Iterable[bytes]]
    """What it holds, piece by piece."""


class Contents(NamedTuple):
    """What a zip holds."""

    digests: dict[str, str]
    """SHA-256 by name."""
    sums: bytes | None
    """The sums file, or None without one."""
    sums_intact: bool
    """Whether the sums file has the checksum that the zip has of it."""
    canonical: bool
    """Whether headers, directory and all between are those of this zip's contents."""


def write(stream: IO[bytes], members: Iterable[Member]) -> list[zipfile.ZipInfo]:
    """Write a zip, in order of the names.

    Raises
    ------
    ArchiveError
        If a file is longer or shorter than it was said to be.
    """
    with zipfile.ZipFile(stream, "w") as archive:
        for member in sorted(members):
            info = zipfile.ZipInfo(member.name, _DATE)
            info.create_system, info.external_attr = _UNIX, _MODE
            info.file_size = member.size  # decides whether its header is one for more than 4 GB
            size = 0
            with archive.open(info, "w") as out:
                for piece in member.pieces():
                    size += len(piece)
                    if size > member.size:
                        break
                    out.write(piece)
            if size != member.size:
                raise ArchiveError(f"{member.name}: changed while it was packed; pack again")
        return archive.infolist()


def listed(stream: IO[bytes]) -> list[zipfile.ZipInfo]:
    """Give the members that a zip's directory states; nothing else of it is read.

    Raises
    ------
    ArchiveError
        If it is not a zip, or one that is not safe to read or to unpack.
    """
    size = stream.seek(0, io.SEEK_END)
    try:
        with zipfile.ZipFile(_Bounded(stream, size)) as archive:
            infos = archive.infolist()
    except ArchiveError:
        raise
    # all that a module for zips says of bytes that are none
    except (zipfile.BadZipFile, ValueError, RuntimeError, LookupError, EOFError, OSError) as error:
        raise ArchiveError(f"not a zip that is whole ({error})") from None
    require_plain(info.orig_filename for info in infos)
    for info in infos:
        if info.external_attr != _MODE:
            kind = "a link" if stat.S_ISLNK(info.external_attr >> 16) else "not a plain file"
            raise ArchiveError(f"holds {shown(info.orig_filename)}, which is {kind}")
        if info.compress_type != zipfile.ZIP_STORED or info.compress_size != info.file_size:
            raise ArchiveError(f"holds {info.filename} compressed, as octsim packs no file")
    if sum(info.file_size for info in infos) > size:
        raise ArchiveError("states that it holds more than it can")
    return infos


def contents(stream: IO[bytes]) -> Contents:
    """Read a zip whole, piece by piece, and compare it with the one that its contents make.

    Raises
    ------
    ArchiveError
        If it is not a zip, not safe, or its directory is none that octsim writes.
    """
    stated = {info.filename: info for info in listed(stream)}
    there = _Comparison(stream)
    digests: dict[str, str] = {}
    kept: dict[str, bytes] = {}

    def pieces(info: zipfile.ZipInfo) -> Iterator[bytes]:
        # the writer has just written this member's header: here its data has to be
        start = there.tell()
        if there.sought != info.header_offset:
            raise ArchiveError("its directory is not as octsim writes it")
        found, left, held = hashlib.sha256(), info.file_size, bytearray()
        while left:
            stream.seek(start + info.file_size - left)
            piece = stream.read(min(left, _PIECE))
            if not piece:
                raise ArchiveError(f"ends within {info.filename}")
            left -= len(piece)
            found.update(piece)
            if info.filename == SUMS:
                held += piece
            yield piece
        digests[info.filename] = found.hexdigest()
        if info.filename == SUMS:
            kept[SUMS] = bytes(held)

    if SUMS in stated and stated[SUMS].file_size > LARGEST:
        raise ArchiveError(f"its {SUMS} is larger than that of any archive")
    again = write(
        there,  # type: ignore[arg-type]
        [Member(name, one.file_size, partial(pieces, one)) for name, one in stated.items()],
    )
    intact = all(one.CRC == stated[SUMS].CRC for one in again if one.filename == SUMS)
    return Contents(digests, kept.get(SUMS), intact, there.is_equal())


def extract(stream: IO[bytes], folder: Path) -> None:
    """Write the members of a zip that `contents` has found canonical into an empty folder.

    Raises
    ------
    ArchiveError
        If it is not safe, as one is not that was exchanged since.
    """
    infos = listed(stream)
    with zipfile.ZipFile(stream) as archive:
        for info in infos:
            file = folder / info.filename
            file.parent.mkdir(parents=True, exist_ok=True)
            with archive.open(info) as packed, file.open("xb") as out:
                while piece := packed.read(_PIECE):
                    out.write(piece)


class _Bounded(io.RawIOBase):
    """A stream of which no one reads much at once, as a directory that is far too large would."""

    def __init__(self, stream: IO[bytes], size: int) -> None:
        self._stream, self._size = stream, size

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        return self._stream.seek(offset, whence)

    def tell(self) -> int:
        return self._stream.tell()

    def read(self, size: int | None = -1) -> bytes:
        left = self._size - self.tell()
        if min(left, left if size is None or size < 0 else size) > LARGEST:
            raise ArchiveError("its directory is larger than that of any archive")
        return self._stream.read(-1 if size is None else size)


class _Comparison(io.RawIOBase):
    """A file that is written to only to learn where another differs from what is written."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream, self._at, self._end = stream, 0, 0
        self.sought = 0
        """Where the last seek went: before a member's header."""
        self._differing: set[int] = set()  # a header is written again once its data is there

    def writable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        assert whence == io.SEEK_SET
        self._at = self.sought = offset
        return offset

    def tell(self) -> int:
        return self._at

    def write(self, data: bytes) -> int:  # type: ignore[override]
        start, self._at = self._at, self._at + len(data)
        self._end = max(self._end, self._at)
        self._stream.seek(start)
        there = self._stream.read(len(data))
        self._differing = {at for at in self._differing if not start <= at < self._at}
        if there != data:
            there = there.ljust(len(data), b"\0") if len(there) < len(data) else there
            self._differing |= {
                start + at for at, (a, b) in enumerate(zip(data, there, strict=True)) if a != b
            }
        return len(data)

    def is_equal(self) -> bool:
        """Tell whether the other holds all that was written last, and no more."""
        return not self._differing and self._stream.seek(0, io.SEEK_END) == self._end
