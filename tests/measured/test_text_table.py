"""What stands in a text is told by its headings, by its numbers, and else not at all."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recordings import OCEAN, ocean_single, thor_spectra

from octsim.base.errors import DatasetError
from octsim.measured.open import opened_recording

NM = 800.0 + np.arange(12)
COUNTS = 100.0 * np.arange(1, 4)[:, np.newaxis] + np.arange(12) * 7 % 5
AXIS = ",".join(f"{one:g}" for one in NM)
NUMBERED = ",".join(map(str, range(12)))
PHASES = [0.0, 0.1, 0.2]


def columns(separator: str = ",", form: str = "{:g}") -> str:
    rows = zip(NM, COUNTS.T, strict=True)
    return "".join(
        separator.join([form.format(nm), *(f"{one:g}" for one in row)]) + "\n" for nm, row in rows
    )


def rows(*lead: str, counts: Any = COUNTS) -> str:
    rows = [",".join(f"{one:g}" for one in row) for row in counts]
    whole = [f"{first},{row}" for first, row in zip(lead, rows, strict=True)] if lead else rows
    return "".join(f"{row}\n" for row in whole)


Seen = tuple[str | None, str | None, list[float] | None]
TABLES: Mapping[str, tuple[str, Seen]] = {
    # axis, unit of it, times in the file's unit
    "a short name": ("lambda,a,b,c\n" + columns(), ("wavelength", "nm", None)),
    "a name in German": ("Wellenlänge (nm),a,b,c\n" + columns(), ("wavelength", "nm", None)),
    "a unit alone": ("nm,a,b,c\n" + columns(), ("wavelength", "nm", None)),
    "a unit in a row of its own": (
        "Wavelength,A,B,C\nnm,counts,counts,counts\n" + columns(),
        ("wavelength", "nm", None),
    ),
    "names, units, comments": (
        "Wavelength\tA\tB\tC\nnm\tcounts\tcounts\tcounts\n\tone\ttwo\tthree\n" + columns("\t"),
        ("wavelength", "nm", None),
    ),
    "one heading for all": ("Wavelength (nm),counts\n" + columns(), ("wavelength", "nm", None)),
    "wavenumbers": ("k (rad/um),a,b,c\n" + columns(), ("wavenumber", "rad/um", None)),
    "of waves in a cm": ("Wavenumber [1/cm],a,b,c\n" + columns(), ("wavenumber", "1/cm", None)),
    "of numpy": ("# wavelength (nm) a b c\n" + columns(" ", "{:.18e}"), ("wavelength", "nm", None)),
    "in a note behind a blank": (
        " # wavelength (nm)\ta\tb\tc\n" + columns("\t"),
        ("wavelength", "nm", None),
    ),
    "without headings": (columns(), ("wavelength", "nm", None)),
    "without headings, um": (columns(form="{:.0f}e-3"), ("wavelength", "um", None)),
    "a setting above": ("Camera,Basler\nGain,5,7,9\n" + columns(), ("wavelength", "nm", None)),
    "two settings above": ("Gain,5\n3,2,1,0,7\nROI\n" + columns(), ("wavelength", "nm", None)),
    "of a spreadsheet": (
        "sep=;\nWavelength (nm);1;2;3\n" + columns(";"),
        ("wavelength", "nm", None),
    ),
    "ends of an old Mac": (
        ("nm,a,b,c\n" + columns()).replace("\n", "\r"),
        ("wavelength", "nm", None),
    ),
    "blanks at the ends": (
        ("nm\ta\tb\tc\n" + columns("\t")).replace("\n", "\t \n"),
        ("wavelength", "nm", None),
    ),
    "headed by counts": ("wavelength (nm),1,2,3\n" + columns(), ("wavelength", "nm", None)),
    "headed by times": (
        "wavelength (nm),t = 1 ms,t = 3 ms,t = 4 ms\n" + columns(),
        ("wavelength", "nm", [1, 3, 4]),
    ),
    "headed by numbers that rise": (
        "wavelength (nm),0,0.1,0.2\n" + columns(),
        ("wavelength", "nm", PHASES),
    ),
    "headed by others": (
        "wavelength (nm),5 mm,6 mm,7 mm\n" + columns(),
        ("wavelength", "nm", None),
    ),
    "rows with units": (
        "t," + ",".join(f"{one:g} nm" for one in NM) + "\n" + rows("0", "0.1", "0.2"),
        ("wavelength", "nm", PHASES),
    ),
    "rows in um": (
        "t [ms]," + ",".join(f"{one / 1000:g}" for one in NM) + "\n" + rows("0", "0.1", "0.2"),
        ("wavelength", "um", PHASES),
    ),
    "rows, the axis named": (
        f"wavelength (nm),{AXIS}\n" + rows("0", "0.1", "0.2"),
        ("wavelength", "nm", PHASES),
    ),
    "columns behind pixels, headed by times alone": (
        "pixel,,1 ms,3 ms,4 ms\n"
        + "".join(f"{at},{row}\n" for at, row in enumerate(columns().splitlines())),
        ("wavelength", "nm", [1, 3, 4]),
    ),
    "rows, the axis named, in m": (
        "wavelength (m)," + ",".join(f"{one}e-9" for one in NM) + "\n" + rows("0", "0.1", "0.2"),
        ("wavelength", "m", PHASES),
    ),
    "rows, the axis named alone": (
        f"wavelength,{AXIS}\n" + rows("0", "0.1", "0.2"),
        ("wavelength", "nm", PHASES),
    ),
    "rows of pandas": (f",{AXIS}\n" + rows("0", "1", "2"), ("wavelength", "nm", None)),
    "rows with names": (f"name,{AXIS}\n" + rows("a", "b", "c"), ("wavelength", "nm", None)),
    "rows with a place and a time": (
        f"frame,time (ms),{AXIS}\n" + rows("7,0", "8,0.1", "9,0.2"),
        ("wavelength", "nm", PHASES),
    ),
    "rows by times of day": (
        f"when,{AXIS}\n" + rows("10:00:00", "10:00:00.1", "10:00:00.2"),
        ("wavelength", "nm", [36000, 36000.1, 36000.2]),
    ),
    "rows over midnight": (
        f"time,{AXIS}\n"
        + rows("2024-05-01 23:59:59.9", "2024-05-02 00:00:00", "2024-05-02T00:00:00.1Z"),
        ("wavelength", "nm", [86399.9, 86400, 86400.1]),
    ),
    "rows over midnight, no day": (
        f"time,{AXIS}\n" + rows("23:59:59", "0:00:00", "0:00:01"),
        ("wavelength", "nm", [86399, 86400, 86401]),
    ),
    "rows over pixels": (f"time (s),{NUMBERED}\n" + rows("0", "0.1", "0.2"), (None, None, PHASES)),
    "rows of named pixels": (
        "time (s)," + ",".join(f"p{one}" for one in range(12)) + "\n" + rows("0", "0.1", "0.2"),
        (None, None, PHASES),
    ),
}


def read(path: Path, text: str, **asked: Any) -> tuple[Any, Seen, tuple[str, ...]]:
    path.write_text(text, encoding="utf-8")
    with opened_recording(path, **asked) as found:
        axis, time = found.axis, found.time
        seen = (axis.name, axis.unit) if axis else (None, None)
        times = time.values.tolist() if time else None
        return found.counts[:], (*seen, times), found.understood


@pytest.mark.parametrize("kind", TABLES)
def test_a_table_is_understood(kind: str, tmp_path: Path) -> None:
    text, (name, unit, times) = TABLES[kind]
    counts, seen, _ = read(tmp_path / "table", text)
    np.testing.assert_array_equal(counts, COUNTS)
    assert seen[:2] == (name, unit)
    assert seen[2] == (None if times is None else pytest.approx(times))


@pytest.mark.parametrize("kind", ["headed by numbers that rise", "rows of pandas", "a short name"])
def test_what_is_guessed_is_a_warning(kind: str, tmp_path: Path) -> None:
    understood = read(tmp_path / "table", TABLES[kind][0])[2]
    assert any(line.startswith("warning: ") for line in understood)


@pytest.mark.parametrize(
    ("kind", "said"),
    [("a unit alone", "has 12 samples by what it is named, but 3 are given"),
     ("headed by times", "has 12 samples by what it is named, but 3 are given"),
     ("rows with names", "is 4 x 12, and the axis has 3 samples, as no dimension has")],
)  # fmt: skip
def test_rows_and_columns_are_as_many_as_the_samples_that_are_given(
    kind: str, said: str, tmp_path: Path
) -> None:
    np.testing.assert_array_equal(read(tmp_path / "a", TABLES[kind][0], samples=12)[0], COUNTS)
    with pytest.raises(DatasetError, match=f"{said}; give the axis of this spectrometer"):
        read(tmp_path / "b", TABLES[kind][0], samples=3)


def test_numbers_alone_are_told_by_the_samples_that_are_given(tmp_path: Path) -> None:
    turned = "".join(line.partition(",")[2] for line in columns().splitlines(keepends=True))
    for text in (rows(), turned):
        counts, seen, _ = read(tmp_path / "table", text, samples=12)
        np.testing.assert_array_equal(counts, COUNTS)
        assert seen == (None, None, None)
        with pytest.raises(DatasetError, match="nothing says which of"):
            read(tmp_path / "table", text)


def test_a_first_row_and_column_that_both_may_be_the_axis_are_told_by_the_samples(
    tmp_path: Path,
) -> None:
    square = np.add.outer(800.0 + np.arange(9), 10.0 * np.arange(14))
    text = "".join(",".join(f"{one:g}" for one in row) + "\n" for row in square)
    counts, seen, _ = read(tmp_path / "table", text, samples=9)
    np.testing.assert_array_equal(counts, square[:, 1:].T)
    assert seen[0] == "wavelength"
    counts, _, _ = read(tmp_path / "table", text, samples=14)
    np.testing.assert_array_equal(counts, square[1:])


def test_a_row_of_headings_and_a_column_that_both_may_be_the_axis_are_told_by_the_samples(
    tmp_path: Path,
) -> None:
    path = tmp_path / "table"
    inner = np.add.outer(np.arange(9), 0.25 * np.arange(12))
    text = f"row,{AXIS}\n" + rows(*(str(900 + at) for at in range(9)), counts=inner)
    with pytest.raises(DatasetError, match="the first row, row 1, and the first column may both"):
        read(path, text)
    np.testing.assert_array_equal(read(path, text, samples=9)[0], inner.T)
    np.testing.assert_array_equal(read(path, text, samples=12)[0], inner)


@pytest.mark.parametrize("as_rows", [False, True])
def test_an_axis_and_one_spectrum_need_no_headings(as_rows: bool, tmp_path: Path) -> None:
    pairs = np.stack((NM, COUNTS[0]))
    every = pairs if as_rows else pairs.T
    text = "".join(",".join(f"{one:g}" for one in row) + "\n" for row in every)
    counts, seen, _ = read(tmp_path / "table", text)
    np.testing.assert_array_equal(counts, COUNTS[:1])
    assert seen == ("wavelength", "nm", None)


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252"])
def test_letters_beyond_ascii_are_read_as_they_were_written(encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "table"
    path.write_bytes(("Wellenlänge (nm),a,b,c\n" + columns()).encode(encoding))
    with opened_recording(path) as found:
        assert any("column 1, 'Wellenlänge (nm)'" in line for line in found.understood)
        said = "it is written in Windows-1252" in found.understood
        assert said == (encoding == "cp1252")


def below(top: str) -> str:
    """Return columns below a row, as many as it has cells."""
    wide = np.column_stack((NM, *COUNTS[: top.count(",")]))
    return f"{top}\n" + "".join(",".join(f"{one:g}" for one in row) + "\n" for row in wide)


@pytest.mark.parametrize(
    ("top", "times"),
    [(",0,1,2", None), (",1,2", None), (",0", None), (",0.5,0.7", [0.5, 0.7]), (",9 s", [9])],
)
def test_numbers_above_columns_are_headings_where_they_count_or_rise(
    top: str, times: list[float] | None, tmp_path: Path
) -> None:
    counts, seen, _ = read(tmp_path / "table", below(top))
    np.testing.assert_array_equal(counts, COUNTS[: top.count(",")])
    assert seen == ("wavelength", "nm", times)


@pytest.mark.parametrize(
    "first", [[",5", ",75"], [",5", "1,25"], [",1", "2,5", ",7"], [",0", ",5"]]
)
def test_a_column_of_decimal_commas_may_leave_noughts_out(first: list[str], tmp_path: Path) -> None:
    rows = [*first, *["2,5"] * 10]
    counts, _, _ = read(tmp_path / "table", "".join(f"{row}\n" for row in rows))
    np.testing.assert_array_equal(counts, [[float(row.replace(",", ".")) for row in rows]])


@pytest.mark.parametrize(
    ("top", "said"),
    [(",0.7,0.5", "a cell is missing"), (",5,5", "a cell is missing"),
     ("7o9,0.5,0.7", "cell 1 is '7o9', which is no number"),
     ("-7o9,1,2", "cell 1 is '-7o9', which is no number")],
)  # fmt: skip
def test_a_row_that_is_rather_one_of_the_numbers_is_refused(
    top: str, said: str, tmp_path: Path
) -> None:
    with pytest.raises(DatasetError, match=f"row 1: {said}, among others that are; mend it"):
        read(tmp_path / "table", below(top))


def test_how_many_spectra_of_how_many_samples_are_found_by_what_is_said(tmp_path: Path) -> None:
    for text, said in (
        (TABLES["a unit alone"][0], "3 spectra of 12 samples, told by the heading 'nm'"),
        (TABLES["rows, the axis named"][0], "3 spectra of 12 samples, told by row 1"),
        (thor_spectra(), "1 spectrum of 40 samples, told by the header"),
    ):
        assert any(line.startswith(said) for line in read(tmp_path / "table", text)[2])


def test_columns_without_an_axis_have_the_times_that_head_them(tmp_path: Path) -> None:
    inner = "".join(",".join(f"{one:g}" for one in row) + "\n" for row in COUNTS.T)
    counts, seen, _ = read(tmp_path / "table", "1 ms,3 ms,4 ms\n" + inner, samples=12)
    np.testing.assert_array_equal(counts, COUNTS)
    assert seen == (None, None, [1, 3, 4])


@pytest.mark.parametrize("lead", ["10:00:00", '"10:00:00"'])
def test_a_time_of_day_may_stand_before_a_single_row(lead: str, tmp_path: Path) -> None:
    counts, seen, _ = read(tmp_path / "table", f"time,{AXIS}\n" + rows(lead, counts=COUNTS[:1]))
    np.testing.assert_array_equal(counts, COUNTS[:1])
    assert seen == ("wavelength", "nm", [36000.0])


def test_numbers_are_looked_for_below_10_000_lines_at_most(tmp_path: Path) -> None:
    counts, _, _ = read(tmp_path / "table", "of ours\n" * 10_000 + columns())
    np.testing.assert_array_equal(counts, COUNTS)
    with pytest.raises(DatasetError, match="no rows of numbers within its first 10001 lines"):
        read(tmp_path / "table", "of ours\n" * 10_001 + columns())


@pytest.mark.parametrize(("text", "above"), [(ocean_single(), OCEAN), (thor_spectra(), None)])
def test_lines_above_the_numbers_are_counted(text: str, above: str | None, tmp_path: Path) -> None:
    number = (above or text.partition("[Data]\n")[0] + "\n").count("\n")
    said = f"; {number} lines are above, and not read"
    assert any(line.endswith(said) for line in read(tmp_path / "table", text)[2])


@pytest.mark.parametrize(
    ("text", "samples"),
    [("wavelength (nm)\n" + AXIS.replace(",", "\n") + "\n", None),
     (f"wavelength (nm),{AXIS}\n", None),
     ("pixel,wavelength (nm)\n" + "".join(f"{at},{nm:g}\n" for at, nm in enumerate(NM)), None)],
)  # fmt: skip
def test_an_axis_alone_has_no_spectra(text: str, samples: int | None, tmp_path: Path) -> None:
    path = tmp_path / "axis"
    path.write_text(text, encoding="utf-8")
    with opened_recording(path, samples=samples) as found:
        assert found.counts.shape == (0, 12)
        assert found.counts[:].shape == (0, 12)
        assert found.axis is not None
        np.testing.assert_array_equal(found.axis.values, NM)
    with pytest.raises(DatasetError, match="no spectra"), opened_recording(path, samples=12):
        pass


@pytest.mark.parametrize(
    "text",
    [AXIS.replace(",", "\n") + "\n", AXIS + "\n", AXIS.replace(",", "\n"),
     "".join(f"{at} {nm:g}\n" for at, nm in enumerate(NM))],
)  # fmt: skip
def test_a_row_or_a_column_without_a_heading_is_a_spectrum(text: str, tmp_path: Path) -> None:
    counts, seen, _ = read(tmp_path / "column", text)
    np.testing.assert_array_equal(counts, [NM])
    assert seen == (None, None, None)


def test_a_text_that_may_be_cut_short_is_said_to_be(tmp_path: Path) -> None:
    path = tmp_path / "recording"
    for text, said in (
        (thor_spectra().replace("[EndOfFile]\n", ""), "EndOfFile"),
        (ocean_single().rpartition("893")[0], "39 samples, and its header speaks of 40"),
        (TABLES["a unit alone"][0].rstrip("\n"), "last line has no end"),
    ):
        understood = read(path, text)[2]
        assert [line for line in understood if line.startswith("warning: ") and said in line]
    for text in (thor_spectra(), ocean_single(), TABLES["a unit alone"][0]):
        assert not [line for line in read(path, text)[2] if line.startswith("warning: ")]
