"""The point cache: light that was traced before, found by its content's key.

It saves time and never decides a result: whatever goes wrong with its file, points are missing from
it and are traced.
"""

import logging
import os
import sqlite3
import threading
import time
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from typing import Self
from weakref import WeakSet

from octsim.base.errors import CacheError
from octsim.base.files import reason
from octsim.instrument.cachefile import Connection, connect, erase, is_damage, transaction
from octsim.instrument.cachetables import (
    Description,
    Rate,
    Row,
    add_to_rate,
    drop,
    empty,
    find,
    keep,
    mark,
    rate_of,
    row_of,
    shorten,
    summary,
)

_LOGGER = logging.getLogger(__name__)
_MOST_MARKS = 10_000  # that wait in memory


class PointCache:
    """Entries of bytes, each under a key, in a file that several processes and threads share.

    Parameters
    ----------
    file : Path
        Of the cache; made where there is none.
    gigabytes : float
        Size of the file, 10⁹ bytes; beyond it the entries go that are unused for longest.

    Raises
    ------
    CacheError
        If the file is something else than a cache, or one of a later version.
    """

    def __init__(self, file: Path, gigabytes: float) -> None:
        self.file = file
        self._allowed = round(gigabytes * 1e9)
        self._lock = threading.Lock()
        self._connection: Connection | None = None
        self._reads = self._keeps = True
        self._used: dict[bytes, int] = {}
        with self._lock:
            _CACHES.add(self)
            self._open()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:  # fmt: skip
        self.close()

    def get(self, key: bytes) -> bytes | None:
        """Give what was put under a key; None if there is nothing, or it is damaged."""
        with self._lock:
            try:
                connection = self._open()
                body = find(connection, key) if connection else None
            except ValueError:
                self._drop(key)
                return None
            except sqlite3.Error as error:
                self._give_up(error)
                return None
            if body is not None:
                self._note(key)
            return body

    def put(self, entries: Iterable[tuple[bytes, bytes]]) -> None:
        """Keep entries of key and body, all or none, in the place of what had the same keys.

        Older entries make room, least recently used first. What was used since is noted too.
        """
        begin = time.time_ns()
        rows = [row_of(key, body, used) for used, (key, body) in enumerate(entries, begin)]
        with self._lock:
            self._put(rows)

    def record(self, scheme: str, points: int, cpu_seconds: float, size: int) -> None:
        """Add what points of a scheme took: processor time, s, and bytes of their entries."""
        with self._lock:
            try:
                connection = self._writable()
                if connection:
                    add_to_rate(connection, scheme, Rate(points, cpu_seconds, size))
            except sqlite3.Error as error:
                self._stop_keeping(error)

    def rates(self, scheme: str) -> Rate | None:
        """Give what points of a scheme took so far, if any were recorded."""
        with self._lock:
            try:
                connection = self._open()
                return rate_of(connection, scheme) if connection else None
            except sqlite3.Error as error:
                self._give_up(error)
                return None

    def close(self) -> None:
        """Note what was used, and let go of the file."""
        with self._lock:
            if self._used:
                self._put([])
            self._let_go()
            self._reads = False

    def _open(self) -> Connection | None:
        if self._connection is None and self._reads:
            try:
                self._connection = connect(self.file)
            except OSError as error:
                self._reads = False
                self._warn(f"can't be opened ({reason(error)}); new points are not kept")
            except sqlite3.Error as error:
                self._give_up(error)
            else:
                if not self._connection.writable and self._keeps:
                    self._keeps = False
                    self._warn("can't be written; it is read, but new points are not kept")
        return self._connection

    def _writable(self) -> Connection | None:
        connection = self._open()
        return connection if self._keeps else None

    def _put(self, rows: list[Row]) -> None:
        used, self._used = self._used, {}
        try:
            connection = self._writable()
            if connection is None or not (rows or used):
                return
            with transaction(connection):
                mark(connection, used)
                keep(connection, rows, self._allowed)
            shorten(connection, self._allowed)
        except sqlite3.Error as error:
            self._stop_keeping(error)

    def _note(self, key: bytes) -> None:
        self._used[key] = time.time_ns()
        if len(self._used) >= _MOST_MARKS:
            self._put([])

    def _drop(self, key: bytes) -> None:
        self._warn("a damaged point is left out, and traced anew")
        connection = self._writable()
        if connection:
            try:
                with transaction(connection):
                    drop(connection, key)
            except sqlite3.Error as error:
                self._stop_keeping(error)

    def _stop_keeping(self, error: sqlite3.Error) -> None:
        if is_damage(error):
            self._give_up(error)
        else:
            self._keeps = False
            self._warn(f"can't be written ({reason(error)}); new points are no longer kept")

    def _give_up(self, error: sqlite3.Error) -> None:
        self._let_go()
        self._reads = False
        if is_damage(error):
            self._warn(f"damaged ({reason(error)}); going on without it; {_remedy(self.file)}")
        else:
            self._warn(f"can't be read ({reason(error)}); going on without it")

    def _warn(self, text: str) -> None:
        _LOGGER.warning("octsim: warning: %s: %s", self.file, text)

    def _let_go(self) -> None:
        if self._connection is not None:
            self._connection.close()
            self._connection = None


class NoCache(PointCache):
    """A cache that keeps nothing and has no file."""

    def __init__(self, file: Path) -> None:
        super().__init__(file, 0)

    def _open(self) -> None:
        return None


def opened(file: Path, gigabytes: float) -> PointCache:
    """Open a cache; of no gigabytes, one that keeps nothing and reads nothing.

    Raises
    ------
    CacheError
        As `PointCache`.
    """
    return PointCache(file, gigabytes) if gigabytes > 0 else NoCache(file)


def describe(file: Path) -> Description | None:
    """Tell what a cache holds; None if there is no such file.

    Raises
    ------
    CacheError
        If it is no cache, of a later version, damaged or can't be read.
    """
    if not file.exists():
        return None
    try:
        connection = connect(file)
        try:
            return summary(connection)
        finally:
            connection.close()
    except (OSError, sqlite3.Error) as error:
        if isinstance(error, sqlite3.Error) and is_damage(error):
            raise CacheError(f"{file}: damaged ({reason(error)}); {_remedy(file)}") from None
        raise CacheError(f"{file}: can't be read ({reason(error)})") from None


def clear(file: Path) -> None:
    """Empty a cache, also while runs have it open; a damaged one only when none has.

    Raises
    ------
    CacheError
        If it is no cache, of a later version, can't be written, or is damaged and open.
    """
    if not file.exists():
        return
    try:
        try:
            connection = connect(file)
            try:
                if not connection.writable:
                    raise PermissionError("it, or its folder, can't be written")
                empty(connection)
            finally:
                connection.close()
        except sqlite3.Error:
            erase(file)
    except OSError as error:
        raise CacheError(f"{file}: can't be cleared ({reason(error)})") from None


def _remedy(file: Path) -> str:
    return f"`octsim cache clear --file {file}` makes a new one"


_CACHES: WeakSet[PointCache] = WeakSet()
_held: list[PointCache] = []


def _before_fork() -> None:
    # a connection must not live through a fork: each side opens its own when it needs one
    for cache in list(_CACHES):
        cache._lock.acquire()
        _held.append(cache)
        cache._let_go()


def _after_fork() -> None:
    while _held:
        _held.pop()._lock.release()


os.register_at_fork(before=_before_fork, after_in_parent=_after_fork, after_in_child=_after_fork)
