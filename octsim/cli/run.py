"""`octsim run`: a config's run, by the workflow that the package carries, and how it is stopped."""

import argparse
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from difflib import get_close_matches
from importlib.util import find_spec
from pathlib import Path
from types import FrameType
from typing import Any

from octsim.base.carried import workflow_folder
from octsim.base.errors import OctsimError, not_installed
from octsim.base.say import WORDS
from octsim.cli.stopped import (
    COMMAND,
    SIGNALS,
    on_signals,
    say_stopped,
    stops_at_signals,
)

_FORMS = (".yaml", ".yml", ".json")
_MORE_TARGETS = ("all", "figures", "animation", "archive")
_LONGEST = 1.5  # s that snakemake may take to end; it ends at once, unless it is just being loaded
_ON_A_CLUSTER = 60.0  # s, as jobs that wait there are cancelled
_PROFILES = ("--workflow-profile", "--profile", "--executor")


def add(commands: Any) -> None:
    """Add the command to a parser's others."""
    parser = commands.add_parser(
        "run",
        help="make a run: every dataset and figure of a config",
        description="Make what a config says, in results/<run>/ of this folder: the whole run, or "
        "targets such as calibration. What is there is kept as far as it is of this config.",
        epilog="What stands after -- is for snakemake, as in: octsim run mine.yaml -- --dry-run. "
        "Exit status: 0 if all is made, 1 if something failed, 2 if the arguments or the "
        "config can't be used, 130 or 143 if it was stopped.",
    )  # fmt: skip
    parser.add_argument(
        "words", nargs="*", metavar="config.yaml or target",
        help="without a config that of the thesis, without a target the whole run",
    )  # fmt: skip
    parser.add_argument(
        "--cores", type=cores, default=2, metavar="NUMBER", help="default: %(default)s"
    )
    words = parser.add_mutually_exclusive_group()
    words.add_argument("--quiet", action="store_true", help="show errors alone")
    words.add_argument("--verbose", action="store_true", help="show all of snakemake's words")
    parser.set_defaults(do=run, failed=2)


def cores(text: str) -> int:
    """Read a number of cores: with none, snakemake would wait for ever."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text} given; give 1 or more")
    return int(text)


def require_workflow() -> None:
    """Check that runs can be made here.

    Raises
    ------
    OctsimError
        If there is no workflow, or snakemake is not installed.
    """
    if not (workflow_folder() / "Snakefile").is_file():
        raise OctsimError(f"{workflow_folder()}: no Snakefile; install octsim again")
    if find_spec("snakemake") is None:
        raise not_installed("snakemake", "run")


def run(given: argparse.Namespace) -> int:
    """Check the config, have the workflow make what is asked for; return the exit status."""
    stops_at_signals(tuple)  # until the workflow is started
    from octsim.config.handed import FOLDER, keep_beside_runs
    from octsim.config.load import load_and_tell

    require_workflow()
    configs, targets = _told_apart(given.words)
    configs = configs or [str(workflow_folder() / "config" / "default.yaml")]
    kept = keep_beside_runs()  # by the processes of the run it is not looked at again
    try:
        config, _ = load_and_tell(*configs)
        shown = "quiet" if given.quiet else "verbose" if given.verbose else ""
        if not (shown or given.flags) and sys.stderr.isatty():
            print("octsim: starting snakemake …", end="", file=sys.stderr, flush=True)
        command = _command(configs, targets, config.run, given)
        return _Running(command, given.flags, shown).ended()
    finally:
        if kept:
            os.environ.pop(FOLDER)
            kept.cleanup()
            with suppress(OSError):  # there is more in it where a run was begun
                Path(".snakemake").rmdir()


def _told_apart(words: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the configs and the targets among words: a config is a file, by its name or its kind.

    Raises
    ------
    OctsimError
        If a word is neither.
    """
    from octsim.datasets.catalog import CATALOG

    known = (*CATALOG, *_MORE_TARGETS)
    configs = [
        word for word in words
        if word.endswith(_FORMS) or (word not in known and Path(word).is_file())
    ]  # fmt: skip
    targets = [word for word in words if word not in configs]
    for word in targets:
        if word in known or word.startswith("results/"):
            continue
        nearest = get_close_matches(word, known, n=1, cutoff=0)[0]
        raise OctsimError(
            f"{word}: neither a config, whose name ends in .yaml, nor a target; the nearest one is "
            f"{nearest}"
        )
    return configs, targets


