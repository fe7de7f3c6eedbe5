"""Long walks through many small things: how far one is, and none of the time that nobody needs."""

import gc
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from octsim.base.say import CLEAR, note

_Thing = TypeVar("_Thing")
_LONG = 2.0  # s, before which nobody wonders
_BETWEEN = 0.5  # s, between what is shown
_BAR = 20  # characters
_SOME = 64  # things between looks at the clock


def watched(things: Iterable[_Thing], count: int, what: str) -> Iterator[_Thing]:
    """Yield things; where that takes long, show on a terminal, or by its run, how many are done.

    Parameters
    ----------
    things : iterable
    count : int
        How many there are.
    what : str
        What is done with them, in a few words.
    """
    shown, due = False, time.monotonic() + _LONG
    try:
        for done, thing in enumerate(things):
            if done % _SOME == 0 and time.monotonic() > due:
                due = time.monotonic() + _BETWEEN
                text = f"{what}: {bar(done, count)}"
                if not note(text) and sys.stderr.isatty():
                    print(f"{CLEAR}octsim: {text}", end="", file=sys.stderr, flush=True)
                    shown = True
            yield thing
    finally:
        note("")
        if shown:
            print(CLEAR, end="", file=sys.stderr, flush=True)


def bar(done: int, count: int) -> str:
    """Return how many of some things are done, drawn and in numbers.

    Examples
    --------
    >>> bar(250, 1000)
    '[#####---------------] 250 of 1000'
    """
    full = _BAR * done // count
    return f"[{'#' * full}{'-' * (_BAR - full)}] {done} of {count}"


@contextmanager
def uncollected() -> Iterator[None]:
    """Look for no cycles of things meanwhile: where a million things are in none, it takes time."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()
