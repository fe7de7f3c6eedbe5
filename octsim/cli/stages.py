"""`octsim calibrate` and `octsim expansion`: from a phase to nanometres, without the workflow."""

import sys
from argparse import Namespace
from functools import partial
from pathlib import Path
from typing import Any

_COMMANDS = {
    # command: dataset, what it is for
    "calibrate": (
        "calibration",
        "calibrate a config's instrument: from a phase to nanometres",
    ),
    "expansion": ("expansion", "turn a measured series of phases into nanometres"),
}


def add(commands: Any) -> None:
    """Add the commands to a parser's others."""
    for command, (dataset, purpose) in _COMMANDS.items():
        parser = commands.add_parser(
            command,
            help=purpose,
            description=f"{purpose[0].upper()}{purpose[1:]}. All that it needs is made in memory, "
            f"and {dataset}.nc is written.",
        )
        parser.add_argument("config", nargs="+", type=Path, help="YAML; later files win")
        parser.add_argument(
            "--output", type=Path, default=Path(f"{dataset}.nc"), help="to write (%(default)s)"
        )
        parser.add_argument(
            "--threads", type=int, default=2, metavar="NUMBER", help="at work (%(default)s)"
        )
        if command == "expansion":
            parser.add_argument("--series", metavar="FILE", help="of phases: expansion.series")
        parser.set_defaults(do=partial(run_stage, dataset), failed=2)


def run_stage(dataset: str, given: Namespace) -> int:
    """Make a dataset in memory, write it and say what it comes to."""
    from octsim.base.errors import ConfigError
    from octsim.base.named import named
    from octsim.config.load import load_and_tell
    from octsim.datasets.catalog import CATALOG
    from octsim.datasets.files import write
    from octsim.stages.in_memory import run

    if given.threads < 1:
        raise ConfigError(f"--threads: {given.threads} given; give 1 or more")
    series = getattr(given, "series", None)
    asked = [{"expansion": {"series": series}}] if series else []
    config, said = load_and_tell(*given.config, *asked)
    for remark in said:
        print(f"octsim: warning: {remark}", file=sys.stderr)
    row = CATALOG[dataset]
    found = run(config, dataset, threads=given.threads)[dataset]
    write(found, given.output)
    print(f"{given.output}: {named(row.summary)(found)}")
    sys.stdout.flush()  # before the warnings, where both go to one screen
    for doubt in row.doubts_of(found):
        print(f"octsim: warning: {doubt}", file=sys.stderr)
    return 0
