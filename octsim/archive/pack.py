"""A run as one file for a data repository: what goes in, and how it is described."""

import hashlib
import zipfile
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from octsim.archive import zip_file as zipped
from octsim.archive.checksums import SUMS, digest, pieces_of, written
from octsim.archive.contents import CONFIG, README, Item, Made, items, readme, remarks
from octsim.archive.ro_crate import METADATA, description_of, metadata, title_of
from octsim.archive.ro_crate import remarks as asked_for
from octsim.archive.run_folder import Run, run_in
from octsim.archive.zip_file import Member
from octsim.base.errors import ArchiveError, DatasetError
from octsim.base.files import reason, whole
from octsim.config.models import Config
from octsim.datasets.files import opened


class Packed(NamedTuple):
    """What was packed."""

    file: Path
    files: int
    bytes: int
    remarks: tuple[str, ...]
    """What a user should know, a line each."""

    def __str__(self) -> str:
        return f"{self.file}: {self.files} files, {self.bytes / 1e6:.1f} MB"


def pack(folder: Path, config: Config, file: Path | None = None) -> Packed:
    """Pack a run; the same datasets, figures and config give the same bytes.

    Parameters
    ----------
    folder : path
        The run's, ``results/<run>/``.
    config : Config
        The config that every dataset there follows from: the run's own or, to tell more of it,
        the same with another section `archive`.
    file : path, optional
        The archive, replaced whole; ``<folder>/<run>.zip`` without one.

    Raises
    ------
    ArchiveError
        If a file of the run can't be read.
    DatasetError
        If a dataset can't be read, or follows from another config.
    FileError
        If the archive can't be written; what stood there before is still there.
    """
    run = _run_of(folder, config)
    if file is None and (folder / SUMS).exists():
        raise ArchiveError(f"{folder}: is an unpacked archive, which stays as it is; give --file")
    file = file or folder / f"{config.run}.zip"
    try:
        holds, made = items(run, config)
        members = _members(holds, made, config)
    except OSError as error:
        raise ArchiveError(f"{error.filename or folder}: can't be read ({reason(error)})") from None
    with whole(file) as temporary, temporary.open("w+b") as stream:
        zipped.write(stream, members)
    told = remarks(run, config, holds, made)
    said = [*asked_for(config.archive), *(f"{folder}: {one}" for one in told)]
    return Packed(file, len(members), file.stat().st_size, tuple(said))


def told_before(file: Path) -> Mapping[str, Any]:
    """Give the config of an archive that is to be replaced; nothing if there is none to be read."""
    try:
        with zipfile.ZipFile(file) as archive:
            found = yaml.safe_load(archive.read(CONFIG))
    except (OSError, ValueError, KeyError, RuntimeError, zipfile.BadZipFile, yaml.YAMLError):
        return {}
    return found if isinstance(found, dict) else {}


def _run_of(folder: Path, config: Config) -> Run:
    """Give a folder's run; refuse datasets that don't follow from the config."""
    run = run_in(folder)
    if run.config.run != config.run:
        raise DatasetError(f"{folder}: of the run {run.config.run}, not of {config.run}; name that")
    for stage, file in run.datasets.items():
        with opened(file, stage, config):
            pass  # it says what it is not
    return run


def _members(given: list[Item], made: Mapping[str, Made], config: Config) -> list[Member]:
    """Give all that is to be packed: what there is, what describes it, and the sums."""
    holds = list(given)
    title, described = title_of(config.archive, config.run), description_of(config.archive)
    about = "metadata of this archive (RO-Crate)"
    told = [
        Item(README, "what each file is", b"", "text/markdown"),
        Item(METADATA, about, b"", "application/ld+json"),
    ]
    text = readme(title, described, [*holds, *told], made, config)
    holds.append(told[0]._replace(source=text.encode()))
    measured = {item.name: (_size(item), digest(_pieces(item))) for item in holds}
    described_bytes = metadata(config.run, config.archive, holds, made, measured)
    holds.append(told[1]._replace(source=described_bytes))
    digests = {name: one for name, (_, one) in measured.items()}
    digests[METADATA] = digest([described_bytes])
    holds.append(Item(SUMS, "", written(digests), "text/plain"))
    return [Member(item.name, _size(item), partial(_packed, item, digests)) for item in holds]


def _size(item: Item) -> int:
    return len(item.source) if isinstance(item.source, bytes) else item.source.stat().st_size


def _pieces(item: Item) -> Iterator[bytes]:
    if isinstance(item.source, bytes):
        yield item.source
    else:
        yield from pieces_of(item.source)


def _packed(item: Item, digests: Mapping[str, str]) -> Iterator[bytes]:
    """Give what is packed of a file, which is read for the second time, and must be as it was."""
    found = hashlib.sha256()
    for piece in _pieces(item):
        found.update(piece)
        yield piece
    if found.hexdigest() != digests.get(item.name, found.hexdigest()):
        raise ArchiveError(f"{item.name}: changed while it was packed; pack again")
