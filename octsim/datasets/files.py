"""Datasets: what each variable means, where a dataset came from, and files that appear whole."""

import json
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from enum import IntEnum
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from octsim.base.errors import DatasetError, UncheckedWarning
from octsim.base.failures import said_in_a_line
from octsim.base.file_digest import add_digest, require_undamaged
from octsim.base.files import require_regular, whole
from octsim.base.provenance import environment
from octsim.config.models import Config
from octsim.datasets.axes import wavelengths
from octsim.datasets.catalog import CATALOG
from octsim.datasets.code import code_of
from octsim.datasets.keys import differing
from octsim.datasets.statuses import with_statuses
from octsim.datasets.variables import meaning
from octsim.datasets.versions import SCHEMA, upgraded

CHUNK_CACHE = 1_000_000
"""Bytes that are held of each variable that is read or written in chunks."""
_COMPRESSION = {"zlib": True, "complevel": 4, "shuffle": True}


def make(
    stage: str,
    config: Config,
    title: str,
    variables: Mapping[str, Any],
    coordinates: Mapping[str, Any],
) -> xr.Dataset:
    """Put a stage's results together with what they mean and what made them.

    Parameters
    ----------
    stage : str
        Name of the stage; the dataset's file is ``<stage>.nc``.
    config : Config
        The config that the results follow from.
    title : str
        One line on what is held.
    variables, coordinates : mapping
        As `xarray.Dataset` takes them; each name has its entry in `MEANINGS`.
    """
    dataset = with_wavelength(xr.Dataset(variables, coordinates))
    for name in map(str, dataset.variables):
        dataset[name].attrs = meaning(name) | dataset[name].attrs
    dataset.attrs = attributes(stage, config, title)
    return with_statuses(dataset, stage)


def with_wavelength(dataset: xr.Dataset) -> xr.Dataset:
    """Return a dataset that has the wavelength beside its wavenumber, where it has that."""
    if "wavenumber" not in dataset.coords or "wavelength" in dataset.coords:
        return dataset
    k = dataset["wavenumber"]
    return dataset.assign_coords(wavelength=(k.dims, wavelengths(k.values), meaning("wavelength")))


def attributes(stage: str, config: Config, title: str) -> dict[str, Any]:
    """Return what a dataset says of itself: what it is, and all it takes to make it again."""
    return {
        "Conventions": "CF-1.11",
        "title": title,
        "summary": f"{title}; of simulated optical coherence tomography of a neuron",
        "history": f"octsim {version('octsim')}: stage {stage} of the run {config.run}",
        "license": "as the config's archive.license says when the run is packed",
        "references": "cite octsim as its CITATION.cff says; docs/physics.md has the equations",
        "stage": stage,
        "schema_version": SCHEMA,
        "config": json.dumps(config.to_record()),
        "octsim_version": version("octsim"),
        "environment": json.dumps(environment()),
        "source_digest": code_of(stage, config),
        "creation_command": (
            "save the attribute 'config' of this file as config.json, then: "
            f".venv/bin/snakemake results/{config.run}/{stage}.nc --cores 2 "
            "--configfile config.json"
        ),
    }


def write(dataset: xr.Dataset, path: str | Path) -> None:
    """Write a dataset so that the file is there whole or not at all.

    Raises
    ------
    FileError
        If it can't be written; what stood at `path` before is still there.
    """
    encoding = {
        name: (_COMPRESSION if variable.ndim and variable.dtype.kind in "iuf" else {})
        | ({"_FillValue": None} if variable.dtype.kind == "f" else {})
        for name, variable in dataset.variables.items()
    }
    with whole(Path(path)) as temporary:
        dataset.to_netcdf(temporary, engine="netcdf4", encoding=encoding)
        add_digest(temporary)


def read(
    path: str | Path,
    stage: str | None = None,
    config: Config | None = None,
    without: Iterable[str] = (),
) -> xr.Dataset:
    """Read a stored dataset into memory, as this octsim writes it.

    Parameters
    ----------
    path : path
        The file.
    stage : str, optional
        Stage that it has to be of.
    config : Config, optional
        Config that it has to follow from, as far as its stage depends on one.
    without : iterable of str
        Variables that are not read.

    Raises
    ------
    DatasetError
        If the file is missing, damaged, not a dataset of that stage, made from another config, or
        of a version of octsim that this one can't read.

    Warns
    -----
    UncheckedWarning
        If it has no digest of its bytes, as those of octsim 0.2.0 and before: damage is not seen.

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "tracing": {"rays": 200},
    ...         "sweep": {
    ...             "diameters": {"stop": "1.1 um", "num": 3},
    ...             "focus": {"slope": 0.58, "intercept": "66 nm"},
    ...         },
    ...     }
    ... )
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "detections.nc")
    ...     octsim.detections(config).to_netcdf(file)
    ...     detections = octsim.read(file)
    >>> detections["diameter"].values.tolist()
    [1.0, 1.05, 1.1]
    """
    with opened(path, stage, config) as dataset, guarded(path):
        return dataset.drop_vars(list(without), errors="ignore").load()


