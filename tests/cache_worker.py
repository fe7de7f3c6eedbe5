"""Entries to test caches with, and a process that uses one until it is killed."""

import contextlib
import hashlib
import logging
import random
import sqlite3
import sys
from pathlib import Path

from octsim.instrument.cache import PointCache, describe

POINTS = 400
SIZE = 6_000
GIGABYTES = 0.0015
"""Room for about half of the points, so that entries are evicted all the time."""


def entry(number: int) -> tuple[bytes, bytes]:
    """Give the one right entry of a number."""
    key = hashlib.blake2b(b"%d" % number, digest_size=48).digest()
    return key, hashlib.shake_256(key).digest(SIZE + number)


ENTRIES = [entry(number) for number in range(POINTS)]
SOME = ENTRIES[:40]


def work(file: Path, seed: int, notes: Path, turns: int) -> None:
    """Use the cache at random, and note what should not be."""
    logging.basicConfig(filename=notes, format="%(message)s")
    draw = random.Random(seed)
    with PointCache(file, GIGABYTES) as cache:
        for _ in range(turns):
            missing = []
            for number in draw.sample(range(POINTS), 20):
                key, body = entry(number)
                found = cache.get(key)
                if found is None:
                    missing.append((key, body))
                elif found != body:
                    logging.error("a wrong value")
            cache.put(missing)


def right(cache: PointCache, entries: list[tuple[bytes, bytes]]) -> int:
    """Count what is found, all of which must be right."""
    found = [(body, cache.get(key)) for key, body in entries]
    assert all(read in (None, body) for body, read in found)
    return sum(read is not None for _, read in found)


def log(file: Path) -> Path:
    return file.with_name(file.name + "-wal")


def in_use(file: Path) -> int:
    held = describe(file)
    assert held is not None
    return held.bytes


def in_order(file: Path) -> bool:
    connection = sqlite3.connect(file)
    with contextlib.closing(connection):
        answers = connection.execute("PRAGMA integrity_check").fetchall()
        (strays,) = connection.execute(
            "SELECT (SELECT count(*) FROM points) - count(*) FROM points JOIN bodies USING (number)"
        ).fetchone()
        (more,) = connection.execute(
            "SELECT (SELECT count(*) FROM bodies) - count(*) FROM points JOIN bodies USING (number)"
        ).fetchone()
    return answers == [("ok",)] and strays == more == 0


if __name__ == "__main__":
    work(Path(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3]), int(sys.argv[4]))
