"""Independent points on several threads, in order; compiled code lets go of the interpreter."""

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Point = TypeVar("Point")
Result = TypeVar("Result")


def each(work: Callable[[Point], Result], points: Iterable[Point], threads: int) -> list[Result]:
    """Do the same work for every point; results in the points' order, whatever the threads.

    One thread is a thread of its own too: an interrupt (Ctrl-C) then reaches this one, which
    waits, and drops the points that have not begun.
    """
    pool = ThreadPoolExecutor(threads)
    try:
        return list(pool.map(work, points))
    finally:
        pool.shutdown(cancel_futures=True)
