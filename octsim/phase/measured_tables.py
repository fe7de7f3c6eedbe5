"""Tables of measured data: the cells of a CSV file, each with the row of the file it stands in."""

import csv
import io
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import DatasetError, FileError
from octsim.base.files import reason, require_regular

Array = NDArray[np.float64]
SEPARATORS = ",;\t"
"""What may stand between cells: the first with which the headings are right."""
FORM = "with commas, semicolons or tabs between cells, and # before lines of notes"
_NETCDF = (b"CDF", b"\x89HDF")


class Table(NamedTuple):
    """A CSV file: R rows of as many cells as there are headings."""

    path: Path
    headings: list[str]
    cells: list[list[str]]
    rows: list[int]
    """Row of the file, counted from 1, that each row of cells is."""


def is_netcdf(path: Path) -> bool:
    """Return whether a file is netCDF, by how it begins.

    Raises
    ------
    FileError
        If it is not there, or can't be read.
    """
    try:
        require_regular(path)
        with path.open("rb") as file:
            return file.read(4).startswith(_NETCDF)
    except FileNotFoundError:
        raise FileError(f"{path}: can't be read (not there); give a CSV or netCDF file") from None
    except OSError as error:
        raise FileError(f"{path}: can't be read ({reason(error)}); give CSV or netCDF") from None


def read_table(path: Path, problem: Callable[[Sequence[str]], str | None]) -> Table:
    """Read a CSV file, strictly: what would have to be guessed is refused.

    Commas, semicolons or tabs stand between cells, and every row has as many cells as there are
    headings. Quotes end on their line. A line that begins with # is a note, and one of the notes
    above the first row may be the heading, as `numpy.savetxt` writes it. Rows without anything in
    them are left out.

    Parameters
    ----------
    path : path
    problem : callable
        Returns what is wrong with headings, if something is.

    Raises
    ------
    FileError
        If the file can't be read, or is no text in UTF-8.
    DatasetError
        If it is no such table; with the row of the file.
    """
    notes: list[tuple[int, str]] = []
    lines: list[tuple[int, str]] = []
    for row, line in enumerate(io.StringIO(_text(path), newline=None), start=1):
        if line.lstrip().startswith("#"):
            notes += [] if lines else [(row, line.lstrip(" \t#"))]
        elif line.strip(" \t\n,;"):
            lines.append((row, line))
    separator, headings, at = _heading(path, [*lines[:1], *reversed(notes)], problem)
    body = list(_body(path, [line for line in lines if line[0] > at], separator, headings))
    return Table(path, headings, [cells for _, cells in body], [row for row, _ in body])


def _text(path: Path) -> str:
    try:
        data = path.read_bytes()
        text = data.decode("utf-8-sig")
    except OSError as error:
        raise FileError(f"{path}: can't be read ({reason(error)}); give CSV or netCDF") from None
    except UnicodeDecodeError as error:
        row = 1 + data.count(b"\n", 0, error.start)
        found = f"byte 0x{data[error.start]:02x} in row {row}"
        raise FileError(
            f"{path}: can't be read as text in UTF-8 ({found}); save it as CSV in UTF-8"
        ) from None
    if "\0" in text:
        raise FileError(f"{path}: can't be read as text in UTF-8 (byte 0x00); save it as CSV")
    return text


def _heading(
    path: Path,
    candidates: Sequence[tuple[int, str]],
    problem: Callable[[Sequence[str]], str | None],
) -> tuple[str, list[str], int]:
    """Return the separator, the headings, and the row that they stand in."""
    if not candidates:
        raise DatasetError(f"{path}: empty; {problem(())}")
    wrong: list[tuple[int, str]] = []
    for row, line in candidates:
        for separator in SEPARATORS:
            try:
                headings = split(line, separator)
            except csv.Error as error:
                wrong.append((0, f"row {row}: {_unread(line, error)}"))
                continue
            what = problem(headings)
            if what is None:
                return separator, headings, row
            wrong.append((len(headings), f"row {row}: {what}"))
    raise DatasetError(f"{path}, {max(wrong, key=lambda one: one[0])[1]}")


def split(line: str, separator: str) -> list[str]:
    """Return the cells of a line; raise `csv.Error` if a quote is open at its end."""
    cells = csv.reader(
        [line.rstrip("\n")], delimiter=separator, strict=True, skipinitialspace=True
    )  # fmt: skip
    return [cell.strip() for cell in next(cells, [])]


def _body(
    path: Path, lines: Sequence[tuple[int, str]], separator: str, headings: Sequence[str]
) -> Iterator[tuple[int, list[str]]]:
    for row, line in lines:
        try:
            cells = split(line, separator)
        except csv.Error as error:
            raise DatasetError(f"{path}, row {row}: {_unread(line, error)}") from None
        count = len(cells)
        if count != len(headings):
            found = f"{count} cell{'s' * (count > 1)}"
            raise DatasetError(
                f"{path}, row {row}: {shown(line)} given, {found} by {separator!r}; "
                f"write {len(headings)}, as there are headings (a decimal comma makes two of one)"
            )
        yield row, cells


def _unread(line: str, error: csv.Error) -> str:
    what = "a quote is left open" if "end of data" in str(error) else reason(error)
    return f"{shown(line)} given, where {what}; close quotes on their line, or leave them out"


def shown(text: str) -> str:
    """Return a line of a file as a part of a line."""
    text = text.rstrip("\n")
    return repr(text if len(text) <= 60 else f"{text[:57]}...")


def numbers(table: Table, place: int, name: str) -> Array:
    """Return the numbers in a column, (R,); NaN where a cell is empty or says nan.

    Raises
    ------
    DatasetError
        If a cell holds something else; with its row.
    """
    found = np.empty(len(table.cells))
    for sample, cells in enumerate(table.cells):
        cell = cells[place]
        try:
            found[sample] = float(cell if "_" not in cell else "none") if cell else np.nan
        except ValueError:
            remedy = "give a number, or leave the row out"
            if "," in cell:
                remedy = "write a decimal point, not a comma, and nothing between thousands"
            elif "#" in cell:
                remedy = "a note is a line that begins with #, or stands in a column of its own"
            raise DatasetError(
                f"{table.path}, row {table.rows[sample]}: {name} of sample {sample + 1} is "
                f"{shown(cell)}; {remedy}"
            ) from None
    return found
