"""What sources say, kept on disk by their text: to find it of all takes longer than most commands.

What is found of a text is of that text, whatever file it stands in and whenever that was written.
"""

import hashlib
import json
import platform
from contextlib import suppress
from functools import cache
from pathlib import Path

from octsim.base import syntax
from octsim.base.code_folder import SOURCES, places, writable
from octsim.base.errors import FileError
from octsim.base.files import read_bounded, whole
from octsim.base.syntax import Syntax, syntax_of

_LARGEST = 10_000_000
"""Bytes of a file that is read; one that has grown so large, by many edits, is begun anew."""


class KeptSyntax:
    """What sources say, as far as it was found before, by this or another process."""

    def __init__(self) -> None:
        self._found = _read()
        self._new = False

    def of(self, source: bytes, module: tuple[str, ...]) -> Syntax:
        """Return what a source says (`octsim.base.syntax.syntax_of`).

        Parameters
        ----------
        source : bytes
            As it is in its file.
        module : tuple of str
            Its name, part by part.
        """
        key = hashlib.sha256("\n".join((*module, "")).encode() + source).hexdigest()
        found = self._found.get(key)
        if found is None:
            found = self._found[key] = syntax_of(source.decode("utf-8"), module)
            self._new = True
        return found

    def keep(self) -> None:
        """Write what is new, where something can be written."""
        place = writable(places()) if self._new else None
        self._new = False
        if place:
            text = json.dumps(self._found)
            # without it, it is found anew each time
            with suppress(OSError, FileError), whole(place / name()) as file:
                file.write_text(f"{_digest(text)}\n{text}", encoding="utf-8")


def _read() -> dict[str, Syntax]:
    """Return what is kept in any of the places; what is damaged is as good as none."""
    kept: dict[str, Syntax] = {}
    for place in places():
        with suppress(OSError, ValueError):
            held = read_bounded(place / name(), _LARGEST).decode("utf-8")
            digest, text = held.split("\n", 1)
            if digest == _digest(text):
                found = json.loads(text).items()
                kept |= {key: Syntax(one, tuple(names)) for key, (one, names) in found}
    return kept


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


@cache
def name() -> str:
    """Return the name of the file, of what finds it: its code, and the Python whose trees they are.

    It lies where compiled code does.
    """
    code = Path(syntax.__file__).read_text(encoding="utf-8")
    return f"{SOURCES}{_digest(code + platform.python_version())[:12]}.json"
