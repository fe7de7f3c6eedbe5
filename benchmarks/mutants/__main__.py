"""Mutation testing: how many small wrong changes to the package the tests notice.

Run by `make mutants`, which writes docs/mutants.md:

    python -m mutants [--number N] [--seed TEXT] [--jobs N] [--seconds S] [--longest S]
        [--rooms ROOM ...] [--again] [--compiled] [--show] [--write]
"""

import argparse
import hashlib
import json
import signal
import sys
from collections.abc import Iterable, Mapping, Sequence
from fnmatch import fnmatch
from itertools import chain
from math import isinf
from pathlib import Path
from typing import Any

from marked import write_part
from mutants import page
from mutants.changes import Change, changes
from mutants.page import COMPILED, reasons
from mutants.tests_of import OwnTests
from mutants.trials import Ended, Trial, load, run

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "results" / "mutants"
ROOMS = {
    "kernels": (
        "octsim/tracing/*.py", "octsim/optics/*.py", "octsim/schemes/*.py", "octsim/schemes/*/*.py",
    ),
    "readers": (
        "octsim/phase/measured_*.py", "octsim/measured/readers/*.py", "octsim/config/table_text.py",
    ),
    "keys": (
        "octsim/datasets/keys.py", "octsim/datasets/code.py", "octsim/instrument/point_keys.py",
    ),
}  # fmt: skip
"""Where changes are made, by what that is."""
_TURNS = 5 * ("kernels",) + 4 * ("readers",) + ("keys",)
"""Of ten changes that are drawn: there are a hundred times as many of kernels as of keys."""

_COMPILED = 600.0
"""Processor time, s, that a test of compiled code may take, with the compiler's."""
_CLEARLY = 3.0
"""Times as long as without a change a test may take with one, before it has noticed it."""


def main() -> None:
    """Draw changes, try each, and say what became of it."""
    parser = argparse.ArgumentParser(description=__doc__, prog="python -m mutants")
    parser.add_argument("--number", type=int, default=300, help="changes to try (300)")
    parser.add_argument("--seed", default="octsim", help="of the draw")
    parser.add_argument("--jobs", type=int, default=2, help="trials at once (2)")
    parser.add_argument(
        "--seconds", type=float, default=40.0, help="of tests for each change, processor time (40)"
    )
    parser.add_argument("--longest", type=float, default=2.0, help="that one test may take, s (2)")
    parser.add_argument(
        "--again", action="store_true", help="not those that were noticed the last time"
    )
    parser.add_argument(
        "--compiled",
        action="store_true",
        help="only those of which reasons.yaml names a test that notices them when it is compiled",
    )
    parser.add_argument("--show", action="store_true", help="try none, say what is known")
    parser.add_argument(
        "--rooms", nargs="+", choices=list(ROOMS), default=list(ROOMS), help="to try changes of"
    )
    parser.add_argument("--write", action="store_true", help="write docs/mutants.md")
    asked = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))
    drawn = sample(ROOT, asked.seed, asked.number)
    patterns = [one for room in asked.rooms for one in ROOMS[room]]
    chosen = [one for one in drawn if any(fnmatch(one.module, p) for p in patterns)]
    goes_on = asked.again or asked.show or asked.compiled
    noticed: dict[str, str] = _read(KEPT / "noticed.json") if goes_on else {}
    left = [one for one in chosen if not noticed.get(one.name)]
    if asked.compiled:
        _try_compiled(left, noticed, asked.jobs)
    elif not asked.show:
        _try(left, noticed, asked)
    told = page.lines(ROOMS, drawn, noticed, asked.seed, (asked.longest, asked.seconds))
    print(*told, sep="\n")
    if asked.write:
        write_part(ROOT / "docs" / "mutants.md", "mutants", told)


def _try(left: Sequence[Change], noticed: dict[str, str], asked: argparse.Namespace) -> None:
    """Try changes, and note of each which test noticed it; empty if none did."""
    load(compiled=False)
    tests = OwnTests(ROOT)
    files = {change: tuple(tests.files(change.module)) for change in left}
    known = _timed(dict.fromkeys(chain.from_iterable(files.values())), asked)

    def trial(change: Change) -> Trial:
        without = (
            name for file in files[change] for name, took in known[file].items() if isinf(took)
        )
        return Trial(change, files[change], tuple(without), asked.seconds)

    longest = _CLEARLY * asked.longest
    run(ROOT, map(trial, left), longest, asked.jobs, _Verdicts(len(left), noticed).say)


