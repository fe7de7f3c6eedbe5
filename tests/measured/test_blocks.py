"""Spectra are read a block at a time: what is not asked for stays in its file."""

import tracemalloc
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recordings import COUNTS, DATA_FILE, KINDS, K, T, h5py, thor_header, write_oct, write_tdms

from octsim.base.errors import FileError
from octsim.measured.open import opened_recording
from octsim.measured.readers.blocks import Blocks, Joined, Sides
from octsim.measured.recording import RawForm

LONG, WIDE = 20_000, 1024
BYTES = 2 * LONG * WIDE
ROW = np.arange(WIDE, dtype=np.uint16)
"""Of the eleventh spectrum; the others are zeros."""


def long_npy(path: Path) -> None:
    file = np.lib.format.open_memmap(path, "w+", np.uint16, (LONG, WIDE))
    file[10] = ROW


def long_raw(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(BYTES)
        file.seek(10 * ROW.nbytes)
        file.write(ROW.tobytes())


def long_hdf5(path: Path) -> None:
    with h5py().File(path, "w") as file:
        file.create_dataset("spectra", (LONG, WIDE), "u2", chunks=(16, WIDE))[10] = ROW


def long_oct(path: Path) -> None:
    zeros = np.zeros((LONG, WIDE), np.uint16)
    zeros[10] = ROW
    entry = DATA_FILE.format("Raw", WIDE, LONG, 'BytesPerPixel="2"', "Spectral0")
    packed = zipfile.ZIP_DEFLATED
    write_oct(path, thor_header(entry), {"data/Spectral0.data": zeros.tobytes()}, packed)


def long_tdms(path: Path) -> None:
    zeros = np.zeros((LONG, WIDE), np.uint16)
    zeros[10] = ROW
    write_tdms(path, ("camera", "stream", zeros.ravel()))


MANY = (
    "npy", "npy, samples first", "npz, packed", "HDF5 with scales", "MATLAB v7.3", "netCDF", ".oct",
    "TDMS of channels", "TDMS of one channel", ".oct, packed", "rows, commas",
)  # fmt: skip
LONG_FILES: Mapping[str, tuple[Callable[[Path], None], dict[str, Any]]] = {
    "npy": (long_npy, {"samples": WIDE}),
    "raw": (long_raw, {"raw": RawForm("uint16", (-1, WIDE))}),
    "HDF5": (long_hdf5, {"samples": WIDE}),
    ".oct": (long_oct, {}),
}


@pytest.mark.parametrize("kind", LONG_FILES)
def test_a_block_takes_no_more_memory_than_it_has(kind: str, tmp_path: Path) -> None:
    write, asked = LONG_FILES[kind]
    path = tmp_path / "recording"
    write(path)
    with opened_recording(path, **asked):
        pass  # so that its library is loaded
    tracemalloc.start()
    try:
        with opened_recording(path, **asked) as found:
            assert found.counts.shape == (LONG, WIDE)
            block = found.counts[10:20]
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    np.testing.assert_array_equal(block, [ROW, *np.zeros((9, WIDE))])
    assert peak < BYTES / 10


def test_a_part_of_a_channel_is_read_of_tdms(tmp_path: Path) -> None:
    path = tmp_path / "recording"
    long_tdms(path)
    with opened_recording(path, samples=WIDE) as found:
        np.testing.assert_array_equal(found.counts[9:11], [np.zeros(WIDE), ROW])


@pytest.mark.parametrize(
    "rows", [slice(0, 0), slice(3, 7), slice(None), slice(9, 99), slice(-2, None), slice(7, 3)]
)
@pytest.mark.parametrize("kind", MANY)
def test_blocks_are_those_of_the_whole(kind: str, rows: slice, tmp_path: Path) -> None:
    write, has = KINDS[kind]
    path = tmp_path / "recording"
    write(path)
    with opened_recording(path, **has.asked) as found:
        for _ in range(2):  # a stream is read forward, and again from its beginning
            block = found.counts[rows]
            np.testing.assert_array_equal(block, COUNTS[rows])
            assert block.shape == COUNTS[rows].shape
            assert block.dtype == found.counts.dtype


def test_a_block_has_no_step() -> None:
    blocks = Blocks(COUNTS, Sides(1, 0, {}), "it")
    with pytest.raises(ValueError, match="without a step"):
        _ = blocks[::2]


def test_a_block_is_the_caller_s_own() -> None:
    given = COUNTS.copy()
    blocks = Blocks(given, Sides(1, 0, {}), "it")
    blocks[:][...] = 0
    np.testing.assert_array_equal(given, COUNTS)


def test_parts_are_joined_across_their_ends() -> None:
    joined = Joined([COUNTS[:5], COUNTS[5:6], COUNTS[6:]])
    for first in range(T):
        for last in range(first, T + 1):
            part = joined[slice(first, last), slice(None)]
            np.testing.assert_array_equal(part, COUNTS[first:last])


@pytest.mark.parametrize("kind", ["npy", "raw, little end"])
def test_a_file_that_becomes_shorter_is_refused(kind: str, tmp_path: Path) -> None:
    write, has = KINDS[kind]
    path = tmp_path / "recording"
    write(path)
    with opened_recording(path, **has.asked) as found:
        with path.open("r+b") as file:
            file.truncate(300)
        with pytest.raises(FileError, match=r"spectra 3 to 5: can't be read .*became shorter"):
            _ = found.counts[2:5]


@pytest.mark.parametrize("kind", ["npy", "HDF5", "netCDF", "TDMS of channels", ".oct"])
def test_nothing_is_read_of_a_file_that_was_closed(kind: str, tmp_path: Path) -> None:
    write, has = KINDS[kind]
    path = tmp_path / "recording"
    write(path)
    with opened_recording(path, **has.asked) as found:
        pass
    with pytest.raises(FileError, match="can't be read"):
        _ = found.counts[2:5]


def test_a_damaged_part_is_refused_when_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "recording"
    with h5py().File(path, "w") as file:
        data = file.create_dataset("spectra", data=COUNTS, chunks=(4, K), compression="gzip")
        place = data.id.get_chunk_info(1).byte_offset
    raw = bytearray(path.read_bytes())
    raw[place : place + 40] = bytes(40)
    path.write_bytes(raw)
    with opened_recording(path, samples=K) as found:
        np.testing.assert_array_equal(found.counts[:4], COUNTS[:4])
        with pytest.raises(FileError, match="/spectra: spectra 4 to 6: can't be read") as refused:
            _ = found.counts[3:6]
    assert "\n" not in str(refused.value)
