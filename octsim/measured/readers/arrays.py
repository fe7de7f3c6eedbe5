"""Recordings in numpy's own files: one array, or several by name."""

from contextlib import ExitStack
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np

from octsim.base.errors import DatasetError, FileError
from octsim.measured.readers.blocks import Source, Turned
from octsim.measured.readers.inside import Container, Held, recording_of
from octsim.measured.readers.on_disk import Mapped
from octsim.measured.readers.zips import array_in, member, opened_zip
from octsim.measured.recording import Recording, Wanted

_SUFFIX = ".npy"


class _Header(NamedTuple):
    """How an array stands in a file of numpy."""

    shape: tuple[int, ...]
    fortran: bool
    dtype: np.dtype[Any]
    offset: int


def _header(file: IO[bytes], name: str) -> _Header:
    version = np.lib.format.read_magic(file)
    if version == (1, 0):
        shape, fortran, dtype = np.lib.format.read_array_header_1_0(file)
    elif version == (2, 0):
        shape, fortran, dtype = np.lib.format.read_array_header_2_0(file)
    else:
        raise FileError(
            f"{name}: is of numpy's format {version[0]}.{version[1]}, which is for records; give "
            "an array of numbers"
        )
    return _Header(shape, fortran, dtype, file.tell())


def array_recording(path: Path, wanted: Wanted, stack: ExitStack) -> Recording:
    """Return the recording in a file ``.npy``, which is mapped into memory."""
    file = stack.enter_context(path.open("rb"))
    header = _header(file, str(path))
    held = Held("", header.shape, header.dtype)

    def source(_: Held) -> Source:
        return Mapped(file, header.dtype, header.shape, header.offset, header.fortran)

    return recording_of(Container(path, [held], source), wanted)


def arrays_recording(path: Path, wanted: Wanted, stack: ExitStack) -> Recording:
    """Return the recording in a file ``.npz``: mapped, or unpacked as it is read."""
    opened = opened_zip(path, stack)
    infos = {
        info.filename.removesuffix(_SUFFIX): info
        for info in opened.archive.infolist()
        if info.filename.endswith(_SUFFIX)
    }
    headers: dict[str, _Header] = {}
    for name, info in infos.items():
        with ExitStack() as beginning:
            headers[name] = _header(member(opened, info, beginning), f"{path}, {name}")
    if not headers:
        raise DatasetError(f"{path}: a zip without arrays of numpy; give one with spectra")

    def source(held: Held) -> Source:
        shape, fortran, dtype, offset = headers[held.name]
        stored = shape[::-1] if fortran else shape
        found = array_in(opened, infos[held.name], dtype, stored, offset, stack)
        return Turned(found) if fortran else found

    arrays = [Held(name, one.shape, one.dtype) for name, one in headers.items()]
    return recording_of(Container(path, arrays, source), wanted)
