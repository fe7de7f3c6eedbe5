"""What a header of ThorImageOCT says of its raw spectra is held to."""

from pathlib import Path

import numpy as np
import pytest
from recordings import COUNTS, DATA_FILE, K, T, thor_header, write_oct

from octsim.base.errors import DatasetError
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
