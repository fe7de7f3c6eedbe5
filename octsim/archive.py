"""A run as one file for a data repository: packed, verified, unpacked.

Nothing in an archive is run or unpickled; nothing of it is written before all of it is verified.
"""

import hashlib
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import IO, NamedTuple

from octsim import zipped
from octsim.config import Config
from octsim.crate import METADATA, description_of, metadata, title_of
from octsim.crate import remarks as asked_for
from octsim.errors import ArchiveError, DatasetError, FileError
from octsim.files import reason, whole
from octsim.inventory import README, Item, items, readme, remarks
from octsim.reading import differing
from octsim.runs import Run, run_in
from octsim.sums import LARGEST, SUMS, differences, digest, parsed, pieces_of, written
from octsim.zipped import Member


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
    file = file or folder / f"{config.run}.zip"
    try:
        members = _members(run, config)
    except OSError as error:
        raise ArchiveError(f"{error.filename or folder}: can't be read ({reason(error)})") from None
    with whole(file) as temporary, temporary.open("w+b") as stream:
        zipped.write(stream, members)
    said = [*asked_for(config.archive), *(f"{folder}: {one}" for one in remarks(run, config))]
    return Packed(file, len(members), file.stat().st_size, tuple(said))


def problems(path: Path) -> list[str]:
    """Say what of an archive is not as it was packed, a line each; nothing if all is.

    Parameters
    ----------
    path : path
        A zip, or the folder that one was unpacked to.

    Raises
    ------
    ArchiveError
        If it is not an archive of octsim, or one that is not safe to unpack.
    """
    try:
        if path.is_dir():
            return _in_folder(path)
        with path.open("rb") as stream:
            return _in_zip(stream)
    except ArchiveError as error:
        raise ArchiveError(f"{path}: {error}") from None
    except OSError as error:
        raise ArchiveError(f"{path}: can't be read ({reason(error)})") from None


def verify(path: Path) -> None:
    """Check that an archive, a zip or an unpacked folder, is as it was packed, to the last bit.

    Raises
    ------
    ArchiveError
        If it is not; with a line for each file that is missing, changed or additional.
    """
    said = problems(path)
    if said:
        raise ArchiveError("\n".join(f"{path}: {line}" for line in said))


def unpack(file: Path, folder: Path) -> None:
    """Verify an archive, then unpack it.

    Parameters
    ----------
    file : path
        The zip.
    folder : path
        Where to; not there yet, or empty.

    Raises
    ------
    ArchiveError
        If the archive is not as it was packed, or the folder holds something; nothing is written.
    FileError
        If the folder can't be written; nothing is left in it.
    """
    if file.is_dir():
        raise ArchiveError(f"{file}: is a folder; give an archive's zip")
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise ArchiveError(f"{folder}: is there already and not an empty folder; name another")
    verify(file)
    try:
        place = folder.resolve()
        place.parent.mkdir(parents=True, exist_ok=True)
        # beside it first: what is killed or runs out of disk leaves the folder as it was
        with tempfile.TemporaryDirectory(prefix=f".{place.name}.", dir=place.parent) as name:
            beside = Path(name)
            with file.open("rb") as stream:
                zipped.extract(stream, beside)
            verify(beside)  # what was written, not only what was read
            place.mkdir(exist_ok=True)
            for one in sorted(beside.iterdir()):
                one.rename(place / one.name)
    except OSError as error:
        raise FileError(f"{folder}: can't be written ({reason(error)})") from None


@contextmanager
def unpacked(file: Path) -> Iterator[Path]:
    """Give a temporary folder with what an archive holds, verified.

    Raises
    ------
    ArchiveError, FileError
        As `unpack`.
    """
    with tempfile.TemporaryDirectory(prefix="octsim-") as name:
        folder = Path(name) / "run"
        unpack(file, folder)
        yield folder


def _run_of(folder: Path, config: Config) -> Run:
    """Give a folder's run; refuse datasets that don't follow from the config."""
    run = run_in(folder)
    for stage, file in run.datasets.items():
        differ = differing(stage, config, run.config.to_dict())
        if differ or run.config.run != config.run:
            raise DatasetError(
                f"{file}: made from another config (its {', '.join(differ or ['run'])} differ); "
                "run again to make it anew, or move it away"
            )
    return run


def _members(run: Run, config: Config) -> list[Member]:
    """Give all that is to be packed, with its sums."""
    holds, made = items(run, config)
    title, described = title_of(config.archive, config.run), description_of(config.archive)
    about = "metadata of this archive (RO-Crate)"
    told = [
        Item(README, "what each file is", b"", "text/markdown"),
        Item(METADATA, about, b"", "application/ld+json"),
    ]
    text = readme(title, described, [*holds, *told], made, config.run)
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


def _in_zip(stream: IO[bytes]) -> list[str]:
    found = zipped.contents(stream)
    if found.sums is None:
        raise ArchiveError(f"holds no {SUMS}; not an archive of octsim")
    if not found.sums_intact:
        return [f"{SUMS}: changed"]
    said = differences(parsed(found.sums), {k: v for k, v in found.digests.items() if k != SUMS})
    if not said and not found.canonical:
        said = ["its headers or its directory: changed"]
    return said


def _in_folder(folder: Path) -> list[str]:
    sums = folder / SUMS
    if not sums.is_file() or sums.is_symlink():
        raise ArchiveError(f"holds no {SUMS}; not an archive of octsim that was unpacked")
    if sums.stat().st_size > LARGEST:
        raise ArchiveError(f"its {SUMS} is larger than that of any archive")
    listed = parsed(sums.read_bytes())
    found: dict[str, str] = {}
    for above, folders, files in os.walk(folder):
        # what is no plain file is not opened: a link leads elsewhere, a pipe may have no end
        for name in (*files, *(one for one in folders if (Path(above) / one).is_symlink())):
            file = Path(above) / name
            plain = file.is_file() and not file.is_symlink()
            known = file.relative_to(folder).as_posix()
            found[known] = digest(pieces_of(file)) if plain and known in listed else "not a file"
    del found[SUMS]
    return differences(listed, found)
