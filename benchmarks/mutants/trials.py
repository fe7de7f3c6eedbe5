"""Trials of changes: each on a copy of the checkout, in a process of its own, with numba off."""

import contextlib
import json
import math
import os
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from mutants.changes import Change
from mutants.timed import Timed

_PATIENCE = 1800.0  # s of a whole trial, on a machine that has much else to do
_LOADED = (
    "h5py", "hypothesis.extra.numpy", "netCDF4", "nptdms", "numba", "numpy", "pandas", "pydantic",
    "pytest", "scipy.integrate", "scipy.io", "scipy.optimize", "scipy.special", "scipy.stats",
    "xarray", "yaml",
)  # fmt: skip


class Trial(NamedTuple):
    """What to run in a copy: tests of some files, with a change or without any."""

    change: Change | None
    """None: the tests are run as the checkout is."""
    files: tuple[str, ...]
    without: tuple[str, ...] = ()
    """Names of the tests not to run."""
    most: float = math.inf
    """Processor time after which no other test is begun, s."""


class Ended(NamedTuple):
    """How a trial ended."""

    failed: str
    """The first test that failed, or what else ended it; empty if all passed."""
    slow: str
    """The first test that was left as it took too long."""
    seconds: Mapping[str, float]
    """Processor time by test; infinite of those that did not pass."""


def load(*, compiled: bool) -> None:
    """Import what all trials need, once: they are forks of this process.

    The package itself is imported by each, from its copy.

    Parameters
    ----------
    compiled : bool
        Whether numba compiles, which takes a minute for a kernel that is changed.
    """
    os.environ["NUMBA_DISABLE_JIT"] = "0" if compiled else "1"
    sys.dont_write_bytecode = True
    for name in _LOADED:
        with contextlib.suppress(ImportError):
            __import__(name)


def run(
    root: Path,
    trials: Iterable[Trial],
    longest: float,
    jobs: int,
    ended: Callable[[Trial, Ended], None],
) -> None:
    """Run trials, some at once, and tell of each as it ends; the checkout itself is left alone.

    Parameters
    ----------
    root : Path
        Folder of the checkout.
    trials : iterable of Trial
    longest : float
        Processor time that one test may take, s.
    jobs : int
        How many run at once.
    ended : callable
        Is given each trial and how it ended.
    """
    waiting = list(trials)[::-1]
    with tempfile.TemporaryDirectory(prefix="octsim-mutants-") as name:
        free = [_copied(root, Path(name) / str(number)) for number in range(jobs)]
        running: dict[int, tuple[Trial, Path, float]] = {}
        try:
            while waiting or running:
                while waiting and free:
                    trial, folder = waiting.pop(), free.pop()
                    process = _started(trial, folder, longest)
                    running[process] = trial, folder, time.monotonic() + _PATIENCE
                time.sleep(0.05)
                for process, (trial, folder, until) in list(running.items()):
                    if time.monotonic() > until:
                        os.killpg(process, signal.SIGKILL)
                    if os.waitpid(process, os.WNOHANG)[0]:
                        del running[process]
                        free.append(folder)
                        ended(trial, _read(trial, folder))
        finally:
            for process in running:
                os.killpg(process, signal.SIGKILL)
                os.waitpid(process, 0)


def _copied(root: Path, folder: Path) -> Path:
    # with the times of the files: what is compiled of them before any change serves all trials
    left_out = shutil.ignore_patterns(".*", "results", "*.egg-info", "*.nbi", "*.nbc")
    shutil.copytree(root, folder, ignore=left_out)
    return folder


def _started(trial: Trial, folder: Path, longest: float) -> int:
    """Start a trial in a copy, and return the number of its process."""
    (folder / "ended.json").unlink(missing_ok=True)
    if trial.change:
        file = folder / trial.change.module
        shutil.copy2(file, folder / "unchanged")
        file.write_bytes(trial.change.made(file.read_bytes()))
    process = os.fork()
    if process:
        with contextlib.suppress(OSError):  # it does so itself too
            os.setpgid(process, process)
        return process
    try:
        os.setpgid(0, 0)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        _run_here(trial, folder, longest)
    finally:
        os._exit(0)


def _run_here(trial: Trial, folder: Path, longest: float) -> None:
    import pytest

    os.chdir(folder)
    output = os.open(folder / "output.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for stream in (1, 2):
        os.dup2(output, stream)
    # the copy's package, here and in the processes that tests start
    sys.path.insert(0, str(folder))
    os.environ["PYTHONPATH"] = str(folder)
    timed = Timed(trial.without, longest, trial.most)
    # compiled code divides by nought in silence
    unsaid = ("RuntimeWarning", "pytest.PytestAssertRewriteWarning")
    options = ["--quiet", "--tb=line", "-p", "no:cacheprovider"]
    options += [part for name in unsaid for part in ("-W", f"ignore::{name}")]
    stop = ["--exitfirst"] if trial.change else []
    code = pytest.main([*options, *stop, *trial.files], plugins=[timed])
    done = {"code": int(code), "failed": timed.failed, "slow": timed.slow, "seconds": timed.seconds}
    (folder / "ended.json").write_text(json.dumps(done), encoding="utf-8")


def _read(trial: Trial, folder: Path) -> Ended:
    """Read how a trial ended, and put back what it changed."""
    if trial.change:
        shutil.copy2(folder / "unchanged", folder / trial.change.module)
    try:
        held = json.loads((folder / "ended.json").read_bytes())
    except FileNotFoundError:
        return Ended("the process dies", "", {})
    failed = held["failed"]
    if not failed and not held["seconds"] and held["code"] not in (0, 5):
        failed = "the tests can't be imported"
    return Ended(failed, held["slow"], held["seconds"])
