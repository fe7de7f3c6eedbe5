"""Arrays of HDF5 are found by what they are attached to, what they are named, and where."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recordings import COUNTS, MS, NM, VOLUME, K, T, h5py

from octsim.base.errors import DatasetError
from octsim.measured.open import opened_recording

h5 = pytest.importorskip("h5py")


def opened(path: Path, **asked: Any) -> Any:
    return opened_recording(path, **asked)


def test_scales_tell_where_lengths_are_the_same(tmp_path: Path) -> None:
    square = np.arange(K * K, dtype=np.uint16).reshape(K, K)
    with h5.File(tmp_path / "a", "w") as file:
        file["spectra"] = square
        file["wavelength"] = NM
        file["wavelength"].attrs["units"] = "nm"
        file["wavelength"].make_scale()
        file["spectra"].dims[0].attach_scale(file["wavelength"])
    with opened(tmp_path / "a") as found:
        np.testing.assert_array_equal(found.counts[:], square.T)
        np.testing.assert_array_equal(found.axis.values, NM)


def test_labels_tell_the_dimensions(tmp_path: Path) -> None:
    with h5.File(tmp_path / "a", "w") as file:
        file["spectra"] = VOLUME.transpose(1, 2, 0)
        for place, label in enumerate(("x", "wavelength", "time")):
            file["spectra"].dims[place].label = label
    with opened(tmp_path / "a", x=1) as found:
        np.testing.assert_array_equal(found.counts[:], VOLUME[:, 1])
    with opened(tmp_path / "a", x=0, samples=K) as found:
        np.testing.assert_array_equal(found.counts[3:5], COUNTS[3:5])


def test_the_nearest_axis_is_taken(tmp_path: Path) -> None:
    with h5.File(tmp_path / "a", "w") as file:
        file["one/spectra"], file["two/spectra"] = COUNTS, COUNTS
        file["one/wavelength"], file["two/wavelength"] = NM, NM + 1
        file["time_ms"] = MS
        file["two/more/deep"] = COUNTS
    for at, expected in (("one", NM), ("/two/spectra", NM + 1), ("two/more/deep", NM + 1)):
        with opened(tmp_path / "a", at=at) as found:
            np.testing.assert_array_equal(found.axis.values, expected)
            np.testing.assert_array_equal(found.time.values, MS)


def test_another_axis_is_left_where_the_samples_are_given(tmp_path: Path) -> None:
    with h5.File(tmp_path / "a", "w") as file:
        file["spectra"], file["wavelength"], file["time"] = COUNTS, NM[:-3], MS
        file["time"].attrs["units"] = "days"
    with opened(tmp_path / "a", samples=K) as found:
        assert (found.axis, found.time) == (None, None)
        assert any("wavelength is not read" in line for line in found.understood)
        assert any("the unit of time is 'days'" in line for line in found.understood)
    with pytest.raises(DatasetError, match="has 37 numbers"), opened(tmp_path / "a"):
        pass


def test_an_axis_alone_has_no_spectra(tmp_path: Path) -> None:
    with h5.File(tmp_path / "a", "w") as file:
        file["calibration/wavelength_nm"] = NM
    with opened(tmp_path / "a") as found:
        assert found.counts.shape == (0, K)
        np.testing.assert_array_equal(found.axis.values, NM)


def test_times_of_another_number_are_left(tmp_path: Path) -> None:
    with h5.File(tmp_path / "a", "w") as file:
        file["spectra"], file["wavelength"], file["time"] = COUNTS, NM, MS[1:]
    with opened(tmp_path / "a") as found:
        assert found.time is None
        assert found.counts.shape == (T, K)


def test_matlab_counts_dimensions_from_the_other_end(tmp_path: Path) -> None:
    with h5py().File(tmp_path / "a", "w", userblock_size=512) as file:
        file["spectra"] = VOLUME.T
        file["spectra"].attrs["MATLAB_class"] = np.bytes_("uint16")
    with (tmp_path / "a").open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    with opened(tmp_path / "a", samples=K, x=1) as found:
        np.testing.assert_array_equal(found.counts[:], VOLUME[:, 1])


def test_a_number_that_is_one_of_a_kind_is_no_array(tmp_path: Path) -> None:
    with h5.File(tmp_path / "a", "w") as file:
        file["gain"], file["exposure"], file["spectra"] = 3.0, np.array([5.0]), COUNTS
        file["picture"] = np.ones((9, 9))
    with opened(tmp_path / "a", samples=K) as found:
        assert found.name == f"{tmp_path / 'a'}, /spectra"


def test_a_spectrum_by_itself_has_the_axis_that_is_attached_to_it(tmp_path: Path) -> None:
    with h5.File(tmp_path / "a", "w") as file:
        file["spectrum"], file["wavelength"] = COUNTS[0], NM + 1
        file["calibration/wavelength"] = NM
        file["calibration/wavelength"].make_scale()
        file["spectrum"].dims[0].attach_scale(file["calibration/wavelength"])
    with opened(tmp_path / "a") as found:
        np.testing.assert_array_equal(found.counts[:], COUNTS[:1])
        np.testing.assert_array_equal(found.axis.values, NM)
