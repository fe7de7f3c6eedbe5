"""`octsim cache`: shows and clears the point cache."""

import time
from argparse import Namespace
from pathlib import Path
from typing import Any

CACHE = Path(".octsim/points.sqlite")
"""Where a checkout keeps its traced points: the default of the config's `cache.file`, of which it
takes half a second to ask the config."""


def add(commands: Any) -> None:
    """Add the command to a parser's others."""
    cache = commands.add_parser("cache", help="traced points that are kept")
    actions = cache.add_subparsers(required=True, metavar="action")
    for name, do, purpose in (
        ("show", show_cache, "say how many points it holds, its size and its use"),
        ("clear", clear_cache, "empty it, or replace a damaged one"),
    ):
        action = actions.add_parser(name, help=purpose, description=purpose)
        action.add_argument(
            "--file", type=Path, default=CACHE, help="of the cache (default: %(default)s)"
        )
        action.set_defaults(do=do, failed=1)


def show_cache(given: Namespace) -> int:
    """Print what a cache holds, in a few lines."""
    from octsim.instrument.cache import describe

    file: Path = given.file.expanduser()
    held = describe(file)
    if held is None:
        print(f"{file}: no cache yet")
        return 0
    of = f" of {held.allowed / 1e6:.6g} MB allowed" if held.allowed else ""
    lines = [
        f"{file}: point cache, version {held.version}",
        f"points     {held.entries}",
        f"size       {held.bytes / 1e6:.1f} MB{of}",
    ]
    if held.oldest is not None and held.newest is not None:
        lines += [f"last used  {_when(held.newest)}", f"oldest use {_when(held.oldest)}"]
    print(*lines, sep="\n")
    return 0


def clear_cache(given: Namespace) -> int:
    """Empty a cache, and print how much of the disk that freed."""
    from octsim.instrument.cache import clear

    file: Path = given.file.expanduser()
    if not file.exists():
        print(f"{file}: no cache yet")
        return 0
    before = _size(file)
    clear(file)
    print(f"{file}: {max(before - _size(file), 0) / 1e6:.1f} MB freed")
    return 0


def _when(nanoseconds: int) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(nanoseconds // 1_000_000_000))


def _size(file: Path) -> int:
    log = file.with_name(file.name + "-wal")
    return sum(part.stat().st_size for part in (file, log) if part.exists())
