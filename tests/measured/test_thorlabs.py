"""What a header of ThorImageOCT says of its raw spectra is held to."""

from pathlib import Path

import numpy as np
import pytest
from recordings import COUNTS, DATA_FILE, K, T, thor_header, write_oct

from octsim.base.errors import DatasetError, FileError
from octsim.measured.open import opened_recording


def entry(more: str = "", spectra: str = str(T), name: str = "Spectral0") -> str:
    return DATA_FILE.format("Raw", K, spectra, f'BytesPerPixel="2" {more}', name)


def test_only_the_scan_is_read(tmp_path: Path) -> None:
    header = thor_header(
        entry('ApoRegionStart0="0" ApoRegionEnd0="3" ScanRegionStart0="3" ScanRegionEnd0="11"')
    )
    for packed in (0, 8):
        write_oct(tmp_path / "a.oct", header, {"data/Spectral0.data": COUNTS.tobytes()}, packed)
        with opened_recording(tmp_path / "a.oct") as found:
            np.testing.assert_array_equal(found.counts[:], COUNTS[3:11])
            np.testing.assert_array_equal(found.counts[2:4], COUNTS[5:7])
            assert any("before and behind the scan" in line for line in found.understood)


def test_a_scan_beyond_its_spectra_is_refused(tmp_path: Path) -> None:
    header = thor_header(entry('ScanRegionStart0="3" ScanRegionEnd0="13"'))
    write_oct(tmp_path / "a.oct", header, {"data/Spectral0.data": COUNTS.tobytes()})
    with pytest.raises(DatasetError, match="from 3 to 13"), opened_recording(tmp_path / "a.oct"):
        pass


@pytest.mark.parametrize(("signed", "dtype"), [("true", np.int16), ("False", np.uint16)])
def test_numbers_have_a_sign_where_it_says_so(
    signed: str, dtype: type[np.generic], tmp_path: Path
) -> None:
    header = thor_header(entry(f'Signed="{signed}"'))
    write_oct(tmp_path / "a.oct", header, {"data/Spectral0.data": COUNTS.tobytes()})
    with opened_recording(tmp_path / "a.oct") as found:
        assert found.counts.dtype == dtype
        np.testing.assert_array_equal(found.counts[:], COUNTS.view(dtype))


def test_names_are_the_same_by_any_case_and_slash(tmp_path: Path) -> None:
    header = thor_header(entry().replace('SizeX="12"', ""))
    write_oct(tmp_path / "a.oct", header, {"Data\\spectral0.data": COUNTS.tobytes()})
    with opened_recording(tmp_path / "a.oct") as found:
        np.testing.assert_array_equal(found.counts[:], COUNTS)


def test_files_of_other_samples_are_refused(tmp_path: Path) -> None:
    other = DATA_FILE.format("Raw", 8, 2, 'BytesPerPixel="2"', "Spectral1")
    members = {"data/Spectral0.data": COUNTS.tobytes(), "data/Spectral1.data": bytes(32)}
    write_oct(tmp_path / "a.oct", thor_header(entry(), other), members)
    with (
        pytest.raises(DatasetError, match="8 and 40 samples"),
        opened_recording(tmp_path / "a.oct"),
    ):
        pass


@pytest.mark.parametrize("number", [1, 3, 4, 5])
def test_the_first_three_files_of_spectra_are_named(number: int, tmp_path: Path) -> None:
    names = [f"Spectral{place}" for place in range(number)]
    entries = [entry(spectra="2", name=name) for name in names]
    members = {f"data/{name}.data": COUNTS[:2].tobytes() for name in names}
    write_oct(tmp_path / "a.oct", thor_header(*entries), members)
    with opened_recording(tmp_path / "a.oct") as found:
        assert found.counts.shape == (2 * number, K)
        named = ", ".join(f"data/{name}.data" for name in names[:3])
        more = " ..." if number > 3 else ""
        assert f"spectra are in {named}{more}" in found.understood


def test_a_header_that_is_as_long_as_no_other_is_refused(tmp_path: Path) -> None:
    header = thor_header(entry()).ljust(64_000_001)
    write_oct(tmp_path / "a.oct", header, {"data/Spectral0.data": COUNTS.tobytes()}, 8)
    with (
        pytest.raises(FileError, match=r"Header\.xml: is longer than 64000000 bytes"),
        opened_recording(tmp_path / "a.oct"),
    ):
        pass
