"""The command `octsim`: its parser, and how it ends."""

import argparse
import itertools
import os
import sys
import warnings
from argparse import Namespace
from collections.abc import Callable, Sequence
from typing import NoReturn

import octsim
from octsim.base.errors import ConfigError, OctsimError, OctsimWarning
from octsim.base.surroundings import settle
from octsim.cli import (
    archive,
    cache,
    check,
    compare,
    completion,
    init,
    measured,
    report,
    reproduce,
    run,
    show,
    stages,
)

MODULES = (
    init, check, run, show, measured, stages, report, archive, compare, reproduce, cache,
    completion,
)  # fmt: skip
"""Each adds commands of its own, and imports what does their work when one is asked for."""


class Parser(argparse.ArgumentParser):
    """Prints in one line what is wrong with the arguments."""

    def error(self, message: str) -> NoReturn:
        """Print it, and where more is said; exit with 2."""
        self.exit(2, f"{self.prog}: {message}; `{self.prog} --help` says what there is\n")


def _show(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
    """Print a warning of octsim's as a line of it; others are of who works on octsim."""
    if issubclass(category, OctsimWarning):
        print(f"octsim: warning: {message}", file=sys.stderr)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit status.

    Without arguments they are the process's own, which goes without what its environment holds
    for other programs.
    """
    if arguments is None:
        settle()
    parser = Parser(prog="octsim", description="Ray tracing of OCT of a neuron.")
    parser.add_argument("--version", action="version", version=f"octsim {octsim.__version__}")
    commands = parser.add_subparsers(required=True, metavar="command")
    for module in MODULES:
        module.add(commands)
    given = _parsed(parser, sys.argv[1:] if arguments is None else arguments)
    do: Callable[[Namespace], int] = given.do
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _show
            ended = do(given)
        sys.stdout.flush()
        return ended
    except BrokenPipeError:  # who reads has seen enough, as head and less have
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        print("octsim: stopped", file=sys.stderr)
        return 130
    except OctsimError as error:
        for line in str(error).splitlines():
            print(f"octsim: {line}", file=sys.stderr)
        return 2 if isinstance(error, ConfigError) else int(given.failed)


def _parsed(parser: Parser, arguments: Sequence[str]) -> Namespace:
    """Return the arguments; `run` takes its words on both sides of options, and flags after --."""
    if list(arguments[:1]) != ["run"]:
        return parser.parse_args(arguments)
    own = list(itertools.takewhile(lambda word: word != "--", arguments))
    given, more = parser.parse_known_args(own)
    if wrong := [word for word in more if word.startswith("-")]:
        parser.error(f"unrecognized arguments: {' '.join(wrong)}; write snakemake's own after --")
    given.words += more
    given.flags = list(arguments[len(own) + 1 :])
    return given
