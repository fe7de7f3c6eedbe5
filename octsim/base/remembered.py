"""What pure functions of frozen things have found before, by which thing it is."""

import functools
from collections.abc import Callable
from typing import TypeVar

_MOST = 4096
"""Of things that a function remembers, and holds meanwhile."""
_Thing = TypeVar("_Thing")
_Found = TypeVar("_Found")


def remembered(function: Callable[[_Thing], _Found]) -> Callable[[_Thing], _Found]:
    """Return a pure function of frozen things that works once for each of them."""
    # by which thing it is, as comparing what is in it takes longer; held, so that it stays the only
    # one of its number
    found: dict[int, tuple[_Thing, _Found]] = {}

    @functools.wraps(function)
    def asked(thing: _Thing) -> _Found:
        before = found.get(id(thing))
        if before is not None:
            return before[1]
        result = function(thing)
        if len(found) >= _MOST:
            found.clear()
        found[id(thing)] = thing, result
        return result

    return asked