def _command(
    configs: Sequence[str], targets: Sequence[str], name: str, given: argparse.Namespace
) -> list[str]:
    """Return the command that runs the workflow in this folder."""
    from octsim.datasets.catalog import jobs

    rules = {*jobs(beside=False), *jobs(beside=True), *_MORE_TARGETS}
    files = [
        word if word in rules or "/" in word else f"results/{name}/{word}.nc" for word in targets
    ]
    place = workflow_folder()
    theirs = any(flag.partition("=")[0] in _PROFILES[:1] for flag in given.flags)
    profile = [] if theirs else _profile(place / "profiles" / "default" / "config.yaml")
    return [
        sys.executable, "-m", "snakemake", *files, "--snakefile", str(place / "Snakefile"),
        *profile, "--cores", str(given.cores), "--configfile", *configs, *given.flags,
    ]  # fmt: skip


def _profile(file: Path) -> list[str]:
    """Return a profile as flags: snakemake says of a profile that it uses it."""
    import yaml

    flags = ["--workflow-profile", "none"]
    for key, value in yaml.safe_load(file.read_text(encoding="utf-8")).items():
        values = value if isinstance(value, list) else [] if value is True else [value]
        flags += [f"--{key}", *map(str, values)] if key != "cores" else []
    return flags


class _Running:
    """The workflow in a session of its own: what the terminal sends comes to this process alone.

    Parameters
    ----------
    command : sequence of str
        That runs it.
    flags : sequence of str
        Those of snakemake's own.
    shown : str
        Whose words are shown (`octsim.base.say.WORDS`).
    """

    def __init__(self, command: Sequence[str], flags: Sequence[str], shown: str) -> None:
        self._command, self._shown = command, shown
        on_cluster = any(flag.partition("=")[0] in _PROFILES for flag in flags)
        self._longest = _ON_A_CLUSTER if on_cluster else _LONGEST
        self._process: subprocess.Popen[bytes] | None = None
        self._stopped = 0

    def ended(self) -> int:
        """Run it, and return how it ended, or by which signal it was stopped."""
        on_signals(self._stop)
        signal.signal(signal.SIGTSTP, self._pause)
        self._process = subprocess.Popen(
            self._command, start_new_session=True, stdin=subprocess.DEVNULL,
            env={**os.environ, COMMAND: str(os.getpid()), WORDS: self._shown},
        )  # fmt: skip
        if self._stopped:  # while it was started
            self._send(signal.SIGKILL)
        status = self._process.wait()
        if not self._stopped:
            for one in SIGNALS:  # there is nothing left to stop: a run that is whole ends as one
                signal.signal(one, signal.SIG_IGN)
            return status
        self._send(signal.SIGKILL)  # what is left of it
        say_stopped()
        return 128 + self._stopped

    def _stop(self, number: int, _frame: FrameType | None) -> None:
        """End the workflow: at once if this is asked for again."""
        again, self._stopped = bool(self._stopped), number
        if again:
            self._send(signal.SIGKILL)
        elif self._process:
            self._process.terminate()
            last = threading.Timer(self._longest, self._send, [signal.SIGKILL])
            last.daemon = True
            last.start()

    def _pause(self, _number: int, _frame: FrameType | None) -> None:
        """Have the workflow stand still for as long as this process does (Ctrl-Z)."""
        self._send(signal.SIGSTOP)
        os.kill(os.getpid(), signal.SIGSTOP)
        self._send(signal.SIGCONT)

    def _send(self, number: int) -> None:
        if self._process:
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, number)
