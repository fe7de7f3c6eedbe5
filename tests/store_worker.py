"""Entries to test point stores with, and a process that uses one until it is killed."""

import hashlib
import logging
import random
import sys
from pathlib import Path

from octsim.instrument.point_store import PointStore

POINTS = 400
SIZE = 6_000
GIGABYTES = 0.0016
"""Room for about half of the points, so that entries are evicted all the time."""


def entry(number: int) -> tuple[bytes, bytes]:
    """Return the one right entry of a number."""
    key = hashlib.blake2b(b"%d" % number, digest_size=48).digest()
    return key, hashlib.shake_256(key).digest(SIZE + number)


ENTRIES = [entry(number) for number in range(POINTS)]
SOME = ENTRIES[:40]


def put(store: PointStore, entries: list[tuple[bytes, bytes]]) -> None:
    """Put entries, one after the other."""
    for key, body in entries:
        store.put(key, body)


def right(store: PointStore, entries: list[tuple[bytes, bytes]]) -> int:
    """Count what is found, all of which must be right."""
    found = [(body, store.get(key)) for key, body in entries]
    assert all(read in (None, body) for body, read in found)
    return sum(read is not None for _, read in found)


def work(file: Path, seed: int, notes: Path, turns: int) -> None:
    """Use a store at random, and note what should not be."""
    logging.basicConfig(filename=notes, format="%(message)s")
    draw, store = random.Random(seed), PointStore(file, GIGABYTES)
    for _ in range(turns):
        for key, body in draw.sample(ENTRIES, 20):
            found = store.get(key)
            if found is None:
                store.put(key, body)
            elif found != body:
                logging.error("a wrong value")


if __name__ == "__main__":
    work(Path(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3]), int(sys.argv[4]))
