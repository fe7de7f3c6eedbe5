"""`octsim cache`: shows and clears the point cache."""

import time
from argparse import Namespace
from pathlib import Path
from typing import Any

CACHE = Path(".octsim/points")
"""Where a checkout keeps its traced points: the default of the config's `cache.file`, of which it
takes half a second to ask the config."""


def add(commands: Any) -> None:
    """Add the command to a parser's others."""
    cache = commands.add_parser("cache", help="traced points that are kept")
    actions = cache.add_subparsers(required=True, metavar="action")
    for name, do, purpose in (
        ("show", show_cache, "say how many points it holds, its size and its use"),
        ("clear", clear_cache, "empty it"),
    ):
        action = actions.add_parser(name, help=purpose, description=purpose)
        action.add_argument(
            "--file", type=Path, default=CACHE, help="its folder (default: %(default)s)"
        )
        action.set_defaults(do=do, failed=1)


def show_cache(given: Namespace) -> int:
    """Print what a cache holds, in a few lines."""
    from octsim.instrument.point_folder import folder_of, old_cache, old_cache_remark
    from octsim.instrument.point_store import describe

    file: Path = given.file.expanduser()
    held = describe(file)
    if held is None:
        lines = [f"{file}: no cache yet"]
    else:
        of = f" of {held.allowed / 1e6:.6g} MB allowed" if held.allowed else ""
        lines = [
            f"{folder_of(file)}: point cache, version {held.version}",
            f"points     {held.points}",
            f"size       {held.bytes / 1e6:.1f} MB{of}",
        ]
        if held.oldest is not None and held.newest is not None:
            lines += [f"last used  {_when(held.newest)}", f"oldest use {_when(held.oldest)}"]
    if old := old_cache(file):
        lines.append(old_cache_remark(old))
    print(*lines, sep="\n")
    return 0


def clear_cache(given: Namespace) -> int:
    """Empty a cache, and print how much of the disk that freed."""
    from octsim.instrument.point_folder import folder_of, old_cache, old_cache_remark
    from octsim.instrument.point_store import clear

    file: Path = given.file.expanduser()
    freed = clear(file)
    done = "no cache yet" if freed is None else f"{freed / 1e6:.1f} MB freed"
    lines = [f"{folder_of(file)}: {done}"]
    if old := old_cache(file):
        lines.append(old_cache_remark(old))
    print(*lines, sep="\n")
    return 0


def _when(seconds: float) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(seconds))
