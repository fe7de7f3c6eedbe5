"""`octsim reproduce`: what is recorded, made anew in another folder and compared."""

import argparse
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from octsim.base.errors import OctsimWarning
from octsim.cli.compare import add_tolerance
from octsim.cli.run import cores, require_workflow

if TYPE_CHECKING:
    from octsim.config.resources import Budget


def add(commands: Any) -> None:
    """Add the command to a parser's others."""
    parser = commands.add_parser(
        "reproduce",
        help="make anew what is recorded, and compare",
        description="Make anew what a run, an archive or a dataset records, and compare.",
        epilog="Exit status: 0 if every number is within the tolerance, 1 if one is not, 2 if "
        "nothing could be compared: wrong arguments, a file that can't be read, a failed run.",
    )
    parser.add_argument("file", type=Path, help="a run's folder, its archive, or a dataset")
    parser.add_argument("folder", type=Path, help="where to make it; empty, or not there yet")
    add_tolerance(parser)
    parser.add_argument(
        "--cores", type=cores, default=2, metavar="NUMBER", help="default: %(default)s"
    )
    parser.add_argument(
        "--cpu-hours", type=float, metavar="NUMBER",
        help="of processor time that it may take, whatever budget is recorded (default: 1)",
    )  # fmt: skip
    parser.add_argument(
        "--disk-gigabytes", type=float, metavar="NUMBER", help="that it may write (default: 20)"
    )
    parser.add_argument("--only", nargs="+", metavar="STAGE", help="some of the datasets")
    parser.set_defaults(do=run_reproduce, failed=2)


def _budget(given: argparse.Namespace) -> "Budget":
    """Return the budget that is asked for: no archive says what may be taken here."""
    from octsim.config.load import load_config

    asked = {"cpu_hours": given.cpu_hours, "disk_gigabytes": given.disk_gigabytes}
    said = {name: number for name, number in asked.items() if number is not None}
    return load_config({"budget": said}).budget


def run_reproduce(given: argparse.Namespace) -> int:
    """Reproduce what the arguments name, and print what differs; return the exit status."""
    from octsim.archive.compare import compare_recorded
    from octsim.archive.compare_text import lines
    from octsim.archive.recorded import recorded
    from octsim.archive.reproduce import chosen, reproduce

    folder = given.folder.expanduser().absolute()
    try:
        require_workflow()
        with (
            # the workflow gives these
            warnings.catch_warnings(action="ignore", category=OctsimWarning),
            recorded(given.file.expanduser()) as found,
        ):
            original = chosen(found, given.only)
            made = reproduce(original, folder, given.cores, _budget(given))
            result = compare_recorded(original, made, given.tolerance)
    except KeyboardInterrupt:
        print("octsim: interrupted; the same command goes on from here", file=sys.stderr)
        return 130
    print(*lines(result), sep="\n")
    return int(result.differs)
