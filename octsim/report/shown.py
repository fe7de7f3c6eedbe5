"""What a report shows: a run's datasets, of one combination where it is a grid."""

import json
from collections.abc import Iterator, Mapping
from itertools import islice
from typing import NamedTuple

import xarray as xr

from octsim.archive.report_file import SHOWN
from octsim.archive.run_folder import Run
from octsim.base.errors import DatasetError
from octsim.config.grid import Combination, combinations
from octsim.config.models import Config
from octsim.datasets.catalog import CATALOG
from octsim.datasets.files import opened
from octsim.datasets.reader import Stored

_LEFT_OUT: Mapping[str, tuple[str, ...]] = {
    "fourier": ("magnitude", "phase", "phase_status"),
    "phase_slope": ("component_phase_slope", "component_slope_status"),
}
"""Variables that may be large, and are not shown."""
_MOST_COMPARED = 60
"""Combinations of a grid that are listed."""


class Shown(NamedTuple):
    """A run as a report shows it."""

    run: Run
    config: Config
    """Of what is shown: the run's, without a grid."""
    datasets: Mapping[str, xr.Dataset]
    """By name, in the order in which they are made."""
    number: int
    """Of the combination that is shown, from 1."""
    combinations: int
    """Of the combinations; 1 without a grid."""
    combination: str
    """What is varied, and its values there; empty without a grid."""


def shown_of(run: Run, number: int = 1) -> Shown:
    """Read what a report shows of a run.

    Parameters
    ----------
    run : Run
        As `run_in` finds it.
    number : int
        Of the grid's combinations, from 1, in their order.

    Raises
    ------
    DatasetError
        If a dataset can't be read, or there is no such combination.
    """
    count = sum(1 for _ in combinations(run.config))
    if not 1 <= number <= count:
        has = f"a grid of {count} combinations" if run.config.grid.varied else "no grid"
        raise DatasetError(
            f"--combination: {number} given, but the run has {has}; give 1 to {count}"
        )
    at = next(islice(combinations(run.config), number - 1, None))
    names = [name for name in CATALOG if name in SHOWN and name in run.datasets]
    datasets = {name: _part(run, name, at) for name in names}
    return Shown(run, at.config, datasets, number, count, str(at) if run.config.grid.varied else "")


def _part(run: Run, name: str, at: Combination, names: tuple[str, ...] = ()) -> xr.Dataset:
    """Read what a dataset has of a combination, as if its config varied nothing."""
    with opened(run.datasets[name], name) as dataset:
        kept = dataset.drop_vars(list(_LEFT_OUT.get(name, ())), errors="ignore")
        part = Stored(kept, name, run.config).part(at, names=names)
    return part.assign_attrs(dataset.attrs | {"config": json.dumps(at.config.to_record())})


def compared(run: Run) -> Iterator[tuple[int, str, float, float]]:
    """Return number, name, mean slope and scatter (mrad/nm) of the combinations of a grid."""
    if not run.config.grid.varied or "phase_slope" not in run.datasets:
        return
    of_each = ("mean_phase_slope", "phase_slope_standard_deviation")
    with opened(run.datasets["phase_slope"], "phase_slope") as dataset:
        stored = Stored(dataset, "phase_slope", run.config)
        for number, at in enumerate(islice(combinations(run.config), _MOST_COMPARED), 1):
            part = stored.part(at, names=of_each)
            mean, scatter = (float(part[name]) for name in of_each)
            yield number, str(at), mean, scatter
