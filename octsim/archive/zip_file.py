"""A zip whose bytes follow from its contents alone.

Members are stored, not compressed, so that no version of a compressor matters, under sorted names,
with one date and one mode. There is one such zip of given contents: a check writes it again,
against the bytes that are there, so that not a bit of a header can differ.
"""

import io
import shutil
import stat
import zipfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from operator import attrgetter
from typing import IO, NamedTuple

from octsim.archive.checksums import DAMAGED, LARGEST, SUMS
from octsim.archive.safe_names import require_plain, shown
from octsim.base.errors import ArchiveError
from octsim.base.files import digest

_DATE = (1980, 1, 1, 0, 0, 0)
_MODE = (stat.S_IFREG | 0o644) << 16
_UNIX = 3
_PIECE = 1 << 20
# all that the library raises for bytes that are no zip
_NO_ZIP = (zipfile.BadZipFile, ValueError, RuntimeError, LookupError, EOFError, OverflowError)


class Member(NamedTuple):
    """A file to be put in."""

    name: str
    size: int
    """Bytes."""
    open: Callable[[], IO[bytes]]
    """Opens what it holds."""


def write(stream: IO[bytes], members: Iterable[Member]) -> None:
    """Write a zip, in order of the names, piece by piece."""
    with zipfile.ZipFile(stream, "w") as archive:
        for member in sorted(members, key=attrgetter("name")):
            info = zipfile.ZipInfo(member.name, _DATE)
            info.create_system, info.external_attr = _UNIX, _MODE
            info.file_size = member.size  # decides whether its header is one for more than 4 GB
            with member.open() as data, archive.open(info, "w") as out:
                shutil.copyfileobj(data, out, _PIECE)


@contextmanager
def safe_zip(stream: IO[bytes]) -> Iterator[zipfile.ZipFile]:
    """Return a zip that is safe to read and to unpack, by what its directory states.

    Raises
    ------
    ArchiveError
        If it is not a zip, or one that is not safe.
    """
    size = stream.seek(0, io.SEEK_END)
    try:
        with zipfile.ZipFile(_Bounded(stream)) as archive:
            _require_safe(archive.infolist(), size)
            yield archive
    except _NO_ZIP as error:
        raise ArchiveError(f"not a zip that is whole ({error})") from None


def _require_safe(infos: list[zipfile.ZipInfo], size: int) -> None:
    require_plain(info.orig_filename for info in infos)
    for info in infos:
        if info.external_attr != _MODE:
            kind = "a link" if stat.S_ISLNK(info.external_attr >> 16) else "not a plain file"
            raise ArchiveError(f"holds {shown(info.orig_filename)}, which is {kind}")
        if info.compress_type != zipfile.ZIP_STORED or info.compress_size != info.file_size:
            raise ArchiveError(f"holds {info.filename} compressed, as octsim packs no file")
    if sum(info.file_size for info in infos) > size:
        raise ArchiveError("states that it holds more than it can")


def digests_in(archive: zipfile.ZipFile) -> dict[str, str]:
    """Return the SHA-256 of each member by name; `DAMAGED` for one that is not whole."""
    digests = {}
    for info in archive.infolist():
        try:
            with archive.open(info) as data:
                digests[info.filename] = digest(data)
        except _NO_ZIP:
            digests[info.filename] = DAMAGED
    return digests


def is_canonical(archive: zipfile.ZipFile, stream: IO[bytes]) -> bool:
    """Return whether a stream holds the zip that `write` makes of an archive's members.

    Parameters
    ----------
    archive : ZipFile
        Whose members are whole.
    stream : file
        That the archive is read from.
    """
    there = _Comparison(stream)
    write(
        there,  # type: ignore[arg-type]
        (
            Member(one.filename, one.file_size, partial(archive.open, one))
            for one in archive.infolist()
        ),
    )
    return there.is_equal()


class _Bounded:
    """A stream of which nobody reads much at once, as a directory that is far too large would."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self.seek, self.tell, self.seekable = stream.seek, stream.tell, stream.seekable

    def read(self, size: int = -1, /) -> bytes:
        piece = self._stream.read(min(size, LARGEST + 1) if size >= 0 else LARGEST + 1)
        if len(piece) > LARGEST:
            raise ArchiveError(f"its directory is larger than that of any archive, or its {SUMS}")
        return piece


class _Comparison:
    """A file that is written to only to learn whether another holds what is written."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream, self._at = stream, 0
        # by place, as a header is written again once its member's data is there
        self._equal: dict[int, bool] = {}

    def seek(self, offset: int) -> int:
        self._at = offset
        return offset

    def tell(self) -> int:
        return self._at

    def flush(self) -> None:
        """Do nothing: nothing is held back."""

    def write(self, data: bytes) -> int:
        self._stream.seek(self._at)
        self._equal[self._at] = self._stream.read(len(data)) == data
        self._at += len(data)
        return len(data)

    def is_equal(self) -> bool:
        """Return whether the other holds all that was written last, and no more."""
        return all(self._equal.values()) and self._stream.seek(0, io.SEEK_END) == self._at
