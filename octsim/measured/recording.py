"""What is read of a spectrometer's file: raw spectra, a block at a time."""

from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray


class Values(NamedTuple):
    """Numbers along one dimension of a recording."""

    values: NDArray[np.float64]
    """(N,), in `unit`, in the order of the file."""
    name: str
    """wavelength, wavenumber or time."""
    unit: str
    """As `octsim.config.units.find_unit` knows it: nm, 1/um, s."""


class Counts(Protocol):
    """Spectra as rows, each block of which is read when it is asked for."""

    @property
    def shape(self) -> tuple[int, int]:
        """Spectra and samples, (T, K)."""

    @property
    def dtype(self) -> np.dtype[Any]:
        """Of a block: whole numbers where the file has these."""

    def __getitem__(self, rows: slice, /) -> NDArray[Any]:
        """Return some spectra, (b - a, K), in an array that is the caller's own."""


class Recording(NamedTuple):
    """Raw spectra of a spectrometer, read a block at a time."""

    counts: Counts
    """(T, K); without a spectrum where a file holds nothing but an axis, (0, K)."""
    axis: Values | None
    """Along the K samples, where the file holds one."""
    time: Values | None
    """Along the T spectra, where the file holds one."""
    name: str
    """The file, and the name inside if there is one, for what is said of them."""
    understood: tuple[str, ...]
    """What was taken for what, in words, a line each."""


class RawForm(NamedTuple):
    """How numbers stand in a raw binary file."""

    dtype: str
    """As uint16 or float32."""
    shape: tuple[int, ...]
    """(T, K), or (T, X, K) and the like; -1 once for what follows from the file's size."""
    order: Literal["little", "big"] = "little"
    """Of bytes."""
    offset: int = 0
    """Bytes of a header before them."""


class Wanted(NamedTuple):
    """What is asked of a file beside its path."""

    at: str | None = None
    """Name inside it."""
    samples: int | None = None
    """K, if it is known."""
    x: int | None = None
    """Index along the dimension that is neither time nor samples."""
