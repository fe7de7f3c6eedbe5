"""A run as one file for a data repository."""

import io
import zipfile
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from octsim.archive.checksums import SUMS, format_sums
from octsim.archive.contents import CONFIG, METADATA, Item, items_of, omissions
from octsim.archive.readme import readme
from octsim.archive.ro_crate import metadata, unanswered
from octsim.archive.run_folder import Run, run_in
from octsim.archive.verify import problems_in_zip
from octsim.archive.zip_file import Member, write
from octsim.base.errors import ArchiveError, DatasetError
from octsim.base.files import digest, reason, require_regular, whole
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
        If a file of the run can't be read, or changes meanwhile.
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
        items = items_of(run, config)
        members = _members(items, config)
    except OSError as error:
        raise ArchiveError(f"{error.filename or folder}: can't be read ({reason(error)})") from None
    with whole(file) as temporary, temporary.open("w+b") as stream:
        write(stream, members)
        # files were read for their sums before they were read to be packed
        for line in problems_in_zip(stream):
            raise ArchiveError(f"{line} while it was packed; pack again")
    remarks = [
        *unanswered(config.archive),
        *(f"{folder}: {line}" for line in omissions(run, config, items)),
    ]
    return Packed(file, len(members), file.stat().st_size, tuple(remarks))


def packed_config(file: Path) -> Mapping[str, Any]:
    """Return the config in an archive that is to be replaced; empty if there is none to be read."""
    try:
        require_regular(file)
        with zipfile.ZipFile(file) as archive:
            config = yaml.safe_load(archive.read(CONFIG))
    except (OSError, ValueError, KeyError, RuntimeError, zipfile.BadZipFile, yaml.YAMLError):
        return {}
    return config if isinstance(config, dict) else {}


def _run_of(folder: Path, config: Config) -> Run:
    """Return a folder's run; refuse datasets that don't follow from the config."""
    run = run_in(folder)
    if run.config.run != config.run:
        raise DatasetError(f"{folder}: of the run {run.config.run}, not of {config.run}; name that")
    for stage, file in run.datasets.items():
        with opened(file, stage, config):
            pass  # it says what it is not
    return run


def _members(items: list[Item], config: Config) -> list[Member]:
    """Return all that is to be packed: what there is, what describes it, and the sums."""
    items = [*items, readme(items, config)]
    members = [_member(item.name, item.source) for item in items]
    sizes = {member.name: member.size for member in members}
    digests = {member.name: _digest(member) for member in members}
    members.append(_member(METADATA, metadata(config, items, sizes, digests)))
    digests[METADATA] = _digest(members[-1])
    return [*members, _member(SUMS, format_sums(digests))]


def _member(name: str, source: Path | bytes) -> Member:
    if isinstance(source, bytes):
        return Member(name, len(source), partial(io.BytesIO, source))
    return Member(name, source.stat().st_size, lambda: source.open("rb"))


def _digest(member: Member) -> str:
    with member.open() as data:
        return digest(data)
