"""The header of netCDF 3, as far as it says how long the file is.

Its library returns zeros for what stands beyond the end of a file that is cut short.
"""

from pathlib import Path
from typing import IO, NamedTuple

import numpy as np

from octsim.base.errors import FileError

_MARKS = {b"CDF\x01": (4, 4), b"CDF\x02": (4, 8), b"CDF\x05": (8, 8)}
"""Bytes of a count and of an offset, by how a file begins."""
_SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 4, 6: 8, 7: 1, 8: 2, 9: 4, 10: 8, 11: 8}
"""Bytes of each type."""


class _Variable(NamedTuple):
    """A variable, as the header has it."""

    shape: tuple[int, ...]
    """Of one record, if it is over the dimension of records, which is 0."""
    record: bool
    each: int
    begin: int

    @property
    def bytes(self) -> int:
        """Of a record, or of all."""
        return self.each * int(np.prod(self.shape, dtype=object))


class _Header:
    """Reads a header from its first byte on."""

    def __init__(self, file: IO[bytes], count: int, offset: int) -> None:
        self._file, self._count, self._offset = file, count, offset

    def number(self, size: int = 0) -> int:
        """Return the next number: a count, or one of so many bytes."""
        size = size or self._count
        data = self._file.read(size)
        if len(data) < size:
            raise EOFError
        return int.from_bytes(data, "big")

    def skip(self, size: int) -> None:
        """Leave out what takes some bytes, and those up to a multiple of four."""
        self._file.seek(size + -size % 4, 1)

    def attributes(self) -> None:
        """Leave out a list of attributes."""
        self.number(4)
        for _ in range(self.number()):
            self.skip(self.number())
            kind = self.number(4)
            self.skip(_SIZES[kind] * self.number())

    def dimensions(self) -> list[int]:
        """Return the lengths of dimensions."""
        self.number(4)
        lengths = []
        for _ in range(self.number()):
            self.skip(self.number())
            lengths.append(self.number())
        return lengths

    def variable(self, lengths: list[int]) -> _Variable:
        """Return the next variable."""
        self.skip(self.number())
        shape = [lengths[self.number()] for _ in range(self.number())]
        self.attributes()
        each = _SIZES[self.number(4)]
        self.number()
        record = bool(shape) and shape[0] == 0
        return _Variable(tuple(shape[record:]), record, each, self.number(self._offset))


def require_whole(path: Path) -> None:
    """Check that a file of netCDF 3 has all that its header says; others are not looked at.

    Raises
    ------
    FileError
        If it is cut short.
    """
    with path.open("rb") as file:
        sizes = _MARKS.get(file.read(4))
        if sizes is None:
            return
        try:
            needed = _needed(_Header(file, *sizes), sizes[0])
        except (EOFError, KeyError, IndexError):
            needed = None
    size = path.stat().st_size
    if needed is None or needed > size:
        what = "within its header" if needed is None else f"after {size} of {needed} bytes"
        raise FileError(f"{path}: netCDF that is cut short, {what}; copy it anew")


def _needed(header: _Header, count: int) -> int:
    """Return how many bytes a file has, by its header."""
    records = header.number()
    records = 0 if records == (1 << 8 * count) - 1 else records  # not said, of one being written
    lengths = header.dimensions()
    header.attributes()
    header.number(4)
    variables = [header.variable(lengths) for _ in range(header.number())]
    over = [one.bytes for one in variables if one.record]
    step = over[0] if len(over) == 1 else sum(size + -size % 4 for size in over)
    ends = [
        one.begin + one.bytes + (step * (records - 1) if one.record else 0)
        for one in variables
        if not one.record or records
    ]
    return max(ends, default=0)
