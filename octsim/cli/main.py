"""The command `octsim`: its parser, and how it ends."""

import argparse
import os
import sys
from argparse import Namespace
from collections.abc import Callable, Sequence
from typing import NoReturn

from octsim.base.errors import OctsimError
from octsim.cli import archive as archive_command
from octsim.cli import cache as cache_command
from octsim.cli import compare as compare_command

PARTS = (archive_command, compare_command, cache_command)
"""Modules that add commands of their own."""


class Parser(argparse.ArgumentParser):
    """Says in one line what is wrong with the arguments."""

    def error(self, message: str) -> NoReturn:
        """Say it, and where more is said."""
        self.exit(2, f"{self.prog}: {message}; `{self.prog} --help` says what there is\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; give its exit status."""
    parser = Parser(prog="octsim", description="Ray tracing of OCT of a neuron.")
    commands = parser.add_subparsers(required=True, metavar="command")
    for part in PARTS:
        part.add(commands)
    given = parser.parse_args(arguments)
    do: Callable[[Namespace], int] = given.do
    try:
        ended = do(given)
        sys.stdout.flush()
        return ended
    except BrokenPipeError:  # who reads has seen enough, as head and less have
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OctsimError as error:
        for line in str(error).splitlines():
            print(f"octsim: {line}", file=sys.stderr)
        return int(given.failed)
