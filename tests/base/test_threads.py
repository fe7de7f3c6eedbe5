"""Independent points on threads: in order, and no further ahead than needed."""

import itertools
import threading
import time

import pytest

from octsim.base.threads import each, each_block


@pytest.mark.parametrize("threads", [1, 3])
def test_results_come_in_the_order_of_the_points(threads: int) -> None:
    def work(number: int) -> int:
        time.sleep(0.002 * (number % 3))
        return number * number

    assert list(each(work, range(200), threads)) == [n * n for n in range(200)]


def test_endless_points_are_taken_a_few_ahead_alone() -> None:
    taken = itertools.count()
    results = each(lambda number: number, taken, 2)
    assert list(itertools.islice(results, 100)) == list(range(100))
    results.close()  # type: ignore[attr-defined]
    assert next(taken) < 100 + 64 * 6


def test_long_points_go_to_all_threads_at_once() -> None:
    together = threading.Barrier(3, timeout=600)  # so that a wrong one ends at all

    def work(_: int) -> bool:
        time.sleep(0.02)
        return together.wait() >= 0

    assert list(each(work, range(6), 3)) == [True] * 6


def test_a_point_that_fails_stops_the_rest() -> None:
    done = []

    def work(number: int) -> None:
        if number == 5:
            raise ValueError("five")
        done.append(number)
        time.sleep(0.01)

    with pytest.raises(ValueError, match="five"):
        list(each(work, range(1000), 2))
    assert len(done) < 100


def test_blocks_get_their_own_points_results() -> None:
    blocks = ["abc", "", "d", "efghij"]
    found = list(each_block(str.upper, blocks, iter, 2))
    assert found == [("abc", ["A", "B", "C"]), ("d", ["D"]), ("efghij", list("EFGHIJ"))]
