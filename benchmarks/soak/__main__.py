"""Runs under faults, for as long as is wanted: random configs, and bits that are compared.

Run by `make soak`, which writes docs/reliability.md:

    python -m soak [--minutes M] [--stops N] [--jobs N] [--seed TEXT] [--write]
"""

import argparse
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import count, islice
from pathlib import Path
from random import Random
from signal import SIGINT, SIGKILL, SIGTERM
from signal import signal as on_signal

from marked import write_part
from soak.drawn import Drawn, drawn
from soak.page import Found, first_line
from soak.runs import Run, Seen, differing, filled, moments, small_disk, two_at_once

ROOT = Path(__file__).parents[2]
_LOCK = threading.Lock()
_STOPPED = threading.Event()
_STOPS = 9  # of one run at most, which else would never come to its end
_EVERY = 6  # rounds, of which one has two runs at once, and another a full disk


def main() -> int:
    """Soak, say what was found, and return 1 if anything was not as it should be."""
    parser = argparse.ArgumentParser(description=__doc__, prog="python -m soak")
    parser.add_argument("--minutes", type=float, default=20.0, help="begin no round after (20)")
    parser.add_argument("--stops", type=int, help="end once each signal has hit so many runs")
    parser.add_argument("--jobs", type=int, default=1, help="rounds at once (1)")
    parser.add_argument("--seed", default="octsim", help="of all that is drawn")
    parser.add_argument("--write", action="store_true", help="write docs/reliability.md")
    asked = parser.parse_args()
    for number in (SIGINT, SIGTERM):  # what has begun ends, and folders and small disks go
        on_signal(number, lambda *_: _STOPPED.set())
    found, began = Found(asked.seed), time.monotonic()
    numbers = count(1)

    def rounds() -> None:
        while True:
            with _LOCK:
                number = next(numbers)
                found.minutes = (time.monotonic() - began) / 60
                enough = asked.stops and min(found.stops.values(), default=0) >= asked.stops
            if enough or found.minutes > asked.minutes or _STOPPED.is_set():
                return
            with tempfile.TemporaryDirectory(prefix="octsim-soak-") as name:
                one_round(Path(name), Random(f"{asked.seed} {number}"), number, found)
            print(f"{number}: {found.stops}, {len(found.wrong)} wrong", flush=True)

    with ThreadPoolExecutor(asked.jobs) as pool:
        for ended in [pool.submit(rounds) for _ in range(asked.jobs)]:
            ended.result()
    print(*found.lines(), sep="\n")
    if asked.write:
        write_part(ROOT / "docs" / "reliability.md", "soak", found.lines())
    return bool(found.wrong)


def one_round(folder: Path, draw: Random, number: int, found: Found) -> None:
    """Run one config whole, then with what is drawn for it, and compare."""
    config = drawn(draw)
    wrong = _Wrong(found, f"config {number}")
    first = Run(folder / "whole", config)
    began = time.monotonic()
    seen = first.whole()
    seconds, right = time.monotonic() - began, first.results()
    _count(found, config)
    if seen.status or seen.wrong:
        wrong.say("a run that nothing happens to", "\n".join(seen.screen))
        return
    stopped = Run(folder / "stopped", config)
    for signal, after in islice(moments(draw, seconds), _STOPS):
        stop = stopped.stopped(signal, after)
        wrong.say(f"{signal.name} after {after:.2f} s", stop.wrong)
        if not stop.hit or _STOPPED.is_set():
            break
        with _LOCK:
            found.stops[signal.name] = found.stops.get(signal.name, 0) + 1
            if signal != SIGKILL:
                longest = max(stop.seconds, found.longest.get(signal.name, 0.0))
                found.longest[signal.name] = longest
    _go_on(stopped, right, wrong, found)
    if number % _EVERY == 0:
        pair = Run(folder / "one", config), Run(folder / "other", config)
        every, cleared = two_at_once(*pair, folder / "cache")
        with _LOCK:
            found.together, found.cleared = found.together + 1, found.cleared + cleared
        for one in every:
            wrong.say("two at once", one.wrong or ("" if one.status == 0 else _told(one)))
        for run in pair:
            _compared(found)
            wrong.say("two at once", ", ".join(differing(run.results(), right)))
    if number % _EVERY == _EVERY // 2:
        with small_disk(folder / "disk") as there:
            if there:
                run = Run(folder / "disk" / "run", config)
                seen = filled(run, folder / "disk", draw.uniform(0, seconds))
                with _LOCK:
                    found.full += 1
                    found.failed_full += bool(seen.status)
                wrong.say("a full disk", seen.wrong)
                _go_on(run, right, wrong, found)


class _Wrong:
    """Notes what is not as it should be, with its config."""

    def __init__(self, found: Found, of: str) -> None:
        self._found, self._of = found, of

    def say(self, what: str, wrong: str) -> None:
        """Note it, if there is anything."""
        if wrong:
            print(f"WRONG: {self._of}, {what}:\n{wrong}", flush=True)
            self._found.wrong.append(f"{self._of}, {what}: {first_line(wrong)}")


def _go_on(run: Run, right: dict[str, bytes], wrong: _Wrong, found: Found) -> None:
    """Run the same command again, and compare."""
    seen = run.whole()
    wrong.say("the same command again", seen.wrong or ("" if seen.status == 0 else _told(seen)))
    _compared(found)
    wrong.say("the same command again", ", ".join(differing(run.results(), right)))


def _told(seen: Seen) -> str:
    return f"status {seen.status}: " + "\n".join(seen.screen)


def _compared(found: Found) -> None:
    with _LOCK:
        found.compared += 1


def _count(found: Found, config: Drawn) -> None:
    scheme = config.overlay["tracing"]["scheme"]
    with _LOCK:
        found.configs += 1
        found.schemes[scheme] = found.schemes.get(scheme, 0) + 1
        found.grids += "grid" in config.overlay
        found.scattered += config.scattered


if __name__ == "__main__":
    sys.exit(main())
