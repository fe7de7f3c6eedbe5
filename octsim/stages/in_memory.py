"""A whole run in one call: every dataset in memory, each made from those before it."""

import difflib
from collections.abc import Mapping
from os import PathLike
from typing import Any

import xarray as xr

from octsim.base.errors import ConfigError
from octsim.base.named import called, named, names
from octsim.config.given import config_of
from octsim.config.grid import without_grid
from octsim.config.models import Config
from octsim.datasets.catalog import CATALOG
from octsim.datasets.keys import inputs_of, stages_of
from octsim.datasets.stage import Stage
from octsim.datasets.streams import Streamed, in_memory
from octsim.instrument.points import Points


def run(
    config: Config | str | PathLike[str] | Mapping[str, Any] | None = None,
    *datasets: str,
    threads: int = 1,
) -> dict[str, xr.Dataset]:
    """Make the datasets of a run in memory: nothing is read from results/ or written.

    Parameters
    ----------
    config : Config, path or mapping, optional
        The run, as a config, a YAML file's name, or what it would hold; without one, the thesis.
    *datasets : str
        Which are wanted, as ``"phase_slope"`` or one beside a run as ``"calibration"``; those that
        they are made from come with them. Without any: all of a run.
    threads : int
        How many points are at work at a time.

    Returns
    -------
    dict of str to Dataset
        By the dataset's name, in the order in which they are made.

    Raises
    ------
    OctsimError
        If the config can't be used, a name is none of a dataset, or a stage can't be made.

    Examples
    --------
    >>> import octsim
    >>> made = octsim.run({"tracing": {"rays": 100}, "sweep": {"diameters": {"num": 5}}})
    >>> made["phase_slope"]["phase_slope"].sizes["diameter"]
    5
    """
    asked = config_of({} if config is None else config)
    wanted = datasets or stages_of(asked)
    for name in wanted:
        if name not in CATALOG:
            nearest = difflib.get_close_matches(name, CATALOG, n=1, cutoff=0)[0]
            raise ConfigError(f"{name}: not a dataset; the nearest that is one is {nearest}")
    points, made = Points(), dict[str, xr.Dataset]()
    for name in _in_order(asked, wanted):
        made[name] = _make(CATALOG[name], asked, made, threads, points)
    return made


def _in_order(config: Config, wanted: tuple[str, ...]) -> list[str]:
    """Return datasets and all that they are made from, in the order of the catalog."""
    needed, open_ = set[str](), list(wanted)
    while open_:
        name = open_.pop()
        if name not in needed:
            needed.add(name)
            open_ += inputs_of(CATALOG[name], config)
    return [name for name in CATALOG if name in needed]


def _make(
    row: Stage, config: Config, made: Mapping[str, xr.Dataset], threads: int, points: Points
) -> xr.Dataset:
    work = named(row.make)
    sources = {name: made[name] for name in inputs_of(row, config)}
    if isinstance(work, Streamed):
        in_order = [sources.get(name) for name in row.after if not names(work.stream, name)]
        stream = called(work.stream, config, *in_order, **sources, threads=threads, points=points)
        return in_memory(stream)
    single = without_grid(config, row.name)
    if not row.serves(config):
        raise ConfigError(f"scene.cylinders: [] given, but {row.name} needs a cylinder; give one")
    tables = [sources.get(name) for name in row.after]
    found: xr.Dataset = called(work, single, *tables, threads=threads, points=points)
    return found
