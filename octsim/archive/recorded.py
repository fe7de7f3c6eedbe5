"""What a person names, a run's folder, its archive or a dataset, as the datasets that it holds."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from octsim.archive.run_folder import run_in, stage_and_config
from octsim.archive.verify import unpacked
from octsim.base.errors import DatasetError
from octsim.base.files import is_folder, reason, require_regular
from octsim.config.models import Config
from octsim.datasets.keys import keys_behind


class Recorded(NamedTuple):
    """Datasets of one config."""

    name: str
    """As it was given."""
    config: Config
    """What all of the datasets follow from."""
    datasets: Mapping[str, Path]
    """By stage, in alphabetical order."""
    whole: bool
    """Whether it is a run, and not one file: then a dataset that it does not hold is missing."""


@contextmanager
def recorded(path: Path) -> Iterator[Recorded]:
    """Return what stands at a path; an archive is unpacked for as long as it is looked at.

    Raises
    ------
    ArchiveError, DatasetError
        If it is no run and no dataset, or one that can't be read.
    """
    with _located(path) as place:
        if place.is_dir():
            run = run_in(place)
            yield Recorded(str(path), run.config, run.datasets, True)
        else:
            stage, config = stage_and_config(place)
            # whatever a file calls itself may become a file's name
            if not keys_behind(stage, config):
                raise DatasetError(f"{place}: of the stage {stage!r}, which this octsim lacks")
            yield Recorded(str(path), config, {stage: place}, False)


@contextmanager
def _located(path: Path) -> Iterator[Path]:
    """Return the folder that has a run's datasets, or the one dataset's file, that a path means.

    Raises
    ------
    ArchiveError
        If an archive is not as it was packed.
    DatasetError
        If there is nothing, or something else.
    """
    try:
        if not is_folder(path):
            require_regular(path)
    except FileNotFoundError:
        raise DatasetError(
            f"{path}: not there; give a run's folder as results/thesis, or a file"
        ) from None
    except OSError as error:
        raise DatasetError(
            f"{path}: can't be read ({reason(error)}); give a run's folder as results/thesis, or a "
            "file"
        ) from None
    if path.suffix == ".zip":
        with unpacked(path) as folder:
            yield folder
    elif is_folder(path) or path.suffix == ".nc":
        yield path
    else:
        raise DatasetError(
            f"{path}: neither a run's folder, nor an archive, nor a dataset; give one as "
            "results/thesis, results/thesis/thesis.zip or results/thesis/phase_slope.nc"
        )
