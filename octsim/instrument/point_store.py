"""Light that was traced before, kept by its content's key: a folder with a file for each point.

It saves time and never decides a result: whatever is wrong with its files, points are missing from
it and are traced. A file is written under another name and renamed, so that threads, processes and
machines share a folder without locks.
"""

import json
import logging
import os
import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from hashlib import blake2b
from operator import add
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from octsim.base.errors import CacheError
from octsim.base.files import reason
from octsim.instrument.point_folder import (
    VERSION,
    described,
    expanded_path,
    folder_of,
    make_folder,
    old_cache,
    old_cache_remark,
    write,
)

if TYPE_CHECKING:
    from octsim.config.models import Cache

_LOGGER = logging.getLogger(__name__)
_BEGIN = b"octsim point 2\n\0"  # of each file; a checksum follows, then the body
_CHECKSUM = 16
_BLOCK = 4096  # bytes; the disk gives a file whole ones
_FOLDERS = range(256)  # that the files are in, by the first two digits of their names
_POINT = re.compile("[0-9a-f]{30}([.][0-9a-f]{16}~)?")  # or what a killed process left of one
_RATES = "octsim-rates.jsonl"
_LONGEST_RATES = 65_536  # bytes
_FULL, _LEFT = 0.85, 0.75  # of the size; beyond the one, points are evicted down to the other
_LOOKS = 16  # while as much is written as the size
_LEAST_SHARE = 12e6  # bytes, of the size that is looked over at once


class Rate(NamedTuple):
    """What points of a scheme have cost, in all."""

    points: int = 0
    cpu_seconds: float = 0.0
    """Processor time."""
    bytes: int = 0
    """Of their bodies."""

    def and_also(self, other: "Rate") -> "Rate":
        """Return what the points of two have cost together."""
        return Rate(*map(add, self, other))


class Description(NamedTuple):
    """What a store holds."""

    points: int
    bytes: int
    """Of the disk, in whole blocks."""
    allowed: int
    """Bytes that the last run to write in it allowed; 0 if that is not known."""
    oldest: float | None
    """When the point that is unused for longest was used, s since 1970."""
    newest: float | None
    """When a point was last used."""
    version: int


