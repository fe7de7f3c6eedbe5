"""Measured series of phases: read as they were written, and what moves since they were at rest."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from octsim.base.errors import DatasetError
from octsim.phase.measured_series import Series, change_from_rest, read_series

TIME = 1e-3 * np.arange(30, dtype=np.float64)
CHANGE = np.where(np.arange(30) < 20, 0.0, 0.01 * (np.arange(30) - 20))


def test_wrapped_phases_are_the_same_as_unwrapped_ones() -> None:
    whole = Series(TIME, 3.1 + CHANGE, np.full(30, 1e-3))
    wrapped = whole._replace(phase=np.angle(np.exp(1j * whole.phase)))
    assert (np.abs(np.diff(wrapped.phase)) > 6).any()
    assert change_from_rest(wrapped, 20).phase == pytest.approx(CHANGE, abs=1e-12)


def test_missing_samples_stay_missing_and_are_passed_over() -> None:
    phase = np.angle(np.exp(1j * (3.1 + CHANGE)))
    gone = [3, 19, 24, 25]
    phase[gone] = np.nan
    found = change_from_rest(Series(TIME, phase, np.full(30, 1e-3)), 20)
    there = np.setdiff1d(np.arange(30), gone)
    assert found.phase[there] == pytest.approx(CHANGE[there], abs=1e-12)
    assert np.isnan(found.phase[gone]).all()
    assert np.isnan(found.error[gone]).all()
    assert found.error[there] == pytest.approx(1e-3 * np.sqrt(1 + 1 / 18))


def test_without_phase_errors_the_scatter_at_rest_serves() -> None:
    noise = np.random.default_rng(5).normal(0, 2e-3, 30)
    found = change_from_rest(Series(TIME, CHANGE + noise), 20)
    assert found.error == pytest.approx(noise[:20].std(ddof=1) * np.sqrt(1 + 1 / 20))
    assert found.phase[:20].mean() == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize(
    ("series", "rest", "message"),
    [
        (Series(TIME, np.where(TIME > 0.02, 2.8, 0.0)), 20, r"moves by 2.8 rad up to 0.021 s"),
        (Series(TIME, np.where(TIME < 0.018, np.nan, 0.0)), 20, r"first 20 of 30 samples 2 have"),
        (Series(TIME, CHANGE), 31, r"first 31 of 30 samples"),
        (Series(TIME, np.where(TIME < 0.02, np.nan, 0), CHANGE), 20, r"samples 0 have .* 1 are"),
    ],
)
def test_a_series_without_a_sure_rest_is_refused(series: Series, rest: int, message: str) -> None:
    with pytest.raises(DatasetError, match=message):
        change_from_rest(series, rest)


def test_csv_and_netcdf_hold_the_same_series(tmp_path: Path) -> None:
    rows = [f"{1e3 * t:.6f}, {1e3 * p:.9f}, 0.5  # one" for t, p in zip(TIME, CHANGE, strict=True)]
    rows[4], rows[7] = "4.0,,0.5", "7.0,nan,"
    text = "\ufeff# my axon\ntime (ms),phase [mrad],phase_error (mrad)\n\n" + "\n".join(rows)
    (tmp_path / "s.csv").write_text(text, encoding="utf-8")
    first = read_series(tmp_path / "s.csv")
    assert first.time == pytest.approx(TIME)
    assert np.isnan(first.phase[[4, 7]]).all()
    kept = np.delete(np.arange(30), [4, 7])
    assert first.phase[kept] == pytest.approx(CHANGE[kept], abs=1e-12)
    assert first.phase_error is not None
    assert first.phase_error[0] == pytest.approx(5e-4)
    stored = xr.Dataset(
        {"phase": ("time", 1e3 * first.phase, {"units": "mrad"})},
        {"time": ("time", first.time, {"units": "s"})},
    )
    stored.to_netcdf(tmp_path / "s.nc", engine="netcdf4")
    second = read_series(tmp_path / "s.nc")
    assert second.phase_error is None
    assert second.time == pytest.approx(first.time)
    assert second.phase == pytest.approx(first.phase, nan_ok=True)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no 'time'"),
        ("time,fase\n0,1\n", "holds no 'phase'"),
        ("time,phase\n", "no sample has a phase"),
        ("time,phase\n0,\n1,nan\n", "no sample has a phase"),
        ("time,phase\n0,1\n1,one\n", "phase of sample 2 is 'one'"),
        ("time,phase\n0,1\n,1\n", "sample 2 has no time"),
        ("time,phase\n0,1\n0,1\n", "from 0 to 0 s at sample 2; sort"),
        ("time,phase\n0,inf\n1,1\n", "phase of sample 1 is infinite"),
        ("time,phase (deg)\n0,1\n", "unit of phase is 'deg'; the known ones are rad, mrad"),
        ("time,phase,phase_error\n0,1,-1\n", "phase_error of sample 1 is -1"),
        ("time,phase,phase_error\n0,1,\n", "phase_error of sample 1 is nan"),
    ],
)
def test_a_file_that_is_no_series_is_refused_in_one_line(
    tmp_path: Path, text: str, message: str
) -> None:
    (tmp_path / "s.csv").write_text(text, encoding="utf-8")
    with pytest.raises(DatasetError, match=message) as said:
        read_series(tmp_path / "s.csv")
    assert "\n" not in str(said.value)


def test_files_that_are_missing_or_damaged_are_refused(tmp_path: Path) -> None:
    for name in ("none.csv", "none.nc"):
        with pytest.raises(DatasetError, match="not there"):
            read_series(tmp_path / name)
    for name in ("bad.csv", "bad.nc"):
        (tmp_path / name).write_bytes(b"\xff\xfe\x00")
        with pytest.raises(DatasetError, match="can't be read"):
            read_series(tmp_path / name)
