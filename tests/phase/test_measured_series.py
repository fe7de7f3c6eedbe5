"""Measured series of phases: read as they were written, and what moves since they were at rest."""

from pathlib import Path
from typing import Any

import netCDF4
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
    rows = [f"{1e3 * t:.6f}, {1e3 * p:.9f}, 0.5" for t, p in zip(TIME, CHANGE, strict=True)]
    rows[4], rows[7] = "4.0,,0.5", "7.0,nan,"
    text = "\ufeff# my axon\ntime (ms),phase [mrad],phase_error (mrad)\n\n# at rest\n" + "\n".join(
        rows
    )
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
        ("time,phase (turns)\n0,1\n", "unit of phase is 'turns'; the known ones are such as rad"),
        ("time (Ms),phase\n0,1\n", "unit of time is 'Ms'; the known ones are such as s, ms"),
        ("time,phase (mrad),phase_error\n0,1,1\n", "phase_error has no unit; write 'phase_error"),
        ("time,phase\n\n# note\n0,1\n1\n", "row 5: '1' given, 1 cell by ','; write 2"),
        ("time,phase\n0,1,\n", "row 2: '0,1,' given, 3 cells"),
        ("time;phase\n0;1\n1;0,5\n", "row 3: phase of sample 2 is '0,5'; write a decimal point"),
        ("time,phase\n0,1 # one\n", "phase of sample 1 is '1 # one'; a note is a line that begins"),
        ("time,phase\n0,1_000\n", "phase of sample 1 is '1_000'"),
        ("time,phase\n0,0x10\n", "phase of sample 1 is '0x10'"),
        ("time,phase\n0,1e\n", "phase of sample 1 is '1e'"),
        ('time,phase,note\n0,1,"a\n1,2,b"\n', "row 2: .* a quote is left open; close quotes"),
        ('time,phase,note\n0,1,"a"b\n', "row 2: .* expected after '\"'"),
        ("Instrument: X\ntime,phase\n0,1\n", "row 1: .* # before lines of notes"),
        ("0,1\n1,2\n", "row 1: it holds no 'time' under the headings '0', '1'"),
        ("# time (ms),phase (mrad)\n0 1\n1 2\n", "row 2: '0 1' given, 1 cell"),
        ("time|phase\n0|1\n", "commas, semicolons or tabs between cells"),
        ("t (s),phase\n0,1\n", r"write 'time \(s\)' in place of 't \(s\)'"),
        ("time,phi\n0,1\n", r"write 'phase \(rad\)' in place of 'phi'"),
        ("time,phi (mrad)\n0,1\n", r"write 'phase \(mrad\)' in place of 'phi \(mrad\)'"),
        ("t/ms,phase\n0,1\n", r"write 'time \(ms\)' in place of 't/ms'"),
        ("time,unwrapped phase (deg)\n0,1\n", r"'phase \(deg\)' in place of 'unwrapped phase"),
        ("time,phase (mrad),sd\n0,1,1\n", r"write 'phase_error \(mrad\)' if it is that"),
        ("time,phase (mrad),SE (deg)\n0,1,1\n", r"write 'phase_error \(deg\)' if it is that"),
        ("time,phase,Δphase\n0,1,1\n", "heading 'Δphase' is not known; write 'phase_error"),
        ("time,phase,precision\n0,1,1\n", "heading 'precision' is not known"),
        ("time,phase,CI95\n0,1,1\n", "heading 'CI95' is not known"),
        ("time,phase,Phase (mrad)\n0,1,1\n", r"2 headings are of phase \('phase', 'Phase \(mrad\)"),
        ("time,phase,\nphase\n0,1,\n", "row 2: 'phase' given"),
        ("time,phase,phase_err\n0,1,1\n", "heading 'phase_err' is not known; write 'phase_error"),
        ("time,phase,tolerance\n0,1,1\n", "heading 'tolerance' is not known"),
        ("time,phase,rmse\n0,1,1\n", "heading 'rmse' is not known"),
        ("time,phase,Fehler (mrad)\n0,1,1\n", r"heading 'Fehler \(mrad\)' is not known"),
        ("time,phase,u(phase)\n0,1,1\n", r"heading 'u\(phase\)' is not known"),
        ("time,phase,e_phase (mrad)\n0,1,1\n", r"heading 'e_phase \(mrad\)' is not known"),
        ("time,phase\nms,mrad\n0,1\n", "row 2: time of sample 1 is 'ms'; .* leave the row out"),
        ("time,phase,sigma (mrad)\n0,1,1\n", r"heading 'sigma \(mrad\)' is not known"),
        ("time,phase,std\n0,1,1\n", "heading 'std' is not known"),
        ("time,phase,stderr\n0,1,1\n", "heading 'stderr' is not known"),
        ("time,phase,phase noise\n0,1,1\n", "heading 'phase noise' is not known"),
        ("time,phase,± (rad)\n0,1,1\n", "heading '± .rad.' is not known"),
        ("time,phase,phse_error\n0,1,1\n", "heading 'phse_error' is not known"),
        ("time,phase\n0,1\n1,9.97e36\n", "row 3: phase of sample 2 is 9.97e.36, .* no value"),
        ("time,phase\n0,.1\n1,-999\n2,.1\n", "row 3: phase of sample 2 is -999, which stands"),
        ("# a\n\ntime,phase\n1,1\n\n0,1\n", "row 6: the time goes from 1 to 0 s at sample 2"),
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


