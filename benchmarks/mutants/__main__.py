"""Mutation testing: how many small wrong changes to the package the tests notice.

Run by `make mutants`, which writes docs/mutants.md:

    python -m mutants [--number N] [--seed TEXT] [--jobs N] [--seconds S] [--longest S]
        [--rooms ROOM ...] [--again] [--show] [--write]
"""

import argparse
import hashlib
import json
import math
import signal
import sys
from collections.abc import Mapping, Sequence
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from marked import write_part
from mutants import page
from mutants.changes import Change, changes
from mutants.tests_of import OwnTests
from mutants.trials import Ended, Trial, load, run

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "results" / "mutants"
ROOMS = {
    "kernels": ("octsim/tracing/*.py", "octsim/optics/*.py", "octsim/schemes/**/*.py"),
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

_CLEARLY = 3.0
"""Times less than it may take: what a test takes without a change that is too slow with one."""


def main() -> None:
    """Draw changes, try each, and say what became of it."""
    parser = argparse.ArgumentParser(description=__doc__, prog="python -m mutants")
    parser.add_argument("--number", type=int, default=300, help="changes to try (300)")
    parser.add_argument("--seed", default="octsim", help="of the draw")
    parser.add_argument("--jobs", type=int, default=2, help="trials at once (2)")
    parser.add_argument(
        "--seconds", type=float, default=60.0, help="of tests for each change, processor time (60)"
    )
    parser.add_argument("--longest", type=float, default=3.0, help="that one test may take, s (3)")
    parser.add_argument(
        "--again", action="store_true", help="not those that were noticed the last time"
    )
    parser.add_argument("--show", action="store_true", help="try none, say what is known")
    parser.add_argument(
        "--rooms", nargs="+", choices=list(ROOMS), default=list(ROOMS), help="to try changes of"
    )
    parser.add_argument("--write", action="store_true", help="write docs/mutants.md")
    asked = parser.parse_args()
    drawn = sample(ROOT, asked.seed, asked.number)
    patterns = [one for room in asked.rooms for one in ROOMS[room]]
    chosen = [one for one in drawn if any(fnmatch(one.module, p) for p in patterns)]
    before: dict[str, str] = _read(KEPT / "noticed.json") if asked.again or asked.show else {}
    noticed = {name: by for name, by in before.items() if by or asked.show}
    if not asked.show:
        _try([one for one in chosen if one.name not in noticed], noticed, asked)
    told = page.lines(ROOMS, drawn, noticed, asked.seed, (asked.longest, asked.seconds))
    print(*told, sep="\n")
    if asked.write:
        write_part(ROOT / "docs" / "mutants.md", "mutants", told)


def _try(left: Sequence[Change], noticed: dict[str, str], asked: argparse.Namespace) -> None:
    """Try changes, and note of each which test noticed it; empty if none did."""
    load()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))
    tried: list[Change] = []
    seen: dict[Change, Ended] = {}
    tests, known = OwnTests(ROOT), Known(KEPT / "tests.json", _code(), asked.longest)

    def say(change: Change, by: str) -> None:
        noticed[change.name] = by
        tried.append(change)
        verdict = f"noticed by {by}" if by else "not noticed"
        print(f"{len(tried)} of {len(left)}: {change.name}: {verdict}", flush=True)
        _write(KEPT / "noticed.json", noticed)

    def trial(change: Change) -> Trial:
        files = tests.files(change.module)
        return Trial(change, True, tuple(files), without=known.left_out())

    def ended(done: Trial, how: Ended) -> list[Trial]:
        if done.made:
            seen[done.change] = how
        else:
            known.learn(done.only, how.seconds)
        return judged(done.change, seen[done.change])

    def judged(change: Change, how: Ended) -> list[Trial]:
        doubtful = [name for name in (how.failed, *how.slow) if "::" in name]
        if unknown := [name for name in doubtful if known.of(name) is None]:
            files = dict.fromkeys(name.partition("::")[0] for name in unknown)
            return [Trial(change, False, tuple(files), only=tuple(unknown))]
        left_out = known.left_out()
        slowed = [f"{name} (takes too long)" for name in how.slow if known.is_quick(name)]
        if by := [name for name in (how.failed, *slowed) if name and name not in left_out]:
            say(change, by[0])
        elif set(doubtful) & set(left_out):
            return [trial(change)]  # now without these
        else:
            say(change, "")
        return []

    times = asked.longest, asked.seconds
    run(ROOT, [trial(change) for change in left], times, asked.jobs, ended)


class Known:
    """How long tests take without a change, of those that it was asked of; kept in a file.

    Parameters
    ----------
    file : Path
        Where it is kept.
    code : str
        Digest of package and tests, of which it is known.
    longest : float
        Processor time that one test may take, s.
    """

    def __init__(self, file: Path, code: str, longest: float) -> None:
        self._file, self._longest, self._key = file, longest, f"{code} {longest}"
        self._seconds: dict[str, float] = _read(file).get(self._key, {})

    def learn(self, asked: Sequence[str], seconds: Mapping[str, float]) -> None:
        """Keep what tests took; those that nothing is told of did not pass."""
        self._seconds |= {name: seconds.get(name, math.inf) for name in asked}
        _write(self._file, {self._key: self._seconds})

    def of(self, name: str) -> float | None:
        """Return the processor time of a test, s; infinite if it does not pass."""
        return self._seconds.get(name)

    def is_quick(self, name: str) -> bool:
        """Return whether a test is far from being left for its time."""
        return self._seconds.get(name, math.inf) < self._longest / _CLEARLY

    def left_out(self) -> tuple[str, ...]:
        """Return the tests that don't pass, or not in time, without a change."""
        return tuple(name for name, took in self._seconds.items() if took == math.inf)


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


def _code() -> str:
    """Digest package and tests."""
    whole = hashlib.sha256()
    for file in sorted([*ROOT.glob("octsim/**/*.py"), *ROOT.glob("tests/**/*.py")]):
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
