"""How large a config may be: what goes beyond is refused at once, and not worked on."""

import itertools
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from octsim.base.errors import ConfigError, printable

MOST_BYTES = 16_000_000
"""Of a file."""
MOST_VALUES = 250_000
"""Keys and values together, each as often as anchors repeat it."""
MOST_PLAIN = 20_000
"""Of them, those that are neither of a grid nor of a table."""
DEEPEST = 20
"""Mappings and lists within each other."""
LONGEST_TEXT = 10_000
"""Characters of one text."""
LONGEST_KEY = 200
"""Characters of one key."""
_LONGEST_INTEGER = 1024
"""Bits: a larger number than 1e308 is no float either."""
MOST_PROBLEMS = 20
"""Lines of one message."""
_SHOWN = 40
NO_TEXT = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f\ud800-\udfff\ufffe\uffff]")
"""Characters that text does not have: of control, or halves of one."""
TOO_MANY = (
    f"more than {MOST_VALUES} values, counted as often as anchors repeat them; write what is "
    "evenly spaced as {start: ..., stop: ..., num: ...}"
)
TOO_DEEP = f"mappings and lists stand within each other more than {DEEPEST} deep"


def code_of(character: str) -> str:
    """Name a character that can't be shown.

    Examples
    --------
    >>> code_of(chr(0))
    'U+0000'
    """
    return f"U+{ord(character):04X}"


def short(text: str) -> str:
    """Return text, or the start of a long one, with what can't be shown written as escapes."""
    shown = printable(text[:_SHOWN])
    return shown if len(text) <= _SHOWN else f"{shown}…"


def wrong_text(text: str, longest: int = LONGEST_TEXT) -> str | None:
    """Say what makes some text none that a config has; None if it is one."""
    if len(text) > longest:
        return f"{len(text)} characters given; it should be {longest} at most"
    if found := NO_TEXT.search(text):
        return f"holds the character {code_of(found[0])}, which no text has; leave it out"
    return None


def require_bounded(given: Any) -> None:
    """Refuse plain data that is too large, too deep, or holds what no config does.

    Parameters
    ----------
    given : mapping
        As from a file, or from a program, which may be within itself.

    Raises
    ------
    ConfigError
        If it is; one line, with the key.
    """
    _Bounds().require(given, ())


class _Bounds:
    """How many values may still come."""

    def __init__(self) -> None:
        self.left, self.left_plain = MOST_VALUES, MOST_PLAIN

    def require(self, value: Any, place: tuple[object, ...]) -> None:
        """Refuse a value that is too large; `place` is the keys that lead to it."""
        if isinstance(value, str):
            _require(wrong_text(value), place)
        elif isinstance(value, int):
            _require(_wrong_number(value), place)
        elif isinstance(value, Mapping):
            self._spend(len(value), place)
            for key, part in value.items():
                _require_key(key, place)
                self.require(part, (*place, key))
        elif isinstance(value, Sequence) and not isinstance(value, bytes | bytearray):
            self._spend(len(value), place)
            for number, part in enumerate(value):
                self.require(part, (*place, number))

    def _spend(self, count: int, place: tuple[object, ...]) -> None:
        if len(place) == DEEPEST:
            _require(TOO_DEEP, place[:3])
        self.left -= count
        if place[:1] != ("grid",) and "table" not in place:
            self.left_plain -= count
        if self.left < 0:
            _require(TOO_MANY, ())
        if self.left_plain < 0:
            _require(
                f"more than {MOST_PLAIN} values outside of grid and tables; leave some out", ()
            )


def _wrong_number(value: int) -> str | None:
    if value.bit_length() <= _LONGEST_INTEGER:
        return None
    digits = int(value.bit_length() * math.log10(2)) + 1
    return f"a number of {digits} digits given; numbers go to 1e308"


def _require_key(key: object, place: tuple[object, ...]) -> None:
    if isinstance(key, str) and (wrong := wrong_text(key, LONGEST_KEY)):
        _require(f"{short(key)}: as a key {wrong}", place)
    if isinstance(key, int):
        _require(_wrong_number(key), (*place, "a key"))


def _require(wrong: str | None, place: tuple[object, ...]) -> None:
    if wrong:
        path = ".".join(short(str(key)) for key in place)
        raise ConfigError(f"{path}: {wrong}" if path else wrong)


def bounded(problems: Iterable[str]) -> list[str]:
    """Return the first problems, each once: no more are looked for."""
    lines = list(itertools.islice(_each_once(problems), MOST_PROBLEMS + 1))
    lines[MOST_PROBLEMS:] = ["and more, once these are mended"] if lines[MOST_PROBLEMS:] else []
    return lines


def _each_once(lines: Iterable[str]) -> Iterator[str]:
    said = set[str]()
    for line in lines:
        if line not in said:
            said.add(line)
            yield line
