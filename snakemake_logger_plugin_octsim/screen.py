"""What a run shows: a line for each job, and on a terminal below them what is being done."""

import os
import shutil
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple, TextIO

from tqdm import tqdm

# as octsim.base.say has them: snakemake loads plugins before the Snakefile has found octsim
PROGRESS, WORDS, CLEAR = "OCTSIM_PROGRESS", "OCTSIM_WORDS", "\r\x1b[K"
RESULT: list[Callable[[], list[str]]] = []
"""Returns what a run comes to, a line each, once the workflow is read."""
_BETWEEN = 0.5  # s


class _Work(NamedTuple):
    """A job that is being done."""

    name: str
    message: str
    began: float
    stays: bool

    def seconds(self) -> str:
        """Return for how long it has been at work, as people read it."""
        return tqdm.format_interval(time.monotonic() - self.began)


class Screen:
    """Lines that stay, and one that tells of progress where this is a terminal.

    Parameters
    ----------
    quiet : bool
        Whether nothing but errors is shown.
    stream : file
        Where to.
    """

    def __init__(self, quiet: bool, stream: TextIO = sys.stderr) -> None:
        self._quiet, self._stream = quiet, stream
        self._moving = stream.isatty() and not quiet
        self._running: dict[int, _Work] = {}
        self._began, self._waits_for = time.monotonic(), "reading the workflow"
        self._lock, self._closed = threading.RLock(), threading.Event()
        self.failed: set[int] = set()
        self._notes = TemporaryDirectory(prefix="octsim-progress-", ignore_cleanup_errors=True)
        if self._moving or quiet:  # else jobs say it themselves
            os.environ[PROGRESS] = self._notes.name
        if self._moving:
            threading.Thread(target=self._move, daemon=True).start()

    def line(self, text: str, error: bool = False) -> None:
        """Show a line that stays."""
        if error or not (self._quiet or self.failed):
            with self._lock:
                print(f"{CLEAR if self._moving else ''}{text}", file=self._stream, flush=True)

    def begin(self, job: int, name: str, message: str, stays: bool = True) -> None:
        """Show that a job begins; its line comes when it has ended, where this is a terminal."""
        self.failed.discard(job)  # it is tried again, as on a cluster
        self._running[job] = _Work(name, message, time.monotonic(), stays)
        self._waits_for = ""
        if not self._moving:
            self.line(f"octsim: {name}: {message}")

    def end(self, job: int) -> None:
        """Show that a job has been done."""
        work = self._running.pop(job, None)
        if work and work.stays and self._moving:
            self.line(f"octsim: {work.name} ({work.seconds()}): {work.message}")

    def fail(self, job: int) -> None:
        """Show nothing more: the job has said what is wrong, and that stands last."""
        self._running.pop(job, None)
        self.failed.add(job)

    def close(self) -> None:
        """Leave the lines that stay."""
        self._closed.set()
        with self._lock:
            if self._moving:
                print(CLEAR, end="", file=self._stream, flush=True)
            self._moving = False
        if os.environ.get(PROGRESS) == self._notes.name:
            del os.environ[PROGRESS]
        self._notes.cleanup()

    def _move(self) -> None:
        while not self._closed.wait(_BETWEEN):
            with self._lock:
                if self._moving:
                    width = shutil.get_terminal_size().columns - 1
                    print(
                        f"{CLEAR}{self._progress()[:width]}", end="", file=self._stream, flush=True
                    )

    def _progress(self) -> str:
        """Return what is being done, how far it is and for how long it has been."""
        if self._waits_for:
            waited = tqdm.format_interval(time.monotonic() - self._began)
            return f"{self._waits_for} {waited}{self._noted('reading')}"
        every = list(self._running.values())
        return " | ".join(f"{work.name} {work.seconds()}{self._noted(work.name)}" for work in every)

    def _noted(self, name: str) -> str:
        """Return what a job has noted, or what reads the config, of that name."""
        with suppress(OSError):
            if words := Path(self._notes.name, name).read_text(encoding="utf-8"):
                return f", {words}"
        return ""
