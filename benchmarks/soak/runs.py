"""Runs of a drawn config by `octsim run` on a terminal: whole, stopped, two at once, no room."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from random import Random
from signal import SIGINT, SIGKILL, SIGTERM, Signals
from typing import NamedTuple

import yaml
from checkout import Checkout
from soak.drawn import Drawn
from terminal import Terminal, processes_in

OCTSIM = (sys.executable, "-m", "octsim")
STOPPED = "octsim: stopped"
_LOOK = 0.02  # s, between looks
_LAST = 60.0  # s, after the end of a command, by which all of its processes have ended
_LEFT = "processes that go on"
_DISK = 64  # MB, of a disk that fills
_CACHE = Path(".octsim")


class Seen(NamedTuple):
    """How one command ended."""

    status: int
    screen: list[str]

    @property
    def wrong(self) -> str:
        """What no command may show or leave behind; empty if there is nothing of it."""
        wrong = any("Traceback" in line or line.startswith(_LEFT) for line in self.screen)
        return "\n".join(self.screen) if wrong else ""


class Stop(NamedTuple):
    """How a run that was told to stop ended."""

    number: Signals
    seen: Seen
    seconds: float
    """From the signal until nothing of the run was left on its terminal."""

    @property
    def hit(self) -> bool:
        """Whether it was there in time, and the run had not ended by itself."""
        return self.seen.status == 128 + self.number

    @property
    def wrong(self) -> str:
        """What is not as it should be; empty if nothing."""
        said = sum(STOPPED in line for line in self.seen.screen)
        if self.seen.wrong:
            return self.seen.wrong
        if self.seen.status not in (0, 128 + self.number):
            return f"status {self.seen.status}: " + "\n".join(self.seen.screen)
        due = self.number != SIGKILL and self.hit
        if said == due:
            return ""
        return f"{said} lines that say stopped; the last is: {' '.join(self.seen.screen[-1:])}"


class Run:
    """A folder in which one config is run.

    Parameters
    ----------
    folder : Path
        Made, if it is not there.
    drawn : Drawn
        The config, and what is asked for.
    """

    def __init__(self, folder: Path, drawn: Drawn) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder.resolve()
        self._checkout = Checkout(self.folder)
        (self.folder / "mine.yaml").write_text(yaml.safe_dump(drawn.overlay), encoding="utf-8")
        self._command = [*OCTSIM, "run", "mine.yaml", *drawn.targets]

    def start(self) -> Terminal:
        """Start it, on a terminal."""
        return Terminal(self._command, self.folder)

    def whole(self) -> Seen:
        """Run it to its end."""
        return ended(self.start())

    def results(self) -> dict[str, bytes]:
        """Return all datasets and figures, by their names."""
        return self._checkout.results()

    def stopped(self, number: Signals, after: float) -> Stop:
        """Start it and stop it some seconds after; a kill takes all its processes.

        It is over when none of its processes is left.
        """
        terminal = self.start()
        # before that the command is Python alone, which ends without a word of octsim's
        terminal.until(lambda: terminal.has_ended() or self._handles(terminal.pid, SIGTERM))
        _wait(terminal, after)
        began = time.monotonic()
        if number == SIGKILL:
            for process in processes_in(self.folder):
                with suppress(ProcessLookupError):
                    os.kill(process, SIGKILL)
        elif number == SIGINT:
            with suppress(OSError):  # it has ended, and its terminal with it
                terminal.press_ctrl_c()
        else:
            terminal.kill(number)
        seen = ended(terminal)
        took = time.monotonic() - began
        return Stop(number, _alone(self.folder, seen), took)

    def _handles(self, process: int, number: Signals) -> bool:
        """Return whether a process is the command and handles a signal, as Linux tells it.

        Before it is the command it is a copy of this process, which handles signals too.
        """
        with suppress(OSError):
            about = Path("/proc", str(process))
            words = (about / "cmdline").read_bytes().split(b"\0")[:-1]
            lines = (line.split() for line in (about / "status").read_text().splitlines())
            caught = {name: values for name, *values in lines}["SigCgt:"]
            is_command = words == [os.fsencode(one) for one in self._command]
            return is_command and bool(int(caught[0], 16) >> (number - 1) & 1)
        return False

    def share_cache(self, folder: Path) -> None:
        """Have its points in a folder of others too, without a word of it in the config."""
        folder.mkdir(exist_ok=True)
        (self.folder / _CACHE).symlink_to(folder)


def ended(terminal: Terminal) -> Seen:
    """Wait for the end of a command."""
    status = terminal.status()
    return Seen(status, terminal.screen())


def moments(draw: Random, seconds: float) -> Iterator[tuple[Signals, float]]:
    """Draw signals, each as often as the others, and moments of a run that takes so long."""
    while True:
        numbers = [SIGKILL, SIGINT, SIGTERM]
        draw.shuffle(numbers)
        yield from ((number, draw.uniform(0, seconds)) for number in numbers)


def two_at_once(one: Run, other: Run, cache: Path) -> tuple[list[Seen], int]:
    """Run two with one cache, that is cleared all the while; return also how often it was."""
    for run in (one, other):
        run.share_cache(cache)
    terminals, cleared = [one.start(), other.start()], 0
    seen = []
    while not all(terminal.has_ended() for terminal in terminals):
        clear = [*OCTSIM, "cache", "clear", "--file", str(cache / "points")]
        done = subprocess.run(clear, capture_output=True, text=True, check=False)
        seen.append(Seen(done.returncode, (done.stdout + done.stderr).splitlines()))
        cleared += 1
    return [*map(ended, terminals), *seen], cleared


@contextmanager
def small_disk(folder: Path) -> Iterator[bool]:
    """Have a folder be a small disk of its own; gives False where that is not allowed."""
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={_DISK}m", "octsim-soak", str(folder)]
    there = os.geteuid() == 0 and _done(mount)
    try:
        yield there
    finally:
        if there:
            _done(["umount", str(folder)])


def filled(run: Run, disk: Path, after: float) -> Seen:
    """Start a run, fill its disk some seconds after, and make room again once it has ended."""
    terminal, file = run.start(), disk / "filling"
    _wait(terminal, after)
    with suppress(OSError), file.open("wb", buffering=0) as stream:
        for size in (2**20, 2**12):
            with suppress(OSError):
                while True:
                    stream.write(bytes(size))
    seen = ended(terminal)
    seen = _alone(run.folder, seen)
    file.unlink(missing_ok=True)
    return seen


def differing(results: Mapping[str, bytes], right: Mapping[str, bytes]) -> list[str]:
    """Return the names of files that are not as they should be, or not there."""
    names = sorted({*results, *right})
    return [name for name in names if results.get(name) != right.get(name)]


def _wait(terminal: Terminal, seconds: float) -> None:
    until = time.monotonic() + seconds
    while time.monotonic() < until and not terminal.has_ended():
        time.sleep(_LOOK)


def _alone(folder: Path, seen: Seen) -> Seen:
    """Wait for the last of a run's processes; one that goes on is not as it should be."""
    until = time.monotonic() + _LAST
    while left := processes_in(folder):
        if time.monotonic() > until:
            return seen._replace(screen=[*seen.screen, f"{_LEFT}: {left}"])
        time.sleep(_LOOK)
    return seen


def _done(command: list[str]) -> bool:
    return subprocess.run(command, capture_output=True, check=False).returncode == 0
