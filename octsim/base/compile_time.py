"""What this process has spent on compiling, or on waiting for it, for who times something else."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock


class _Spent:
    """Seconds in which some thread was at it."""

    lock = Lock()
    threads = 0
    began = 0.0
    seconds = 0.0


@contextmanager
def counted() -> Iterator[None]:
    """Count what is done within; what several threads do at a time counts once."""
    with _Spent.lock:
        if _Spent.threads == 0:
            _Spent.began = time.monotonic()
        _Spent.threads += 1
    try:
        yield
    finally:
        with _Spent.lock:
            _Spent.threads -= 1
            if _Spent.threads == 0:
                _Spent.seconds += time.monotonic() - _Spent.began


def compiled_for() -> float:
    """Return the seconds counted since this was asked last."""
    with _Spent.lock:
        seconds, _Spent.seconds = _Spent.seconds, 0.0
    return seconds
