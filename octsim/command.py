"""The command `octsim`: shows and clears the point cache, compares runs."""

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

from octsim.cache import clear, describe
from octsim.command_compare import register as register_compare
from octsim.config import Cache
from octsim.errors import OctsimError

CACHE = Path(Cache().file)
"""Where a checkout keeps its traced points."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Say in one line what is wrong with the arguments."""
        self.exit(2, f"{self.prog}: {message}; `{self.prog} --help` says what there is\n")


def show_cache(file: Path) -> str:
    """Say what a cache holds, in a few lines."""
    held = describe(file)
    if held is None:
        return f"{file}: no cache yet"
    of = f" of {held.allowed / 1e6:.6g} MB allowed" if held.allowed else ""
    lines = [
        f"{file}: point cache, version {held.version}",
        f"points     {held.entries}",
        f"size       {held.bytes / 1e6:.1f} MB{of}",
    ]
    if held.oldest is not None and held.newest is not None:
        lines += [f"last used  {_when(held.newest)}", f"oldest use {_when(held.oldest)}"]
    return "\n".join(lines)


def clear_cache(file: Path) -> str:
    """Empty a cache, and say how much of the disk that freed."""
    if not file.exists():
        return f"{file}: no cache yet"
    before = _size(file)
    clear(file)
    return f"{file}: {max(before - _size(file), 0) / 1e6:.1f} MB freed"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; give its exit status."""
    chosen = _parser().parse_args(arguments)
    if "status" in chosen:
        return int(chosen.status(chosen))
    do: Callable[[Path], str] = chosen.do
    try:
        print(do(chosen.file.expanduser()))
    except OctsimError as error:
        print(f"octsim: {error}", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="octsim", description="Ray tracing of OCT of a neuron.")
    commands = parser.add_subparsers(required=True, metavar="command")
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
        action.set_defaults(do=do)
    register_compare(commands)
    return parser


def _when(nanoseconds: int) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(nanoseconds // 1_000_000_000))


def _size(file: Path) -> int:
    log = file.with_name(file.name + "-wal")
    return sum(part.stat().st_size for part in (file, log) if part.exists())
