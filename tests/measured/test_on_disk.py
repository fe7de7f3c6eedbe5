"""Parts of numbers in a file, mapped or from a stream, are those of the array."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from octsim.measured.readers.blocks import Key
from octsim.measured.readers.on_disk import Mapped, Streamed

HELD = np.arange(5 * 3 * 4, dtype=">u2").reshape(5, 3, 4)
EVERY = slice(None)
KEYS: tuple[Key, ...] = (
    (slice(1, 3), EVERY, EVERY), (2, EVERY, EVERY), (4, 1, slice(1, 3)), (0, EVERY, 3),
    (slice(4, 5), 2, EVERY), (EVERY, 2, EVERY), (slice(2, 2), EVERY, EVERY), (3, EVERY, 0),
)  # fmt: skip


@pytest.mark.parametrize("key", KEYS, ids=str)
def test_a_part_is_that_of_the_array(key: Any, tmp_path: Path) -> None:
    data = b"head" + HELD.tobytes()
    (tmp_path / "a").write_bytes(data)
    with (tmp_path / "a").open("rb") as file:
        for source in (
            Mapped(file, HELD.dtype, HELD.shape, 4),
            Streamed(io.BytesIO(data), HELD.dtype, HELD.shape, 4),
        ):
            for _ in range(2):
                np.testing.assert_array_equal(source[key], HELD[key])
            np.testing.assert_array_equal(source[:, :, :], HELD)
            np.testing.assert_array_equal(source[key], HELD[key])


def test_a_stream_is_read_no_farther_than_asked_for() -> None:
    stream = io.BytesIO(HELD.tobytes())
    _ = Streamed(stream, HELD.dtype, HELD.shape, 0)[1:3, :, :]
    assert stream.tell() == 3 * HELD[0].nbytes
