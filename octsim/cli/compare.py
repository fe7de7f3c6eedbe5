"""`octsim compare`: two runs side by side."""

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from octsim.base.errors import DatasetError

if TYPE_CHECKING:
    import xarray as xr

    from octsim.archive.recorded import Recorded

_FORMS = (".png", ".svg", ".pdf")
_STATUS = (
    "Exit status: 0 if every number is within the tolerance; 1 if one is beyond it, or not in both "
    "(another config or version by itself is no difference); 2 if the arguments are wrong or "
    "something can't be read."
)


def add(commands: Any) -> None:
    """Add the command to a parser's others."""
    purpose = "say what differs between two runs: config, versions, numbers"
    parser = commands.add_parser("compare", help=purpose, description=purpose, epilog=_STATUS)
    for name in ("A", "B"):
        parser.add_argument(
            name, type=Path, help="a run's folder as results/thesis, its archive, or a dataset"
        )
    add_tolerance(parser)
    drawn = parser.add_mutually_exclusive_group()
    drawn.add_argument(
        "--figure", type=_figure, metavar="FILE",
        help="where both phase slopes over the diameter are drawn, PNG, SVG or PDF "
        "(default: compare_<A>_<B>.png here, of runs that have one)",
    )  # fmt: skip
    drawn.add_argument("--no-figure", action="store_true", help="draw none")
    parser.set_defaults(do=run_compare, failed=2)


def add_tolerance(parser: argparse.ArgumentParser) -> None:
    """Add the option of what counts as the same."""
    parser.add_argument(
        "--tolerance", type=_tolerance, metavar="NUMBER",
        help="largest relative difference of what is the same (default: 1e-12, and of another "
        "environment what the condition of each variable allows)",
    )  # fmt: skip


def _tolerance(text: str) -> float:
    """Read a tolerance: 0 or more."""
    value = float(text)
    if not (value >= 0 and math.isfinite(value)):
        raise argparse.ArgumentTypeError(f"{text} given; give 0 or more")
    return value


def _figure(text: str) -> Path:
    path = Path(text)
    if path.suffix not in _FORMS:
        raise argparse.ArgumentTypeError(f"{text} given; its name ends with .png, .svg or .pdf")
    return path


def run_compare(given: argparse.Namespace) -> int:
    """Print what differs between two runs; return the exit status."""
    from octsim.archive.compare import compare_recorded
    from octsim.archive.compare_text import lines
    from octsim.archive.recorded import recorded
    from octsim.figures.compare import figure_compare
    from octsim.figures.style import look, save

    with recorded(given.A) as one, recorded(given.B) as other:
        figure = None if given.no_figure else given.figure or _usual(one, other)
        slopes = _slopes(one, other) if figure else None  # a figure that can't be is said at once
        result = compare_recorded(one, other, given.tolerance)
        print(*lines(result), sep="\n")
        if figure and slopes:
            with look():
                save(figure_compare(slopes, _named(one, other)), figure)
            print(f"figure: {figure}")
    return int(result.differs)


def _usual(first: "Recorded", second: "Recorded") -> Path | None:
    """Return the file of a figure that was not asked for, if the two runs have one in common."""
    from octsim.datasets.keys import stage_axes

    both = all(
        "phase_slope" in run.datasets and not stage_axes("phase_slope", run.config)
        for run in (first, second)
    )
    return Path(f"compare_{first.config.run}_{second.config.run}.png") if both else None


def _slopes(first: "Recorded", second: "Recorded") -> "tuple[xr.Dataset, xr.Dataset]":
    """Read what the figure is drawn from."""
    from octsim.datasets.files import read

    slopes = []
    for run in (first, second):
        file = run.datasets.get("phase_slope")
        if file is None:
            raise DatasetError(f"{run.name}: no phase_slope.nc, which the figure is drawn from")
        slope = read(file, "phase_slope", without=["component_phase_slope"])
        for name in ("phase_slope", "ideal_phase_slope", "predicted_phase_slope"):
            if name not in slope:
                raise DatasetError(f"{file}: lacks {name}; --no-figure compares it without")
        if slope["phase_slope"].ndim != 1:
            raise DatasetError(f"{file}: of a grid, while the figure is of two runs without one")
        slopes.append(slope)
    return slopes[0], slopes[1]


def _named(first: "Recorded", second: "Recorded") -> tuple[str, str]:
    """Return names that tell two runs apart."""
    if first.config.run != second.config.run:
        return first.config.run, second.config.run
    return f"{first.name} (A)", f"{second.name} (B)"