HEADINGS = {
    "time (ms),phase (mrad)": (1e-3, 1e-3),
    "Time [ms],PHASE [mrad]": (1e-3, 1e-3),
    "time_ms,phase_mrad": (1e-3, 1e-3),
    "time/ms,phase / mrad": (1e-3, 1e-3),
    "time in ms,phase mrad": (1e-3, 1e-3),
    '"time (ms)","phase (mrad)"': (1e-3, 1e-3),
    "time (\u00b5s),phase (\u00b0)": (1e-6, np.pi / 180),
    "time (\u03bcs),phase (deg)": (1e-6, np.pi / 180),
    "time,phase": (1, 1),
    "# time (ms),phase (mrad)": (1e-3, 1e-3),
    "# my axon\n#time (ms),phase (mrad)\n# at 20 C": (1e-3, 1e-3),
}


@pytest.mark.parametrize("heading", HEADINGS)
def test_a_heading_may_be_written_in_many_ways(heading: str, tmp_path: Path) -> None:
    rows = "".join(f"{t},{t / 10}\n" for t in range(30))
    (tmp_path / "s.csv").write_text(f"{heading}\n{rows}", encoding="utf-8")
    found, (of_time, of_phase) = read_series(tmp_path / "s.csv"), HEADINGS[heading]
    assert found.time == pytest.approx(of_time * np.arange(30), rel=1e-15)
    assert found.phase == pytest.approx(of_phase * np.arange(30) / 10, rel=1e-15)
    assert found.phase_error is None


