"""What pure functions of frozen things have found before, by which thing it is."""

import functools
from collections.abc import Callable
from typing import Any, TypeVar

_MOST = 4096
"""Of things that a function remembers, and holds meanwhile."""
_Thing = TypeVar("_Thing")
_Found = TypeVar("_Found")


class _Same:
    """A thing that is equal to itself alone: comparing what is in it takes longer."""

    __slots__ = ("thing",)

    def __init__(self, thing: Any) -> None:
        self.thing = thing

    def __hash__(self) -> int:
        return id(self.thing)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and self.thing is other.thing


def remembered(function: Callable[[_Thing], _Found]) -> Callable[[_Thing], _Found]:
    """Return a pure function of frozen things that works once for each of them."""

    @functools.lru_cache(maxsize=_MOST)
    def found(same: _Same) -> _Found:
        return function(same.thing)

    @functools.wraps(function)
    def asked(thing: _Thing) -> _Found:
        return found(_Same(thing))

    return asked
