"""Blocks of spectra, read from what has its dimensions in any order."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from octsim.base.failures import said_in_a_line

Key = tuple[int | slice, ...]
Block = NDArray[Any]


class Source(Protocol):
    """Numbers of some dimensions, of which slices are read."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Of all."""

    @property
    def dtype(self) -> np.dtype[Any]:
        """Of what is read."""

    def __getitem__(self, key: Any, /) -> Any:
        """Read a part, by a slice or an index for each dimension."""


class Sides(NamedTuple):
    """Which dimension of a source is what."""

    samples: int
    time: int | None
    """None where it is a single spectrum."""
    held: Mapping[int, int]
    """Index of each other dimension at which spectra are read."""


class Blocks:
    """Spectra of a source as rows (T, K), read when they are asked for."""

    def __init__(self, source: Source, sides: Sides, name: str) -> None:
        self._source, self._sides, self._name = source, sides, name
        count = 1 if sides.time is None else source.shape[sides.time]
        self.shape = (int(count), int(source.shape[sides.samples]))
        self.dtype = np.dtype(source.dtype).newbyteorder("=")

    def __getitem__(self, rows: slice, /) -> Block:
        """Return some spectra, (b - a, K), in an array that is the caller's own.

        Raises
        ------
        FileError
            If they can't be read.
        """
        first, last, step = rows.indices(self.shape[0])
        if step != 1:
            raise ValueError("spectra are read in their order, each; give a slice without a step")
        last = max(first, last)
        key: list[int | slice] = [slice(None)] * len(self._source.shape)
        for place, index in self._sides.held.items():
            key[place] = index
        if self._sides.time is not None:
            key[self._sides.time] = slice(first, last)
        what = f"{self._name}: spectra {first + 1} to {last}"
        with said_in_a_line(what, "copy the file anew, or give another"):
            block = np.asarray(self._source[tuple(key)])
            if self._sides.time is None:
                block = block[np.newaxis][first:last]
            elif self._sides.time > self._sides.samples:
                block = block.T
            if block.shape != (last - first, self.shape[1]):
                raise EOFError("the file is cut short")
            return np.array(block, self.dtype, order="C")


class Turned:
    """A source with its dimensions in the opposite order, as MATLAB counts them."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self.shape = tuple(source.shape[::-1])
        self.dtype = source.dtype

    def __getitem__(self, key: Key, /) -> Block:
        """Read a part."""
        return np.asarray(self._source[key[::-1]]).T


class Folded:
    """A long row of numbers as spectra of K samples, one after the other."""

    def __init__(self, source: Source, place: int, samples: int) -> None:
        self._source, self._place, self._samples = source, place, samples
        self.shape = (source.shape[place] // samples, samples)
        self.dtype = source.dtype

    def __getitem__(self, key: tuple[slice, slice], /) -> Block:
        """Read some spectra."""
        first, last, _ = key[0].indices(self.shape[0])
        flat: list[int | slice] = [0] * len(self._source.shape)
        flat[self._place] = slice(first * self._samples, last * self._samples)
        return np.asarray(self._source[tuple(flat)]).reshape(-1, self._samples)[:, key[1]]


class Joined:
    """Sources of as many samples, one after the other along their first dimension."""

    def __init__(self, parts: Sequence[Source]) -> None:
        self._parts = parts
        self._ends = np.cumsum([part.shape[0] for part in parts])
        self.shape = (int(self._ends[-1]), *parts[0].shape[1:])
        self.dtype = parts[0].dtype

    def __getitem__(self, key: tuple[slice, slice], /) -> Block:
        """Read some spectra."""
        first, last, _ = key[0].indices(self.shape[0])
        found = [np.empty((0, *self.shape[1:]), self.dtype)[:, key[1]]]
        for part, end in zip(self._parts, self._ends, strict=True):
            begin = int(end) - part.shape[0]
            low, high = max(first, begin), min(last, int(end))
            if low < high:
                found.append(np.asarray(part[slice(low - begin, high - begin), key[1]]))
        return np.concatenate(found[1:] if len(found) > 1 else found)
