"""`octsim check`: a config validated, written out whole, and what its run will take."""

import sys
from argparse import Namespace
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from octsim.base.errors import OctsimError

if TYPE_CHECKING:
    from octsim.config.models import Config
    from octsim.stages.cost_estimate import RunEstimate


def add(commands: Any) -> None:
    """Add the command to a parser's others."""
    parser = commands.add_parser(
        "check",
        help="validate a config, and say what its run will take",
        description="Validate a config; print it whole, with units and as YAML, and what its run "
        "takes in points, time, memory and disk. Nothing is computed or written.",
        epilog="Exit status: 0 if it can be run, 2 if not.",
    )
    parser.add_argument(
        "config", nargs="+", type=Path, help="YAML or JSON files; each is laid over those before"
    )
    parser.add_argument("--quiet", "-q", action="store_true", help="print problems alone")
    parser.set_defaults(do=run_check, failed=2)


def run_check(given: Namespace) -> int:
    """Check a config and print what it comes to; what is likely not meant goes to stderr."""
    from octsim.config.load import load_and_tell
    from octsim.config.resolved_text import resolved_lines
    from octsim.stages.cost_estimate import expected

    config, said = load_and_tell(*(path.expanduser() for path in given.config))
    estimate = expected(config)
    if not given.quiet:
        lines = (f"# {line}" for line in _to_come(config, estimate))
        print(*resolved_lines(config), *lines, sep="\n")
    sys.stdout.flush()  # before the warnings, where both go to one screen
    for remark in (*said, *_refused(config, estimate)):
        print(f"octsim: warning: {remark}", file=sys.stderr)
    return 0


def _to_come(config: "Config", estimate: "RunEstimate") -> Iterator[str]:
    """Say what a run of a config is of and what it takes, a line each."""
    from octsim.config.told import told
    from octsim.stages.workload import shares_of

    yield from told(config)
    yield f"results/{config.run}: {estimate}"
    scattered = {stage: count for stage, count in shares_of(config).items() if count > 1}
    if scattered:
        jobs = ", ".join(f"{stage} {count}" for stage, count in scattered.items())
        yield f"jobs that share a stage (scatter.minutes): {jobs}"


def _refused(config: "Config", estimate: "RunEstimate") -> list[str]:
    """Return why a run of a config would not begin, a line each."""
    from octsim.stages.cost_estimate import check_budget

    try:
        check_budget(config, estimate.of(*estimate.stages), Path(f"results/{config.run}"))
    except OctsimError as error:
        return str(error).splitlines()
    return []
