"""A run that was made: its datasets and figures, and the config that all of them follow from."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from octsim.base.errors import DatasetError
from octsim.base.files import is_regular
from octsim.config.models import Config
from octsim.datasets.catalog import CATALOG
from octsim.datasets.files import opened
from octsim.datasets.keys import differing
from octsim.datasets.versions import recorded_config

FIGURES = "figures"
"""Folder of a run's figures, below its own."""


class Run(NamedTuple):
    """A run's files."""

    config: Config
    """What all of the datasets follow from."""
    datasets: Mapping[str, Path]
    """By stage, in alphabetical order."""
    figures: tuple[Path, ...]
    """In alphabetical order."""


def run_in(folder: Path) -> Run:
    """Return the run whose datasets stand in a folder; other files there are none of it.

    Parameters
    ----------
    folder : path
        ``results/<run>/``, or an unpacked archive.

    Raises
    ------
    DatasetError
        If the folder has no datasets, one of them can't be read, or they are of different configs.
    """
    known = {stage: folder / f"{stage}.nc" for stage in sorted(CATALOG)}
    datasets = {stage: file for stage, file in known.items() if is_regular(file)}
    if not datasets:
        raise DatasetError(f"{folder}: no datasets; give a folder as results/thesis")
    configs = {stage: stage_and_config(file, stage)[1] for stage, file in datasets.items()}
    figures = tuple(sorted(path for path in (folder / FIGURES).glob("*") if _is_plain(path)))
    return Run(_common(configs, datasets), datasets, figures)


def stage_and_config(file: Path, stage: str | None = None) -> tuple[str, Config]:
    """Return which stage a dataset says that it is of, and the config that it records.

    Raises
    ------
    DatasetError
        If it can't be read, or is not of the stage that is given.
    """
    with opened(file, stage) as dataset:
        config = Config.model_validate(recorded_config(dataset.attrs))
        return str(dataset.attrs["stage"]), config


def _is_plain(path: Path) -> bool:
    return path.is_file() and not path.is_symlink() and not path.name.startswith(".")


def _common(configs: Mapping[str, Config], datasets: Mapping[str, Path]) -> Config:
    """Return the config that every dataset can have been made from.

    A key that a stage does not read may have been edited since it was made: then the dataset that
    was made last has the config of all.
    """
    # the end of the run, where it is there, has most likely been made last
    candidates = [configs[stage] for stage in sorted(configs, key=lambda one: one != "phase_slope")]
    for config in candidates:
        if not any(_conflicts(config, configs)):
            return config
    stage, keys = next(_conflicts(candidates[0], configs))
    raise DatasetError(
        f"{datasets[stage]}: made from another config than the datasets beside it (its "
        f"{', '.join(keys)} differ); run again to make it anew, or move it away"
    )


def _conflicts(config: Config, configs: Mapping[str, Config]) -> Iterator[tuple[str, list[str]]]:
    """Return the stages that another config than this one made, with the keys that tell."""
    for stage, other in configs.items():
        keys = differing(stage, config, other.to_dict())
        if keys or config.run != other.run:
            yield stage, keys or ["run"]
