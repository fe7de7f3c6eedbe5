"""Mutation testing: how many small wrong changes to the package the tests notice.

Run by `make mutants`, which writes docs/mutants.md:

    python -m mutants [--number N] [--seed TEXT] [--jobs N] [--seconds S] [--longest S]
        [--rooms ROOM ...] [--again] [--show] [--write]
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
    tests = OwnTests(ROOT)
    files = {change: tuple(tests.files(change.module)) for change in left}
    known = _timed(dict.fromkeys(chain.from_iterable(files.values())), asked)
    tried: list[Change] = []

    def trial(change: Change) -> Trial:
        without = (
            name for file in files[change] for name, took in known[file].items() if isinf(took)
        )
        return Trial(change, files[change], tuple(without), asked.seconds)

    def ended(done: Trial, how: Ended) -> None:
        if not done.change:
            return
        slowed = f"{how.slow} (takes too long)" if how.slow else ""
        by = noticed[done.change.name] = how.failed or slowed
        tried.append(done.change)
        verdict = f"noticed by {by}" if by else "not noticed"
        print(f"{len(tried)} of {len(left)}: {done.change.name}: {verdict}", flush=True)
        _write(KEPT / "noticed.json", noticed)

    run(ROOT, [trial(change) for change in left], _CLEARLY * asked.longest, asked.jobs, ended)


def _timed(files: Iterable[str], asked: argparse.Namespace) -> dict[str, dict[str, float]]:
    """Return how long the tests of files take without a change, s; infinite if they don't pass.

    It is kept for the code that it is of.
    """
    kept, key = KEPT / "tests.json", f"{_code()} {asked.longest}"
    known: dict[str, dict[str, float]] = _read(kept).get(key, {})
    unknown = [file for file in files if file not in known]

    def ended(done: Trial, how: Ended) -> None:
        known[done.files[0]] = dict(how.seconds)
        print(f"{len(known)} files of tests are timed: {done.files[0]}", flush=True)
        _write(kept, {key: known})

    run(ROOT, [Trial(None, (file,)) for file in unknown], asked.longest, asked.jobs, ended)
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
