"""A process that reads and writes a cache until it is killed, and notes every wrong value."""

import hashlib
import logging
import random
import sys
from pathlib import Path

from octsim.cache import PointCache

POINTS = 400
SIZE = 6_000
GIGABYTES = 0.0015
"""Room for about half of the points, so that entries are evicted all the time."""


def entry(number: int) -> tuple[bytes, bytes]:
    """Give the one right entry of a number."""
    key = hashlib.blake2b(b"%d" % number, digest_size=48).digest()
    return key, hashlib.shake_256(key).digest(SIZE + number)


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


if __name__ == "__main__":
    work(Path(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3]), int(sys.argv[4]))
