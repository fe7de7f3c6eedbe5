"""The tables of a point cache: entries found, kept and evicted; what points have cost."""

import sqlite3
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import xxhash

from octsim.instrument.cachefile import LARGEST_LOG, PATIENCE, Connection, transaction

_LEFT_AFTER_EVICTION = 0.9
_PAUSE = 500  # ms, for those who read to let the log be cut
_FIND = "SELECT checksum, body FROM points JOIN bodies USING (number) WHERE key = ?"
_OLDEST = """
    SELECT key, number FROM (
        SELECT key, number, sum(size) OVER (ORDER BY used, number) - size AS older FROM points
    ) WHERE older < ? * (SELECT sum(size) FROM points)"""
_ADD = """
    INSERT INTO rates VALUES (?, ?, ?, ?)
    ON CONFLICT (scheme) DO UPDATE
    SET points = points + excluded.points, cpu_seconds = cpu_seconds + excluded.cpu_seconds,
        bytes = bytes + excluded.bytes"""
# cast, as damage can make anything of a column
_RATE = """
    SELECT CAST(points AS INTEGER), CAST(cpu_seconds AS REAL), CAST(bytes AS INTEGER)
    FROM rates WHERE scheme = ?"""
_SUMMARY = """
    SELECT count(*), CAST(min(used) AS INTEGER), CAST(max(used) AS INTEGER),
        (SELECT CAST(max(bytes) AS INTEGER) FROM allowed)
    FROM points"""


class Rate(NamedTuple):
    """What points of a scheme have cost so far, in all."""

    points: int
    cpu_seconds: float
    bytes: int
    """Of their entries."""


class Description(NamedTuple):
    """What a cache holds."""

    entries: int
    bytes: int
    """Of the file that are in use."""
    allowed: int
    """Bytes that the last run to write in it allowed; 0 if none has."""
    oldest: int | None
    """When the entry that is unused for longest was used, ns since 1970."""
    newest: int | None
    """When an entry was last used."""
    version: int


class Row(NamedTuple):
    """An entry to be kept."""

    key: bytes
    used: int
    size: int
    checksum: bytes
    body: bytes


def row_of(key: bytes, body: bytes, used: int) -> Row:
    """Make an entry's row, used at a time in ns since 1970."""
    return Row(key, used, len(body), _checksum(key, body), body)


def _checksum(key: bytes, body: bytes) -> bytes:
    return xxhash.xxh3_128_digest(key + body)


def find(connection: sqlite3.Connection, key: bytes) -> bytes | None:
    """Give an entry's body; None if there is no entry.

    Raises
    ------
    ValueError
        If the entry is damaged.
    """
    found = connection.execute(_FIND, (key,)).fetchone()
    if found is None:
        return None
    checksum, body = found
    if not isinstance(body, bytes) or checksum != _checksum(key, body):
        raise ValueError("the checksum is not that of the key and the body")
    return body


def mark(connection: sqlite3.Connection, used: Mapping[bytes, int]) -> None:
    """Note when keys were used, ns since 1970."""
    connection.executemany(
        "UPDATE points SET used = max(used, ?) WHERE key = ?",
        [(when, key) for key, when in used.items()],
    )


def keep(connection: sqlite3.Connection, rows: Iterable[Row], allowed: int) -> None:
    """Add entries, or replace them, and evict what goes beyond the bytes that are allowed."""
    rows = list(rows)
    _make_room(connection, allowed, sum(row.size for row in rows))
    for row in rows:
        before = connection.execute("SELECT number FROM points WHERE key = ?", row[:1]).fetchone()
        number = connection.execute(
            "REPLACE INTO bodies VALUES (?, ?)", (before[0] if before else None, row.body)
        ).lastrowid
        connection.execute(
            "REPLACE INTO points VALUES (?, ?, ?, ?, ?)",
            (row.key, number, row.used, row.size, row.checksum),
        )
    # what they take in pages is a little more
    _make_room(connection, allowed, 0)
    connection.execute("UPDATE allowed SET bytes = ?1 WHERE bytes <> ?1", (allowed,))


def _make_room(connection: sqlite3.Connection, allowed: int, coming: int) -> None:
    """Delete what is unused for longest, if so many bytes more would not fit; some to spare."""
    in_use = _bytes_in_use(connection)
    if in_use + coming > allowed:
        # as a share, since pages are seldom full
        share = (in_use + coming - _LEFT_AFTER_EVICTION * allowed) / in_use
        oldest = connection.execute(_OLDEST, (share,)).fetchall()
        connection.executemany("DELETE FROM points WHERE key = ?", [row[:1] for row in oldest])
        connection.executemany("DELETE FROM bodies WHERE number = ?", [row[1:] for row in oldest])


def drop(connection: sqlite3.Connection, key: bytes) -> None:
    """Delete an entry."""
    connection.execute(
        "DELETE FROM bodies WHERE number = (SELECT number FROM points WHERE key = ?)", (key,)
    )
    connection.execute("DELETE FROM points WHERE key = ?", (key,))


def shorten(connection: Connection, allowed: int) -> None:
    """Give back free pages beyond the size, as when less is allowed than before, and a long log."""
    beyond = _number(connection, "page_count") - allowed // _number(connection, "page_size")
    if beyond > 0:
        # as a script, since it is one step a page, of which `execute` takes the first alone
        connection.executescript(f"PRAGMA incremental_vacuum ({beyond})")
    log = connection.file.with_name(connection.file.name + "-wal")
    if log.exists() and log.stat().st_size > LARGEST_LOG:
        # while there is always somebody who reads, SQLite would let it grow
        connection.execute(f"PRAGMA busy_timeout = {_PAUSE}")
        connection.execute("PRAGMA wal_checkpoint (TRUNCATE)")
        connection.execute(f"PRAGMA busy_timeout = {PATIENCE}")


def empty(connection: sqlite3.Connection) -> None:
    """Delete everything, in a transaction, and give its room back."""
    with transaction(connection):
        for table in ("bodies", "points", "rates"):
            connection.execute(f"DELETE FROM {table}")
    connection.execute("VACUUM")
    connection.execute("PRAGMA wal_checkpoint (TRUNCATE)")


def add_to_rate(connection: sqlite3.Connection, scheme: str, cost: Rate) -> None:
    """Add what some points of a scheme cost."""
    connection.execute(_ADD, (scheme, *cost))


def rate_of(connection: sqlite3.Connection, scheme: str) -> Rate | None:
    """Give what points of a scheme cost so far, if any were recorded."""
    found = connection.execute(_RATE, (scheme,)).fetchone()
    return Rate(*found) if found else None


def summary(connection: sqlite3.Connection) -> Description:
    """Tell what a cache holds."""
    entries, oldest, newest, allowed = connection.execute(_SUMMARY).fetchone()
    return Description(
        entries, _bytes_in_use(connection), allowed, oldest, newest,
        _number(connection, "user_version"),
    )  # fmt: skip


def _bytes_in_use(connection: sqlite3.Connection) -> int:
    pages = _number(connection, "page_count") - _number(connection, "freelist_count")
    return pages * _number(connection, "page_size")


def _number(connection: sqlite3.Connection, pragma: str) -> int:
    (value,) = connection.execute(f"PRAGMA {pragma}").fetchone()
    return int(value)
