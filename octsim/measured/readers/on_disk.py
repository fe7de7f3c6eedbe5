"""Numbers that stay in their file until they are read: mapped into memory, or from a stream."""

import mmap
import os
from typing import IO, Any

import numpy as np

from octsim.measured.readers.blocks import Block, Key


class Mapped:
    """Numbers of a file that is mapped into memory."""

    def __init__(
        self, file: IO[bytes], dtype: np.dtype[Any], shape: tuple[int, ...], offset: int,
        fortran: bool = False,
    ) -> None:  # fmt: skip
        self._file, self._end = (
            file,
            offset + int(dtype.itemsize) * int(np.prod(shape, dtype=object)),
        )
        if os.fstat(file.fileno()).st_size < self._end:
            raise EOFError(f"the file is cut short, {self._end} bytes are needed")
        self._numbers = np.memmap(
            file, dtype, "r", offset, shape, "F" if fortran else "C"
        )  # fmt: skip
        self.shape, self.dtype = shape, dtype

    def __getitem__(self, key: Key, /) -> Block:
        """Read a part."""
        # what is mapped of a file that became shorter can't be refused: the process is ended
        if os.fstat(self._file.fileno()).st_size < self._end:
            raise EOFError("the file became shorter while it was read")
        found: Block = np.array(self._numbers[key])
        # pages that were read would stay with this process, up to all of the file
        if hasattr(mmap, "MADV_DONTNEED"):
            self._numbers._mmap.madvise(mmap.MADV_DONTNEED)  # type: ignore[attr-defined]
        return found


class Streamed:
    """Numbers of a stream that is best read forward, as one that was compressed is."""

    def __init__(
        self, stream: IO[bytes], dtype: np.dtype[Any], shape: tuple[int, ...], offset: int
    ) -> None:
        self._stream, self._offset = stream, offset
        self._whole: Block | None = None
        self.shape, self.dtype = shape, dtype

    def __getitem__(self, key: Key, /) -> Block:
        """Read a part: no more than its rows, unless it is of all of them."""
        if self._whole is not None:
            return self._whole[key]
        rows = key[0] if isinstance(key[0], slice) else slice(key[0], key[0] + 1)
        first, last, _ = rows.indices(self.shape[0])
        each = self.dtype.itemsize * int(np.prod(self.shape[1:]))
        self._stream.seek(self._offset + first * each)
        data = self._stream.read((last - first) * each)
        found = np.frombuffer(data, self.dtype).reshape(last - first, *self.shape[1:])
        if last - first == self.shape[0] and len(self.shape) > 1:
            self._whole = found  # spectra stand in columns, and the next block needs all again
        return found[(slice(None) if isinstance(key[0], slice) else 0, *key[1:])]
