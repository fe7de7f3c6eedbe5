"""Whole numbers of netCDF stay so, and NaN stands where the file says that there is no value."""

from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest
from recordings import COUNTS, NM, K, T

from octsim.base.errors import FileError
from octsim.measured.open import opened_recording
from octsim.measured.readers.netcdf_classic import require_whole


def write(path: Path, kind: str, counts: Any, fill: Any = None, **attributes: Any) -> None:
    with netCDF4.Dataset(path, "w") as file:
        group = file.createGroup("scan")
        for name, size in (("time", T), ("pixel", K)):
            group.createDimension(name, size)
        group.createVariable("wavelength", "f8", ("pixel",))[:] = NM
        group["wavelength"].units = "nm"
        variable = group.createVariable("counts", kind, ("time", "pixel"), fill_value=fill)
        variable.setncatts(attributes)
        variable.set_auto_maskandscale(False)
        variable[:] = counts


def read(path: Path) -> Any:
    with opened_recording(path) as found:
        assert found.name == f"{path}, scan/counts"
        assert found.axis is not None
        assert found.axis.unit == "nm"
        block = found.counts[:]
        assert block.dtype == found.counts.dtype
        return block


def test_a_camera_that_is_full_is_no_missing_value(tmp_path: Path) -> None:
    full = np.where(COUNTS > 30_000, 65_535, COUNTS).astype("u2")
    write(tmp_path / "a", "u2", full)
    found = read(tmp_path / "a")
    assert found.dtype == np.uint16
    np.testing.assert_array_equal(found, full)


@pytest.mark.parametrize(
    ("fill", "attributes"),
    [(7, {}), (None, {"missing_value": np.uint16(7)}), (None, {"valid_min": np.uint16(8)})],
)
def test_a_number_that_is_marked_is_no_value(
    fill: int | None, attributes: dict[str, Any], tmp_path: Path
) -> None:
    write(tmp_path / "a", "u2", np.where(COUNTS > 30_000, 7, COUNTS), fill, **attributes)
    expected = np.where(COUNTS > 30_000, np.nan, COUNTS)
    np.testing.assert_array_equal(read(tmp_path / "a"), expected)


def test_a_number_that_was_never_written_is_no_value(tmp_path: Path) -> None:
    with netCDF4.Dataset(tmp_path / "a", "w") as file:
        file.createDimension("time", T)
        file.createDimension("wavelength", K)
        file.createVariable("counts", "f4", ("time", "wavelength"))[:3] = COUNTS[:3]
    with opened_recording(tmp_path / "a") as found:
        assert found.counts.dtype == np.float32
        np.testing.assert_array_equal(found.counts[:3], COUNTS[:3].astype("f4"))
        assert np.isnan(found.counts[3:]).all()


def test_scales_are_applied(tmp_path: Path) -> None:
    write(tmp_path / "a", "u2", COUNTS, scale_factor=0.5, add_offset=3.0)
    np.testing.assert_array_equal(read(tmp_path / "a"), COUNTS * 0.5 + 3)


@pytest.mark.parametrize("attributes", [{}, {"_Unsigned": "false"}])
def test_signed_numbers_stay_below_nought(attributes: dict[str, str], tmp_path: Path) -> None:
    counts = COUNTS.astype("i4") - 20_000
    assert counts.min() < 0
    write(tmp_path / "a", "i4", counts, **attributes)
    np.testing.assert_array_equal(read(tmp_path / "a"), counts)


def test_numbers_that_stand_for_unsigned_ones_are_these(tmp_path: Path) -> None:
    write(tmp_path / "a", "i2", COUNTS.view("i2"), _Unsigned="true")
    found = read(tmp_path / "a")
    assert found.dtype == np.uint16
    np.testing.assert_array_equal(found, COUNTS)


@pytest.mark.parametrize("form", ["NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA"])
@pytest.mark.parametrize("records", [0, 1, 2, 3])
@pytest.mark.parametrize("others", [False, True])
def test_a_file_of_netcdf_3_that_is_cut_short_is_refused(
    form: Any, records: int, others: bool, tmp_path: Path
) -> None:
    path = tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.createDimension("time", None)
        file.createDimension("k", 5)
        file.title = "abc"
        for place in range(records):
            variable = file.createVariable(f"a{place}", ("i1", "i2")[place % 2], ("time", "k"))
            variable.units, variable.others = "nm", np.arange(3.0)
            variable[:] = np.ones((7, 5))
        if others or not records:
            file.createVariable("z", "f8", ("k",))[:] = 1
    require_whole(path)
    whole = path.read_bytes()
    padding = 8
    for size in [*range(5, len(whole) - padding, 37), len(whole) - padding]:
        path.write_bytes(whole[:size])
        with pytest.raises(FileError, match="cut short"):
            require_whole(path)


@pytest.mark.parametrize("kind", ["i1", "i2", "i4", "f4", "f8", "u1", "u2", "u4", "i8", "u8"])
def test_numbers_of_every_type_of_netcdf_3_are_as_long_as_they_are(
    kind: str, tmp_path: Path
) -> None:
    path = tmp_path / "a.nc"
    counts = (COUNTS % 100).astype(kind)
    with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_DATA") as file:
        file.createDimension("time", T)
        file.createDimension("pixel", K)
        file.createVariable("counts", kind, ("time", "pixel"))[:] = counts
        file["counts"].bits = np.array([1, 2, 3], kind)
    with opened_recording(path, samples=K) as found:
        np.testing.assert_array_equal(found.counts[:], counts)
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(FileError, match="netCDF that is cut short, after"):
        require_whole(path)
