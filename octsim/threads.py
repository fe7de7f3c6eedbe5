"""Independent points on several threads, in order; compiled code lets go of the interpreter."""

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Point = TypeVar("Point")
Result = TypeVar("Result")


def each(work: Callable[[Point], Result], points: Iterable[Point], threads: int) -> list[Result]:
    """Do the same work for every point; results in the points' order, whatever the threads."""
    if threads == 1:
        return [work(point) for point in points]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(work, points))
