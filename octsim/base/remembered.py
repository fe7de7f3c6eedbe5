"""What pure functions of frozen things have found before, by which things they are."""

import functools
from collections.abc import Callable
from typing import TypeVar, TypeVarTuple

_MOST = 4096
"""Of what a function has found, and holds meanwhile."""
_Things = TypeVarTuple("_Things")
_Found = TypeVar("_Found")


def remembered(function: Callable[[*_Things], _Found]) -> Callable[[*_Things], _Found]:
    """Return a pure function of frozen things that works once for the same of them."""
    # by which things they are, as comparing what is in them takes longer; held, so that they stay
    # the only ones of their numbers
    found: dict[tuple[int, ...], tuple[object, _Found]] = {}

    @functools.wraps(function)
    def asked(*things: *_Things) -> _Found:
        which = tuple(map(id, things))
        before = found.get(which)
        if before is not None:
            return before[1]
        result = function(*things)
        if len(found) >= _MOST:
            found.clear()
        found[which] = things, result
        return result

    return asked
