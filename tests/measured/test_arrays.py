"""Arrays of numpy are read in the formats that hold numbers."""

from pathlib import Path

import numpy as np
import pytest
from numpy.lib import format as npy
from recordings import COUNTS, K

from octsim.base.errors import FileError
from octsim.measured.open import opened_recording


@pytest.mark.parametrize("version", [(1, 0), (2, 0)])
def test_an_array_is_read_by_either_format_of_numbers(
    version: tuple[int, int], tmp_path: Path
) -> None:
    with (tmp_path / "a.npy").open("wb") as file:
        npy.write_array(file, COUNTS, version)
    with opened_recording(tmp_path / "a.npy", samples=K) as found:
        np.testing.assert_array_equal(found.counts[:], COUNTS)


def test_the_format_of_records_is_refused(tmp_path: Path) -> None:
    with (tmp_path / "a.npy").open("wb") as file:
        npy.write_array(file, COUNTS, (3, 0))
    said = r"is of numpy's format 3\.0, which is for records; give an array of numbers"
    with pytest.raises(FileError, match=said), opened_recording(tmp_path / "a.npy", samples=K):
        pass
