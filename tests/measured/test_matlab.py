"""Arrays of MATLAB are found by their names, in structures too."""

import struct
from pathlib import Path

import numpy as np
import pytest
from recordings import COUNTS, NM, K, T
from scipy.io import savemat

from octsim.base.errors import DatasetError, FileError
from octsim.measured.open import opened_recording


def test_structures_within_structures_are_looked_into(tmp_path: Path) -> None:
    held = {"scan": {"camera": {"counts": COUNTS, "note": "a text"}, "lambda": NM, "gain": 3.0}}
    savemat(tmp_path / "a.mat", held)
    with opened_recording(tmp_path / "a.mat") as found:
        assert found.name == f"{tmp_path / 'a.mat'}, scan.camera.counts"
        np.testing.assert_array_equal(found.counts[:], COUNTS)
        assert found.axis is not None
        np.testing.assert_array_equal(found.axis.values, NM)


@pytest.mark.parametrize("row", [True, False])
def test_a_row_or_a_column_is_a_spectrum(row: bool, tmp_path: Path) -> None:
    savemat(
        tmp_path / "a.mat", {"spectrum": COUNTS[0], "wl": NM}, oned_as="row" if row else "column"
    )
    with opened_recording(tmp_path / "a.mat") as found:
        np.testing.assert_array_equal(found.counts[:], COUNTS[:1])
        assert found.axis is not None


def test_a_file_of_version_4_is_read_by_its_suffix(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", {"counts": COUNTS.astype(float), "lambda_nm": NM}, format="4")
    with opened_recording(tmp_path / "a.mat") as found:
        np.testing.assert_array_equal(found.counts[:], COUNTS)
        assert found.counts.shape == (T, K)


def test_truth_values_are_no_counts(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", {"spectra": COUNTS > 9})
    with pytest.raises(DatasetError, match="truth values"), opened_recording(tmp_path / "a.mat"):
        pass


@pytest.mark.parametrize(("rows", "said"), [(12_500_000, "can't be read"),
    (12_500_001, "28 bytes are said to hold 100000008, and it is not unpacked")])  # fmt: skip
def test_no_more_than_100_mb_may_be_said_to_stand_in_a_small_file(
    rows: int, said: str, tmp_path: Path
) -> None:
    header = struct.pack("<5i", 0, rows, 1, 0, 8) + b"spectra\0"  # of version 4, of doubles
    (tmp_path / "a.mat").write_bytes(header)
    with pytest.raises(FileError, match=said), opened_recording(tmp_path / "a.mat") as found:
        _ = found.counts[:]
