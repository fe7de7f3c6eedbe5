"""Recordings as nothing but numbers, of which a user says how they stand."""

from contextlib import ExitStack
from pathlib import Path

import numpy as np

from octsim.base.errors import DatasetError
from octsim.measured.readers.failures import sizes
from octsim.measured.readers.inside import Container, Held, recording_of
from octsim.measured.readers.on_disk import Mapped
from octsim.measured.recording import RawForm, Recording, Wanted

_TYPES = (
    "uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64",
    "float16", "float32", "float64",
)  # fmt: skip


def raw_recording(path: Path, form: RawForm, wanted: Wanted, stack: ExitStack) -> Recording:
    """Return the recording in a raw binary file, which is mapped into memory.

    Samples are its last dimension, if K is not known to be the size of another.

    Raises
    ------
    DatasetError
        If the file has another size than its form.
    """
    if form.dtype not in _TYPES:
        raise DatasetError(
            f"{path}: measured.raw.dtype is {form.dtype!r}; give one of {', '.join(_TYPES)}"
        )
    if form.order not in ("little", "big"):
        raise DatasetError(f"{path}: measured.raw.order is {form.order!r}; give little or big")
    dtype = np.dtype(form.dtype).newbyteorder("<" if form.order == "little" else ">")
    shape = _shape(path, form, dtype.itemsize)
    file = stack.enter_context(path.open("rb"))
    held = Held("", shape, dtype, rows=True)
    return recording_of(
        Container(path, [held], lambda _: Mapped(file, dtype, shape, form.offset)), wanted
    )


def _shape(path: Path, form: RawForm, each: int) -> tuple[int, ...]:
    """Return the sizes of a raw binary file, as they follow from its form and its bytes."""
    bytes_of = path.stat().st_size - form.offset
    free = [size for size in form.shape if size == -1]
    fixed = [size for size in form.shape if size != -1]
    if not form.shape or len(free) > 1 or any(size < 1 for size in fixed):
        raise DatasetError(
            f"{path}: measured.raw.shape is {list(form.shape)}; give the spectra and the samples, "
            "as [-1, 2048]"
        )
    if form.offset < 0 or bytes_of <= 0:
        raise DatasetError(
            f"{path}: has {path.stat().st_size} bytes, and measured.raw.offset is {form.offset}; "
            "give one within the file"
        )
    known = each * int(np.prod(fixed, dtype=object))
    if free and bytes_of % known == 0:
        return tuple(bytes_of // known if size == -1 else size for size in form.shape)
    if not free and bytes_of == known:
        return form.shape
    whole = f"a multiple of {known}" if free else f"{known}"
    raise DatasetError(
        f"{path}: has {bytes_of} bytes after the first {form.offset}, and numbers of {form.dtype} "
        f"in {sizes(form.shape)} take {whole}; give measured.raw as the file is"
    )
