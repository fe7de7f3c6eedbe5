"""Compiled code on disk: read where it is whole, and compiled by one process while others wait."""

import logging
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numba
from filelock import FileLock, Timeout
from numba.core.caching import FunctionCache, _Cache

from octsim.base.code_folder import folder_for, nowhere, places, remove_unused, use
from octsim.base.say import note, say

_LONGEST = 1800.0  # s to wait for another process, which may be stopped
_said: set[str] = set()
_told_of: set["KeptCode"] = set()  # that are being compiled: some call others


class KeptCode(_Cache):
    """The compiled code of one function, as numba asks for it.

    Damaged files are as good as none, and a lock that the file system lacks is done without.

    Parameters
    ----------
    function : callable
        What is compiled.
    digest : str
        Of all that the code follows from.
    """

    def __init__(self, function: Callable[..., Any], digest: str) -> None:
        self._function, self._digest = function, digest
        self._files: Any = None
        self._lock: FileLock | None = None
        self._enabled = True

    @property
    def cache_path(self) -> str:
        """Folder of the files; empty if there is none."""
        files = self._opened()
        return str(files.cache_path) if files else ""

    def enable(self) -> None:
        """Keep code from now on."""
        self._enabled = True

    def disable(self) -> None:
        """Do not keep code from now on."""
        self._enabled = False

    def flush(self) -> None:
        """Forget what is kept."""
        if files := self._opened():
            files.flush()

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the code for some types, or None if it is to be compiled now, by this process."""
        if not self._enabled:
            return None
        found = self._read(sig, target_context)
        if found is None and self._acquire():  # another may have compiled it meanwhile
            found = self._read(sig, target_context)
        if found is None and self._opened():  # else it is said that it is not once
            self._tell("compiling the tracer for this machine … (once)")
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the code for some types; what can't be kept is said, and compiled anew next time."""
        try:
            if self._enabled and (files := self._opened()):
                with suppress(Exception):  # an index that can't be read
                    files.save_overload(sig, data)
                    return
                files.flush()
                files.save_overload(sig, data)
        except OSError as error:
            _say_once(f"compiled code can't be kept in {self.cache_path}: {error}")

    def _opened(self) -> Any:
        if self._files is None:
            folder = folder_for(self._digest, places())
            if folder is None:
                _say_once(nowhere(places()))
                self._files = False
            else:
                settings: Any = numba.config
                elsewhere, settings.CACHE_DIR = settings.CACHE_DIR, str(folder)
                try:
                    self._files = FunctionCache(self._function)  # type: ignore[no-untyped-call]
                finally:
                    settings.CACHE_DIR = elsewhere
                use(folder)
        return self._files

    def _read(self, sig: Any, target_context: Any) -> Any:
        with suppress(Exception):  # a damaged pickle can fail in any way
            if files := self._opened():
                return files.load_overload(sig, target_context)
        return None

    def _acquire(self) -> bool:
        """Get the right to compile, once no other process does; return whether that came about."""
        folder = folder_for(self._digest, places())
        if folder is None:
            return False
        lock = FileLock(folder / f"{self._function.__qualname__}.lock")
        try:
            folder.mkdir(exist_ok=True)
            try:
                lock.acquire(timeout=0)
            except Timeout:
                self._tell("another process is compiling the tracer; waiting for it")
                lock.acquire(timeout=_LONGEST, poll_interval=0.2)
            self._lock = lock
            remove_unused(folder.parent)
        except (OSError, NotImplementedError):  # or waited long enough
            return False
        return True

    def _tell(self, text: str) -> None:
        """Tell what is waited for: on a terminal where progress is shown, else once in a line."""
        _told_of.add(self)
        if note(text):
            logging.getLogger(__name__).info("%s", text)
        else:
            _say_once(text)

    def done(self) -> None:
        """Let others compile, however this went."""
        if self in _told_of:
            _told_of.remove(self)
            if not _told_of:
                note("")
        if self._lock:
            self._lock.release()
            self._lock = None


def _say_once(text: str) -> None:
    if text not in _said:
        _said.add(text)
        say(text)
        logging.getLogger(__name__).info("%s", text)