@pytest.mark.parametrize(
    "table",
    [
        "time,phase,phase error,note\n{rows}",
        "\ufefftime,phase,phase_error,note\r\n{rows}".replace("\n", "\r\n"),
        "time;phase;phase-error;note\n{rows}",
        "time\tphase\tPhase Error\tnote\n{rows}",
        ",time,phase,phase_error,note\n{rows}",
        "time,phase,phase_error,trigger,note\n\n{rows}\n,,,,\n  \n",
    ],
)
def test_rows_are_read_whatever_stands_in_their_notes(table: str, tmp_path: Path) -> None:
    heading = table.split("\n{rows}")[0].strip("\ufeff\r\n").split("\n")[0]
    separator = next(sign for sign in ";\t," if sign in heading)
    first = heading.startswith(",") * ["0"]
    rows = [
        [*first, f"{t}", f"{t / 100}", "0.5", *heading.count("trigger") * ["1"]] for t in range(40)
    ]
    notes = ["trial #3", "see, above", 'a ""quoted"" word', "5' 3", "", "µ # é"]
    lines = [
        separator.join([*row, f' "{notes[number % 6]}"'.lstrip("\t" if separator == "\t" else "")])
        for number, row in enumerate(rows)
    ]
    ending = "\r\n" if "\r\n" in table else "\n"
    text = table.replace("{rows}", ending.join(lines))
    (tmp_path / "s.csv").write_bytes(text.encode())
    found = read_series(tmp_path / "s.csv")
    assert np.array_equal(found.time, np.arange(40))
    assert np.array_equal(found.phase, np.arange(40) / 100)
    assert found.phase_error is not None
    assert (found.phase_error == 0.5).all()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ("time (µs),phase\n0,1\n".encode("latin-1"), "UTF-8 .byte 0xb5 in row 1.; save it as CSV"),
        ("time,phase\n0,1\n".encode("utf-16"), "can't be read as text in UTF-8"),
        ("time,phase\n0,1\n".encode("utf-16-le"), "can't be read as text in UTF-8"),
        (b"PK\x03\x04\xff", "can't be read as text in UTF-8"),
        (b"", "empty; it holds no 'time'; write a heading 'time"),
        (b"# only a note\n", "it holds no 'time' under the headings 'only a note'"),
    ],
)
def test_what_is_no_text_in_utf_8_is_refused(data: bytes, message: str, tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_bytes(data)
    with pytest.raises(DatasetError, match=message):
        read_series(tmp_path / "s.csv")


def series_file(path: Path, **attributes: Any) -> Path:
    """Write 60 samples as integers of 0.1 mrad, but for the 31st, which is never written."""
    with netCDF4.Dataset(path, "w") as out:
        out.createDimension("sample", 60)
        time = out.createVariable("time", "f8", "sample")
        time.units, time[:] = "ms", np.arange(60.0)
        phase = out.createVariable("phase", "i2", "sample", fill_value=attributes.pop("fill", None))
        phase.setncatts({"units": "mrad", "scale_factor": 0.1, **attributes})
        phase.set_auto_maskandscale(False)
        phase[:30], phase[31:] = np.arange(30), np.arange(31, 60)
        if "missing_value" in attributes:
            phase[30] = attributes["missing_value"]
        if "valid_max" in attributes:
            phase[30] = 1000
    return path


@pytest.mark.parametrize(
    "attributes",
    [{}, {"fill": -1}, {"missing_value": np.int16(-5)}, {"valid_max": np.int16(100)}],
)
def test_what_netcdf_says_is_missing_is_missing(attributes: dict[str, Any], tmp_path: Path) -> None:
    found = read_series(series_file(tmp_path / "s.nc", **attributes))
    there = np.delete(np.arange(60), 30)
    assert np.isnan(found.phase[30])
    assert found.phase[there] == pytest.approx(1e-4 * there)
    assert found.time[59] == pytest.approx(0.059)


@pytest.mark.parametrize(
    ("variables", "message"),
    [
        ({"time": ("time", TIME), "fase": ("time", TIME)}, "no 'phase' under .*'fase'"),
        ({"time": ("time", TIME), "phase": ("at", TIME)}, r"are time .time., phase .at."),
        ({"time": ("time", TIME), "phase": (("time", "at"), TIME[:, None])}, "phase .time, at."),
        ({"time": ("time", TIME), "phase": ("time", TIME, {"units": "m"})}, "unit of phase is 'm'"),
        ({"time": ("time", TIME), "phase": ("time", TIME.astype(str))}, "it holds no 'phase'"),
        (
            {"time": ("time", TIME), "phase": ("time", TIME), "phase_std": ("time", TIME)},
            "'phase_std' is not known",
        ),
        (
            {"time": ("time", np.where(TIME == 0.005, 9.969209968386869e36, TIME)),
             "phase": ("time", TIME)},
            "sample 6 has no time",
        ),
        (
            {"time": ("time", TIME), "phase": ("time", np.where(TIME == 0.005, 1e30, TIME))},
            r"phase of sample 6 is 1e\+30, which stands for no value",
        ),
    ],
)  # fmt: skip
def test_netcdf_that_is_no_series_is_refused(
    variables: dict[str, object], message: str, tmp_path: Path
) -> None:
    stored = xr.Dataset(variables)
    encoding = {name: {"_FillValue": None} for name, one in stored.items() if one.dtype.kind == "f"}
    encoding["time"] = {"_FillValue": None}
    stored.to_netcdf(tmp_path / "s.nc", engine="netcdf4", encoding=encoding)
    with pytest.raises(DatasetError, match=message):
        read_series(tmp_path / "s.nc")


def test_a_file_is_what_its_first_bytes_say(tmp_path: Path) -> None:
    file = series_file(tmp_path / "s.nc").rename(tmp_path / "s.dat")
    assert np.isnan(read_series(file).phase[30])
    (tmp_path / "s.txt").write_text("time\tphase\n0\t1\n", encoding="utf-8")
    assert read_series(tmp_path / "s.txt").phase == [1]


def test_a_phase_that_is_neither_wrapped_nor_unwrapped_is_refused() -> None:
    phase = CHANGE.copy()
    phase[25] = 100 * np.pi
    with pytest.raises(DatasetError, match=r"up to 0.025 s \(sample 26\).*stands for none"):
        change_from_rest(Series(TIME, phase, np.full(30, 1e-3)), 20)


def test_a_line_through_the_samples_at_rest_is_what_least_squares_says() -> None:
    generator = np.random.default_rng(3)
    noise = generator.normal(0, 1e-3, 30)
    phase = CHANGE + 5 * TIME + noise
    rest = np.r_[0:20, 24:28]
    for drifts, degree in ((False, 0), (True, 1)):
        line, covariance = np.polyfit(TIME[rest], phase[rest], degree, cov=True)
        found = change_from_rest(Series(TIME, phase), 20, drifts, ((25, 28),))
        assert found.phase == pytest.approx(phase - np.polyval(line, TIME), abs=1e-12)
        powers = np.vander(TIME, degree + 1)
        of_line = np.einsum("ti,ij,tj->t", powers, covariance, powers)
        scatter = np.sqrt(((phase - np.polyval(line, TIME))[rest] ** 2).sum() / (23 - degree))
        assert found.error == pytest.approx(np.sqrt(scatter**2 + of_line), rel=1e-9)
        assert found.scatter == pytest.approx(scatter)
        assert found.freedom == 23 - degree
        assert found.drift == pytest.approx(line[0] if degree else 0)


def test_the_errors_of_a_line_are_those_of_its_own_samples() -> None:
    error = np.linspace(1e-3, 5e-3, 30)
    found = change_from_rest(Series(TIME, CHANGE, error), 10, drifts=True)
    powers = np.vander(TIME, 2)
    # the line as a matrix that the phases at rest are multiplied by
    by_phase = powers @ np.linalg.pinv(powers[:10])
    expected = np.sqrt(error**2 + (by_phase**2 * error[:10] ** 2).sum(axis=1))
    assert found.error == pytest.approx(expected, rel=1e-9)


def test_a_rest_that_is_not_there_is_refused() -> None:
    with pytest.raises(DatasetError, match=r"expansion.drift: 25 to 31 of 30 samples"):
        change_from_rest(Series(TIME, CHANGE), 20, True, ((25, 31),))
