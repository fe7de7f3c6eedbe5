"""`octsim show`: what datasets come to, with statuses in words and what is doubtful."""

import math
from argparse import Namespace
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

    from octsim.datasets.stage import Stage


def add(commands: Any) -> None:
    """Add the command to a parser's others."""
    parser = commands.add_parser(
        "show",
        help="say what a dataset, or each of a run, comes to",
        description="Say what a dataset comes to, or each of a run: its result, its statuses in "
        "words, and what is doubtful.",
        epilog="Exit status: 0 if it could be read, 2 if not.",
    )
    parser.add_argument(
        "path", nargs="+", type=Path, help="a dataset, a run's folder as results/thesis, or a zip"
    )
    parser.set_defaults(do=run_show, failed=2)


def run_show(given: Namespace) -> int:
    """Print what is known of each path."""
    from octsim.archive.recorded import recorded
    from octsim.datasets.catalog import CATALOG
    from octsim.datasets.files import opened

    for path in given.path:
        with recorded(path.expanduser()) as found:
            if found.whole:
                print(f"{found.name}: run {found.config.run}, {len(found.datasets)} datasets")
            for row in CATALOG.values():
                if row.name not in found.datasets:
                    continue
                file = found.datasets[row.name]
                with opened(file, row.name) as dataset:
                    name = file.name if found.whole else found.name
                    print(f"{name}: {dataset.attrs['title']}")
                    print(*(f"  {line}" for line in described(row, dataset)), sep="\n")
    return 0


def described(row: "Stage", dataset: "xr.Dataset") -> Iterator[str]:
    """Return what a dataset comes to, a line each; statuses that say the same in one.

    Parameters
    ----------
    row : Stage
        What the catalog says of it.
    dataset : Dataset
        As it is stored.
    """
    from octsim.base.named import named

    if row.summary:
        yield str(named(row.summary)(dataset))
    sizes = ", ".join(f"{name} {size}" for name, size in dataset.sizes.items())
    made = f"octsim {dataset.attrs['octsim_version']}"
    yield f"{len(dataset.data_vars)} variables over {sizes or 'nothing'}; made by {made}"
    told: dict[str, list[str]] = {}
    for name, variable in dataset.data_vars.items():
        if "flag_meanings" in variable.attrs:
            told.setdefault(in_words(variable), []).append(str(name))
    for words, names in told.items():
        yield f"{', '.join(names)}: {words}"
    for doubt in row.doubts_of(dataset):
        yield f"warning: {doubt}"


def in_words(status: "xr.DataArray") -> str:
    """Return how often a variable of flags has each of its meanings, the most frequent first.

    A single one is its meaning alone.
    """
    import numpy as np

    words = [word.replace("_", " ") for word in str(status.attrs["flag_meanings"]).split()]
    codes = np.atleast_1d(status.attrs["flag_values"]).tolist()
    meanings = dict(zip(codes, words, strict=True))
    found, counts = np.unique(status.values, return_counts=True)
    told = [
        # where a combination of a grid has nothing
        (int(count), meanings.get(code.item(), "not there") if not _is_nan(code) else "not there")
        for code, count in zip(found, counts, strict=True)
    ]
    if not status.ndim:
        return told[0][1]
    return ", ".join(f"{word} {count}" for count, word in sorted(told, key=lambda one: -one[0]))


def _is_nan(code: Any) -> bool:
    return isinstance(code.item(), float) and math.isnan(code)
