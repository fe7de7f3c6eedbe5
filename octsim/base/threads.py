"""Independent points on several threads, in order; compiled code lets go of the interpreter."""

import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import groupby, islice
from typing import TypeVar

Point = TypeVar("Point")
Result = TypeVar("Result")
Block = TypeVar("Block")
_LONG = 5e-3  # s; points that take less are handed out several at a time
_MOST = 16


def each(
    work: Callable[[Point], Result], points: Iterable[Point], threads: int
) -> Iterator[Result]:
    """Do the same work for every point; results in the points' order, whatever the threads.

    Points are taken, and results held, a few ahead of what is asked for. One thread is a thread
    of its own too: an interrupt (Ctrl-C) then reaches this one, which waits, and drops the points
    that have not begun.
    """
    left, size = iter(points), 1

    def together(some: list[Point]) -> list[Result]:
        nonlocal size
        begin = time.monotonic()
        found = [work(point) for point in some]
        alone = max((time.monotonic() - begin) / len(some), _LONG / _MOST)
        size = max(1, int(_LONG / alone))
        return found

    pool = ThreadPoolExecutor(threads)
    waiting: deque[Future[list[Result]]] = deque()
    try:
        while True:
            while len(waiting) < 2 * threads + 1 and (some := list(islice(left, size))):
                waiting.append(pool.submit(together, some))
            if not waiting:
                return
            yield from waiting.popleft().result()
    finally:
        pool.shutdown(cancel_futures=True)


def each_block(
    work: Callable[[Point], Result],
    blocks: Sequence[Block],
    points_of: Callable[[Block], Iterable[Point]],
    threads: int,
) -> Iterator[tuple[Block, list[Result]]]:
    """Do the same work for the points of each block, as `each`, without a pause between blocks."""
    numbered = ((number, point) for number, b in enumerate(blocks) for point in points_of(b))
    results = each(lambda one: (one[0], work(one[1])), numbered, threads)
    for number, found in groupby(results, key=lambda one: one[0]):
        yield blocks[number], [result for _, result in found]
