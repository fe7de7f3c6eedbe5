"""The datasets of a run, or one of them, against the digests of their bytes that they hold."""

from pathlib import Path
from typing import NamedTuple

from octsim.archive.checksums import SUMS
from octsim.base.errors import DatasetError
from octsim.base.file_digest import is_as_written
from octsim.base.files import is_folder, is_regular, reason, require_regular

_HDF5 = b"\x89HDF"


class Verified(NamedTuple):
    """Files of datasets, by what their digests tell."""

    whole: tuple[Path, ...]
    """As they were written, to the last bit."""
    damaged: tuple[Path, ...]
    unknown: tuple[Path, ...]
    """Without a digest, as octsim 0.2.0 wrote them, or as another program left them."""


def is_of_datasets(path: Path) -> bool:
    """Return whether a path is a dataset, or a folder that is no unpacked archive."""
    if is_folder(path):
        return not (path / SUMS).exists()
    if not is_regular(path):
        return False  # which whoever reads archives says
    with path.open("rb") as file:
        return path.suffix == ".nc" or file.read(len(_HDF5)) == _HDF5


def verified(path: Path) -> Verified:
    """Look at a dataset, or at all that stand in a folder.

    Raises
    ------
    DatasetError
        If there is none, or one can't be read.
    """
    if is_folder(path):
        files = sorted(file for file in path.glob("*.nc") if not file.name.startswith("."))
        if not files:
            raise DatasetError(f"{path}: no datasets and no archive; give one as results/thesis")
    else:
        files = [path]
    found: dict[bool | None, list[Path]] = {True: [], False: [], None: []}
    for file in files:
        try:
            require_regular(file)
            found[is_as_written(file)].append(file)
        except OSError as error:
            raise DatasetError(f"{file}: can't be read ({reason(error)}); move it away") from None
    return Verified(tuple(found[True]), tuple(found[False]), tuple(found[None]))
