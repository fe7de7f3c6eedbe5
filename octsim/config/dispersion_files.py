"""Files that hold refractive indices: a wavelength, n and maybe κ in each row."""

import csv
import re
from pathlib import Path
from typing import NamedTuple

from octsim.config.units import parse_length

FORM = "write a first row as 'wavelength (nm),n' or 'wavelength (nm),n,kappa'"
_WAVELENGTH = re.compile(
    r"(?:wavelength|lambda|λ|wl)\s*_?\s*(?:\(\s*(.+?)\s*\)|\[\s*(.+?)\s*\]|([^\W\d_]+))?",
    re.IGNORECASE,
)
_COLUMNS = {"n": "n", "kappa": "kappa", "k": "kappa", "κ": "kappa"}


class Rows(NamedTuple):
    """What a file holds, one value in each row."""

    wavelength: tuple[float, ...]
    """µm."""
    n: tuple[float, ...]
    kappa: tuple[float, ...] | None
    number: tuple[int, ...]
    """Of each row in the file, counted from 1."""


class _Heading(NamedTuple):
    """Where the columns are, and the unit of the wavelengths, if it is said."""

    columns: dict[str, int]
    unit: str | None


def read_indices(file: str, unit: str | None) -> Rows:
    """Read the refractive indices that a file holds.

    Commas, semicolons or tabs stand between cells, and lines that begin with # are not read.

    Parameters
    ----------
    file : str
        Path of it, from the current folder.
    unit : str or None
        Of the wavelengths; None is as their heading says.

    Raises
    ------
    ValueError
        If it can't be read or does not hold them; with the row, counted from 1.
    """
    numbered = _cells(file)
    if not numbered:
        raise ValueError(f"{file} holds nothing; {FORM}, and rows of numbers below")
    _, cells = numbered[0]
    headed = not _is_number(cells[0])
    heading = _heading(file, cells) if headed else _by_order(file, len(cells))
    said = heading.unit
    if said and unit and parse_length(f"1 {said}") != parse_length(f"1 {unit}"):
        raise ValueError(f"unit: {unit} is given, but {file} says {said}; leave one of them out")
    if not (unit := unit or said):
        raise ValueError(
            f"{file} does not say the unit of its wavelengths; {FORM}, or give the unit beside it, "
            f"as {{table: {file}, unit: nm}}"
        )
    table = [_values(file, number, row, heading.columns, unit) for number, row in numbered[headed:]]
    wavelength, n, kappa = zip(*table, strict=True) if table else ((), (), ())
    numbers = tuple(number for number, _ in numbered[headed:])
    return Rows(wavelength, n, kappa if "kappa" in heading.columns else None, numbers)


def _cells(file: str) -> list[tuple[int, list[str]]]:
    """Return the cells of each row that holds any, and its number."""
    try:
        text = Path(file).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise ValueError(f"{file} can't be read ({reason}); give a CSV file") from None
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    first = lines[0][1] if lines else ""
    between = next((mark for mark in ";\t" if mark in first), ",")
    rows = csv.reader((line for _, line in lines), delimiter=between)
    return [
        (number, [cell.strip() for cell in row])
        for (number, _), row in zip(lines, rows, strict=False)
    ]


def _heading(file: str, cells: list[str]) -> _Heading:
    columns, unit = dict[str, int](), None
    for place, cell in enumerate(cells):
        match = _WAVELENGTH.fullmatch(cell)
        name = "wavelength" if match else _COLUMNS.get(cell.lower())
        if name in columns:
            raise ValueError(f"{file} has two columns of {name}; leave one of them out")
        if name:
            columns[name] = place
        if match:
            unit = match[1] or match[2] or match[3]
    for name in ("wavelength", "n"):
        if name not in columns:
            raise ValueError(f"{file} has no column of {name} by its first row; {FORM}")
    if unit:
        _require_length(file, unit)
    return _Heading(columns, unit)


def _by_order(file: str, count: int) -> _Heading:
    if count not in (2, 3):
        raise ValueError(f"{file} has {count} cells in its first row, and no headings; {FORM}")
    return _Heading({"wavelength": 0, "n": 1} | ({"kappa": 2} if count == 3 else {}), None)


def _require_length(file: str, unit: str) -> None:
    try:
        parse_length(f"1 {unit}")
    except ValueError as error:
        raise ValueError(f"the wavelengths of {file}: {error}") from None


def _values(
    file: str, number: int, row: list[str], columns: dict[str, int], unit: str
) -> tuple[float, float, float]:
    cells = {name: row[place] if place < len(row) else "" for name, place in columns.items()}
    for name, cell in cells.items():
        if not _is_number(cell):
            raise ValueError(
                f"{file}, row {number}: {cell!r} is no {name}; each row has a number of each"
            )
    # as text, so that 650 nm is the same float as 0.65 um
    wavelength = parse_length(f"{cells['wavelength']} {unit}")
    return wavelength, float(cells["n"]), float(cells.get("kappa", "0"))


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell
