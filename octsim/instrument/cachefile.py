"""The file of a point cache: an SQLite database, recognised before anything in it is touched."""

import contextlib
import errno
import fcntl
import os
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from weakref import WeakSet

from octsim.base.errors import CacheError

APPLICATION = 0x4F435450
"""In the header of each cache, whichever the version: OCTP."""
VERSION = 1
_MAGIC = b"SQLite format 3\0"
PATIENCE = 60_000
"""For other processes that write, ms."""
LARGEST_LOG = 16_000_000
"""Bytes beyond which the log of what was written is brought into the file, and cut back."""
_LOCKS = (512, 0x40000000)
"""Number and begin of the bytes that SQLite locks, one of them for as long as a file is open."""
_SCHEMA = (
    "PRAGMA auto_vacuum = INCREMENTAL",
    # bodies stand apart, so that marking or counting points reads none of them; keys stand in one
    # place, with no index that damage could tell apart from the table
    "CREATE TABLE points (key BLOB PRIMARY KEY, number INTEGER NOT NULL, used INTEGER NOT NULL,"
    " size INTEGER NOT NULL, checksum BLOB NOT NULL) WITHOUT ROWID",
    "CREATE TABLE bodies (number INTEGER PRIMARY KEY, body BLOB NOT NULL)",
    "CREATE TABLE rates (scheme TEXT PRIMARY KEY, points INTEGER NOT NULL,"
    " cpu_seconds REAL NOT NULL, bytes INTEGER NOT NULL)",
    "CREATE TABLE allowed (bytes INTEGER NOT NULL)",
    "INSERT INTO allowed VALUES (0)",
    f"PRAGMA application_id = {APPLICATION}",
    f"PRAGMA user_version = {VERSION}",
)
_TRANSIENT = {
    sqlite3.SQLITE_BUSY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR,
    sqlite3.SQLITE_LOCKED, sqlite3.SQLITE_NOMEM, sqlite3.SQLITE_PERM, sqlite3.SQLITE_PROTOCOL,
    sqlite3.SQLITE_READONLY,
}  # fmt: skip


class Connection(sqlite3.Connection):
    """A connection to a cache's file."""

    file: Path
    """Where it leads, resolved."""
    writable: bool

    def close(self) -> None:
        """Close it."""
        with _GUARD:
            super().close()
            _OPEN.discard(self)


_OPEN: WeakSet[Connection] = WeakSet()
_GUARD = threading.RLock()


def is_damage(error: sqlite3.Error) -> bool:
    """Tell whether an error comes from what is in a file, not from the disk or other processes."""
    return getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR) & 0xFF not in _TRANSIENT


@contextmanager
def transaction(connection: sqlite3.Connection) -> Iterator[None]:
    """Write all or nothing."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield
        connection.execute("COMMIT")
    except BaseException:
        with contextlib.suppress(sqlite3.Error):
            if connection.in_transaction:  # SQLite may have rolled back by itself
                connection.execute("ROLLBACK")
        raise


def connect(file: Path) -> Connection:
    """Open a cache's file, or make one; where it can't be written, for reading.

    The connection must not live through a fork.

    Raises
    ------
    CacheError
        If it is something else, or of a later version; nothing in it is changed.
    OSError
        If it is not there and can't be made, or can't be read.
    sqlite3.Error
        If it is damaged, or the disk fails.
    """
    with _GUARD:
        path = file.resolve()
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        if not _is_open(path):
            _recognise(path, file)
        if _can_write(path):
            return _prepared(_connection(path, "mode=rw", writable=True), file)
        try:
            return _prepared(_connection(path, "mode=ro", writable=False), file)
        except sqlite3.OperationalError:
            # no file of locks can be made beside it
            return _prepared(_connection(path, "mode=ro&immutable=1", writable=False), file)


def _can_write(path: Path) -> bool:
    """Tell whether a file can be written, and a log beside it."""
    ways = (path, os.W_OK), (path.parent, os.W_OK | os.X_OK)
    return all(os.access(place, mode, effective_ids=True) for place, mode in ways)


def _is_open(path: Path) -> bool:
    """Tell whether this process has a file open; if so, no other descriptor of it may be.

    Closing one lets go of all locks that the process has on the file, SQLite's too.
    """
    return any(connection.file == path for connection in _OPEN)


def _recognise(path: Path, file: Path) -> None:
    """Look whose a file is; fill it, if it is empty."""
    if path.is_dir():
        raise CacheError(f"{file}: is a folder, not a point cache; name a file")
    with path.open("rb") as stream:
        fcntl.lockf(stream, fcntl.LOCK_SH, *_LOCKS)  # not while another process fills it
        header = stream.read(100)
    if not header:
        _fill(path)
    elif int.from_bytes(header[68:72], "big") != APPLICATION:
        raise CacheError(f"{file}: is not a point cache of octsim; move it away or name another")
    else:
        _require_known(file, int.from_bytes(header[60:64], "big"))
        if not header.startswith(_MAGIC):
            raise sqlite3.DatabaseError("file is not a database")


def _fill(path: Path) -> None:
    """Write a cache without entries into an empty file, at once, so that it always has a header."""
    connection = sqlite3.connect(":memory:", isolation_level=None)
    with contextlib.closing(connection):
        for statement in _SCHEMA:
            connection.execute(statement)
        content = bytearray(connection.serialize())
    # of the format with a log from the start: to change to it is nothing that processes can do at
    # the same time
    content[18:20] = b"\2\2"
    with path.open("r+b", buffering=0) as stream:
        fcntl.lockf(stream, fcntl.LOCK_EX, *_LOCKS)
        if stream.read(1):
            return  # another process was faster
        try:
            if stream.write(content) < len(content):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            os.fsync(stream.fileno())
        except OSError:
            stream.truncate(0)
            raise


def _require_known(file: Path, version: int) -> None:
    if version > VERSION:
        raise CacheError(
            f"{file}: is a point cache of a later octsim (version {version}, known here are up to "
            f"{VERSION}); move it away or name another"
        )


def _connection(path: Path, how: str, *, writable: bool) -> Connection:
    connection = sqlite3.connect(
        f"{path.as_uri()}?{how}", uri=True, factory=Connection, isolation_level=None,
        timeout=PATIENCE / 1000, check_same_thread=False,
    )  # fmt: skip
    connection.file, connection.writable = path, writable
    connection.text_factory = bytes  # damage can make anything of a column, and no text is kept
    _OPEN.add(connection)
    return connection


def _prepared(connection: Connection, file: Path) -> Connection:
    try:
        (version,) = connection.execute("PRAGMA user_version").fetchone()
        _require_known(file, version)
        if connection.writable:
            connection.execute("PRAGMA synchronous = NORMAL")
            connection.execute(f"PRAGMA journal_size_limit = {LARGEST_LOG}")
        connection.execute("SELECT count(*) FROM rates").fetchone()
    except BaseException:
        connection.close()
        raise
    return connection


def erase(file: Path) -> None:
    """Make a cache an empty file, in place, without reading it or needing room on the disk.

    In place, as SQLite would take a new file's log for the old one's, and the reverse.

    Raises
    ------
    CacheError
        If it is open; nothing is changed.
    OSError
        If it can't be written.
    """
    in_use = CacheError(
        f"{file}: is damaged, or its disk is full, and it is in use; clear it when nothing uses it"
    )
    with _GUARD:
        path = file.resolve()
        if _is_open(path):
            raise in_use
        with path.open("r+b") as stream:
            try:
                fcntl.lockf(stream, fcntl.LOCK_EX | fcntl.LOCK_NB, *_LOCKS)
            except BlockingIOError:
                raise in_use from None
            for suffix in ("-wal", "-shm", "-journal"):
                path.with_name(path.name + suffix).unlink(missing_ok=True)
            stream.truncate(0)
