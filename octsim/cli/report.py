"""`octsim report`: a run as one page that a person can look at."""

from argparse import Namespace
from pathlib import Path
from typing import Any


def add(commands: Any) -> None:
    """Add the command to a parser's others."""
    purpose = "write a run as one page, an HTML file that needs nothing beside it"
    parser = commands.add_parser("report", help=purpose, description=purpose)
    parser.add_argument("folder", type=Path, help="of the run, as results/thesis")
    parser.add_argument("-o", "--file", type=Path, help="to write (default: <folder>/report.html)")
    parser.add_argument(
        "--combination", type=int, default=1, metavar="NUMBER",
        help="of a grid's combinations, which is shown, from 1 (default: the first)",
    )  # fmt: skip
    parser.add_argument(
        "--config",
        type=Path,
        help="whose section archive says who made the data, and under which licence",
    )
    parser.set_defaults(do=run_report, failed=1)


def run_report(given: Namespace) -> int:
    """Write a report; print where it is."""
    from octsim.config.load import load_config
    from octsim.report.page import report

    archive = load_config(given.config.expanduser()).archive if given.config else None
    file = given.file and given.file.expanduser()
    print(report(given.folder.expanduser(), file, given.combination, archive))
    return 0