def _try_compiled(left: Sequence[Change], noticed: dict[str, str], jobs: int) -> None:
    """Try changes as they are when compiled, by the test that is named for each and else passes."""
    load(compiled=True)
    named = {name: why.removeprefix(COMPILED) for name, why in reasons(COMPILED).items()}
    tests = {one: named[one.name] for one in left if one.name in named}
    passing: set[str] = set()

    def ended(done: Trial, how: Ended) -> None:
        if how.seconds and not any(map(isinf, how.seconds.values())):
            passing.update(done.files)
        else:
            print(f"{done.files[0]}: does not pass without a change", flush=True)

    run(ROOT, [Trial(None, (test,)) for test in set(tests.values())], _COMPILED, jobs, ended)
    trials = [Trial(one, (test,)) for one, test in tests.items() if test in passing]
    run(ROOT, trials, _COMPILED, jobs, _Verdicts(len(trials), noticed).say)


class _Verdicts:
    """What became of changes: said as they end, and kept.

    Parameters
    ----------
    number : int
        Of changes that are tried.
    noticed : dict
        The test that noticed each, by name; empty if none did. What is said is added.
    """

    def __init__(self, number: int, noticed: dict[str, str]) -> None:
        self._number, self._noticed, self._tried = number, noticed, 0

    def say(self, done: Trial, how: Ended) -> None:
        """Note how the trial of a change ended."""
        assert done.change
        by = how.failed or (f"{how.slow} (takes too long)" if how.slow else "")
        self._noticed[done.change.name] = by
        self._tried += 1
        verdict = f"noticed by {by}" if by else "not noticed"
        print(f"{self._tried} of {self._number}: {done.change.name}: {verdict}", flush=True)
        _write(KEPT / "noticed.json", self._noticed)


def _timed(files: Iterable[str], asked: argparse.Namespace) -> dict[str, dict[str, float]]:
    """Return how long the tests of files take without a change, s; infinite if they don't pass.

    It is kept for the code that it is of.
    """
    shared = *ROOT.glob("tests/*.py"), *ROOT.glob("tests/**/conftest.py")
    code = _digest(*ROOT.glob("octsim/**/*.py"), *shared)
    names = {file: f"{file} {code} {_digest(ROOT / file)} {asked.longest}" for file in files}
    kept: dict[str, dict[str, float]] = _read(KEPT / "tests.json")
    known = {file: kept[name] for file, name in names.items() if name in kept}

    def ended(done: Trial, how: Ended) -> None:
        (file,) = done.files
        known[file] = dict(how.seconds)
        print(f"{len(known)} of {len(names)} files of tests are timed: {file}", flush=True)
        _write(KEPT / "tests.json", {names[one]: seconds for one, seconds in known.items()})

    unknown = [Trial(None, (file,)) for file in names if file not in known]
    run(ROOT, unknown, asked.longest, asked.jobs, ended)
    return known


def sample(root: Path, seed: str, number: int) -> list[Change]:
    """Draw changes; of a smaller number the same come first, and of edited code most stay.

    Parameters
    ----------
    root : Path
        Folder of the checkout.
    seed : str
        Of the draw.
    number : int
        Of changes; fewer are drawn where there are no more.
    """
    every = {}
    for room, patterns in ROOMS.items():
        files = sorted({path.relative_to(root) for one in patterns for path in root.glob(one)})
        every[room] = [one for file in files for one in changes(root, file.as_posix())]
        every[room].sort(key=lambda one: hashlib.sha256(f"{seed} {one.name}".encode()).digest())
    chosen: list[Change] = []
    while any(every.values()) and len(chosen) < number:
        chosen += [every[room].pop() for room in _TURNS if every[room]]
    return chosen[:number]


def _digest(*files: Path) -> str:
    whole = hashlib.sha256()
    for file in sorted(files):
        whole.update(file.read_bytes())
    return whole.hexdigest()[:12]


def _read(file: Path) -> Any:
    return json.loads(file.read_bytes()) if file.is_file() else {}


def _write(file: Path, content: Mapping[str, object]) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    partial = file.with_suffix(".partial")
    partial.write_text(json.dumps(content, indent=1), encoding="utf-8")
    partial.replace(file)


if __name__ == "__main__":
    sys.exit(main())
