"""Series of phases in several bands: what is read, and what is refused by name."""

from pathlib import Path

import pytest

from octsim.base.errors import DatasetError
from octsim.phase.measured_bands import read_series_of_bands
from octsim.phase.measured_series import read_series


def written(folder: Path, heading: str, row: str = "0,1,2,3,4") -> Path:
    file = folder / "series.csv"
    cells = row.split(",")[: heading.count(",") + 1]
    later = ["1", *cells[1:]]
    file.write_text(f"{heading}\n{','.join(cells)}\n{','.join(later)}\n", encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("heading", "phases", "error"),
    [("time,phase_1,phase_2", (1.0, 2.0), None),
     ("time (s),Phase 2/mrad,phase1 (rad)", (2.0, 1e-3), None),
     ("time,phase,phase_2 (rad),phase_1 (rad)", (3.0, 2.0), None),
     ("time,phase_1,phase_2,phase_error_1,phase_error_2", (1.0, 2.0), (3.0, 4.0))],
)  # fmt: skip
def test_each_band_has_the_column_of_its_number(
    tmp_path: Path, heading: str, phases: tuple[float, ...], error: tuple[float, ...] | None
) -> None:
    read = read_series_of_bands(written(tmp_path, heading), 2)
    assert tuple(one.phase[0] for one in read) == pytest.approx(phases)
    assert all((one.phase_error is None) == (error is None) for one in read)
    if error:
        assert tuple(one.phase_error[0] for one in read if one.phase_error is not None) == error


@pytest.mark.parametrize(
    ("heading", "said"),
    [("time,phase", "it holds no phase with a number under the headings 'time', 'phase', and"),
     ("time,phase_1", "it holds phase_1 under .* expansion.bands has 2; write a column phase_1 to"),
     ("time,phase_1,phase_2,phase_3", "it holds phase_1, phase_2, phase_3 under the headings"),
     ("time,phase_1,phase_2,phase_error_1", "phase_error_2 is not there"),
     ("time,phase_1 (mm),phase_2 (rad)", "the unit of phase is 'mm'")],
)  # fmt: skip
def test_other_columns_than_the_bands_are_refused(tmp_path: Path, heading: str, said: str) -> None:
    with pytest.raises(DatasetError, match=said):
        read_series_of_bands(written(tmp_path, heading), 2)


def test_a_series_of_one_phase_is_read_as_before(tmp_path: Path) -> None:
    assert read_series(written(tmp_path, "time,phase")).phase.tolist() == [1.0, 1.0]
    with pytest.raises(DatasetError):
        read_series(written(tmp_path, "time,phase_1"))