class PointStore:
    """Bodies of bytes, each under a key, in a folder that many share; made with the first of them.

    Parameters
    ----------
    file : Path
        Name of the folder (`octsim.instrument.point_folder.folder_of`).
    gigabytes : float
        Size of all files, 10⁹ bytes; before it is reached, the points go that are unused for
        longest.

    Raises
    ------
    CacheError
        If something else than a store is there, or one of a later version.
    """

    def __init__(self, file: Path, gigabytes: float) -> None:
        self.folder = folder_of(file)
        self._allowed, self._old = round(gigabytes * 1e9), old_cache(file)
        self._is_made, self._keeps = False, True
        self._unsaid = {"damaged", "read", "written"}

    def get(self, key: bytes) -> bytes | None:
        """Return what was put under a key, now marked as used; None if it is missing or damaged."""
        file = self.folder / _name(key)
        try:
            content = file.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            self._warn("read", f"can't be read ({reason(error)}); what is missing is traced")
            return None
        body = content[len(_BEGIN) + _CHECKSUM :]
        if content != _content(key, body):
            self._warn("damaged", "a damaged point is left out, and traced anew")
            return None
        with suppress(OSError):  # it may be for reading only
            os.utime(file)
        return body

    def put(self, key: bytes, body: bytes) -> None:
        """Keep a body, in the place of what had the same key; older points may make room.

        One that would take the room of all others is not kept.
        """
        name, content = _name(key), _content(key, body)
        size = _on_disk(len(content))
        try:
            if size <= _LEFT * self._allowed and self._can_keep():
                write(self.folder / name, content)
                self._make_room(name, size)
        except OSError as error:
            self._stop_keeping(error)

    def record(self, scheme: str, cost: Rate) -> None:
        """Add what points of a scheme took."""
        file, line = self.folder / _RATES, json.dumps([scheme, *cost])
        try:
            if self._can_keep():
                with file.open("ab", buffering=0) as stream:
                    # in one go; on a line of its own, whatever a killed process has left before
                    stream.write(f"\n{line}\n".encode())
                    is_long = stream.tell() > _LONGEST_RATES
                if is_long:
                    sums = (json.dumps([name, *rate]) for name, rate in _rates(file).items())
                    write(file, "\n".join(sums).encode())
        except OSError as error:
            self._stop_keeping(error)

    def rates(self, scheme: str) -> Rate | None:
        """Return what points of a scheme took so far, if any were recorded."""
        try:
            return _rates(self.folder / _RATES).get(scheme)
        except OSError:
            return None

    def _can_keep(self) -> bool:
        if self._keeps and not self._is_made:
            if self._old and not self.folder.exists():
                _LOGGER.warning("octsim: warning: %s", old_cache_remark(self._old))
            make_folder(self.folder, self._allowed)
            self._is_made = True
        return self._keeps

    def _make_room(self, name: str, written: int) -> None:
        """Now and then look over a share of the folders, and evict from it what is too much.

        All shares fill alike, as names are digests. Where points are large, shares are too.
        """
        shares = min(256, max(1, int(self._allowed / max(_LEAST_SHARE, _LOOKS * written))))
        folder, chance = int(name[:2], 16), int(name[3:11], 16) / 16**8
        # a digest is as good as chance; so no process needs to count, however many write
        if chance * self._allowed > _LOOKS * written * shares:
            return
        share = [n for n in _FOLDERS if n * shares // 256 == folder * shares // 256]
        points = sorted(_points(self.folder, share))
        used, allowed = sum(size for _, size, _ in points), self._allowed * len(share) / 256
        if used > _FULL * allowed:
            for _, size, path in points:
                if used <= _LEFT * allowed:
                    break
                Path(path).unlink(missing_ok=True)
                used -= size

    def _stop_keeping(self, error: OSError) -> None:
        if not isinstance(error, FileNotFoundError):  # as when the folder is removed meanwhile
            self._keeps = False
            self._warn("written", f"can't be written ({reason(error)}); new points are not kept")

    def _warn(self, kind: str, text: str) -> None:
        with suppress(KeyError):
            self._unsaid.remove(kind)
            _LOGGER.warning("octsim: warning: %s: %s", self.folder, text)


def open_store(cache: "Cache") -> PointStore | None:
    """Return the store that a config names; None of no gigabytes, which keep and read nothing.

    Raises
    ------
    ConfigError
        If its name has an environment variable that is not set.
    CacheError
        As `PointStore`.
    """
    file = expanded_path(cache.file)
    return PointStore(file, cache.gigabytes) if cache.gigabytes else None


def describe(file: Path) -> Description | None:
    """Return what the store of a name holds; None if there is none.

    Raises
    ------
    CacheError
        If it is something else, of a later version, or can't be read.
    """
    folder = folder_of(file)
    try:
        if not folder.exists():
            return None
        points = list(_points(folder, _FOLDERS))
        used = [when for when, _, path in points if not path.endswith("~")]
        return Description(
            len(used), sum(size for _, size, _ in points), described(folder).get("allowed", 0),
            min(used, default=None), max(used, default=None), VERSION,
        )  # fmt: skip
    except OSError as error:
        raise CacheError(f"{folder}: can't be read ({reason(error)})") from None


def clear(file: Path) -> int | None:
    """Remove all points, also while runs use them; return the bytes freed, None without a store.

    Raises
    ------
    CacheError
        If it is something else, of a later version, or can't be written.
    """
    folder, freed = folder_of(file), 0
    try:
        if not folder.exists():
            return None
        for _, size, path in _points(folder, _FOLDERS):
            Path(path).unlink(missing_ok=True)
            freed += size
        (folder / _RATES).unlink(missing_ok=True)
    except OSError as error:
        raise CacheError(f"{folder}: can't be cleared ({reason(error)})") from None
    return freed


def _rates(file: Path) -> dict[str, Rate]:
    """Return the sums of what was recorded, by scheme; a damaged line is left out."""
    sums: dict[str, Rate] = {}
    try:
        lines = file.read_bytes().splitlines()
    except FileNotFoundError:
        return sums
    for line in lines:
        try:
            scheme, points, seconds, size = json.loads(line)
            rate = Rate(int(points), float(seconds), int(size))
        except (ValueError, TypeError, OverflowError):
            continue
        if isinstance(scheme, str) and all(0 <= number < 1e15 for number in rate):
            sums[scheme] = sums.get(scheme, Rate()).and_also(rate)
    return sums


def _points(folder: Path, numbers: Iterable[int]) -> Iterator[tuple[float, int, str]]:
    """Yield when each point's file was used (s since 1970), its bytes on disk, and its path."""
    for number in numbers:
        try:
            entries = os.scandir(folder / f"{number:02x}")
        except (FileNotFoundError, NotADirectoryError):
            continue
        with entries:
            for entry in entries:
                if _POINT.fullmatch(entry.name) and entry.is_file(follow_symlinks=False):
                    with suppress(FileNotFoundError):
                        found = entry.stat(follow_symlinks=False)
                        yield found.st_mtime, _on_disk(found.st_size), entry.path


def _name(key: bytes) -> str:
    digest = blake2b(key, digest_size=16).hexdigest()
    return f"{digest[:2]}/{digest[2:]}"


def _content(key: bytes, body: bytes) -> bytes:
    """Return what a point's file holds: damaged, cut short or another's, it is not the same."""
    checksum = blake2b(key, digest_size=_CHECKSUM)
    checksum.update(body)
    return _BEGIN + checksum.digest() + body


def _on_disk(size: int) -> int:
    return -(-size // _BLOCK) * _BLOCK