@contextmanager
def opened(
    path: str | Path, stage: str | None = None, config: Config | None = None
) -> Iterator[xr.Dataset]:
    """Open a stored dataset, to read parts of it.

    Parameters and what is raised are those of `read`. What is read of it later is `guarded`.
    """
    path = Path(path)
    with guarded(path):
        checked = _has_digest(path, stage)
        dataset = _dataset(path)
    with dataset:
        with guarded(path):
            found = _checked(dataset, path, stage, config)
        if not checked:
            _say_unchecked(path.parent)
        yield found


@contextmanager
def guarded(path: str | Path, remedy: str = "") -> Iterator[None]:
    """Say in one line that a dataset can't be read, whatever libraries raise of its file."""
    remedy = remedy or _remedy(Path(path))
    with said_in_a_line(str(path), remedy, DatasetError, of_memory=True):
        yield


def _has_digest(path: Path, stage: str | None) -> bool:
    """Check that a dataset is a file, and as it was written; return whether the latter is known."""
    try:
        require_regular(path)
        return require_undamaged(path)
    except FileNotFoundError:
        remedy = f"run the stage {stage} first" if stage else "give a dataset of octsim"
        raise DatasetError(f"{path}: not there; {remedy}") from None


def _dataset(path: Path) -> xr.Dataset:
    usual = netCDF4.get_chunk_cache()
    netCDF4.set_chunk_cache(CHUNK_CACHE)  # or each variable would keep 64 MB of what was read
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # what a library warns of is no file of octsim's
            return xr.open_dataset(path, engine="netcdf4", cache=False)
    finally:
        netCDF4.set_chunk_cache(*usual)


@cache  # once for each folder
def _say_unchecked(folder: Path) -> None:
    warnings.warn(
        f"{folder}: has datasets without a digest of their bytes, as octsim 0.2.0 wrote them or "
        "another program left them, so damage can't be seen; run again to make them anew",
        UncheckedWarning,
        stacklevel=1,
    )


def _remedy(path: Path) -> str:
    if path.stem not in CATALOG:
        # of a file of the user's, which is in nobody's way
        return "give a dataset of octsim, as results/thesis/phase_slope.nc"
    return f"move it away and run again to make {path.name} anew"


def _checked(
    dataset: xr.Dataset, path: Path, stage: str | None, config: Config | None
) -> xr.Dataset:
    """Refuse a dataset of another stage, config or time; give it as this octsim writes it."""
    found = dataset.attrs.get("stage")
    if not isinstance(found, str) or found != (stage or found):
        if stage is None:
            raise DatasetError(f"{path}: not a dataset of octsim; give one that is")
        raise DatasetError(f"{path}: not octsim's dataset of the stage {stage}; {_remedy(path)}")
    # files of 0.3.0 and before lack some
    dataset = with_statuses(with_wavelength(upgraded(dataset, path)), found)
    if config is None:
        return dataset
    differ = differing(found, config, json.loads(dataset.attrs["config"]))
    if differ:
        raise DatasetError(
            f"{path}: made from another config (its {', '.join(differ)} differ); {_remedy(path)}"
        )
    return dataset


Flags = tuple[NDArray[np.int8], dict[str, Any]]
"""The values of a status, and the CF attributes that name them."""


def flags(codes: type[IntEnum], values: NDArray[np.integer[Any]]) -> Flags:
    """Return the values of an enumeration with the CF attributes that name them."""
    members = list(codes)
    return np.asarray(values, np.int8), {
        "flag_values": np.array([m.value for m in members], np.int8),
        "flag_meanings": " ".join(m.name.lower() for m in members),
    }


def flags_of_missing(values: ArrayLike, reason: IntEnum) -> Flags:
    """Return the status of values that are missing, NaN, for one reason; 0 where they are there.

    Parameters
    ----------
    values : array_like
        Of the status's shape.
    reason : IntEnum
        Its code where a value is missing.
    """
    return flags(type(reason), np.where(np.isnan(values), reason, 0))
