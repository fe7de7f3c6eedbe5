"""The numbers of a text file, read at once; and where the first cell is that is none."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import DatasetError
from octsim.measured.readers.text_form import Form
from octsim.measured.readers.text_lines import (
    BLANKS,
    Text,
    cut,
    is_empty,
    is_note,
    is_number,
    lines,
)
from octsim.phase.measured_tables import shown

Array = NDArray[np.float64]


_POINTED = re.compile(r"[-+]?[\d., ]+", re.ASCII)


class Table(NamedTuple):
    """Rows of numbers, behind cells that are none."""

    lead: list[list[str]]
    """Of each row, as many as its form says."""
    numbers: Array
    """(R, C)."""


def read_numbers(path: Path, text: Text, form: Form) -> Table:
    """Read the numbers of a text whose form is known.

    Raises
    ------
    DatasetError
        If a cell is no number, or a row has another number of cells; with its row.
    """
    body = text.data[form.start : form.end].decode("utf-8", "replace")
    rows = [line for line in body.split("\n") if not is_empty(line) and not is_note(line)]
    if not rows:
        return Table([], np.empty((0, form.columns - form.lead)))
    table = _at_once(rows, form)
    return table if table is not None else _one_by_one(path, text, form)


def _at_once(rows: list[str], form: Form) -> Table | None:
    """Return the numbers by numpy's own reader; None where it finds something amiss."""
    separator = None if form.separator == BLANKS else form.separator
    lead: list[list[str]] = []
    if separator is not None:
        # a separator may end each row
        rows = [row.rstrip(f" \t{separator}" if separator != "," else " \t,") for row in rows]
    if form.lead:
        cells = [row.split(separator, form.lead) for row in rows]
        if '"' in rows[0] or any(len(row) <= form.lead for row in cells):
            return None
        lead = [[cell.strip() for cell in row[: form.lead]] for row in cells]
        rows = [row[-1] for row in cells]
    if form.point == ",":
        if any("." in row for row in rows):
            return None
        rows = [row.replace(",", ".") for row in rows]
    try:
        numbers = np.loadtxt(rows, delimiter=separator, comments=None, ndmin=2)
    except ValueError:
        return None
    return Table(lead, numbers) if numbers.shape[1] == form.columns - form.lead else None


def _one_by_one(path: Path, text: Text, form: Form) -> Table:
    """Return the numbers cell by cell, or say where the first one is amiss."""
    lead, numbers = [], []
    for row, cells in _rows(path, text, form):
        for place, cell in enumerate(cells[form.lead :], start=form.lead):
            if not is_number(cell, form.point):
                raise DatasetError(f"{path}, row {row}: {_wrong(place, cell, form.point)}")
        lead.append(cells[: form.lead])
        numbers.append(
            np.array([cell.replace(form.point, ".") for cell in cells[form.lead :]], float)
        )
    return Table(lead, np.array(numbers))


def _rows(path: Path, text: Text, form: Form) -> Iterator[tuple[int, list[str]]]:
    for line in lines(text.data, form.start, form.row, form.end):
        if is_note(line.text) or is_empty(line.text):
            continue
        cells = cut(line.text, form.separator)
        if len(cells) != form.columns:
            raise DatasetError(
                f"{path}, row {line.row}: {shown(line.text)} given, {len(cells)} "
                f"cell{'s' * (len(cells) != 1)}, and row {form.row} has {form.columns}; write as "
                "many in each row"
            )
        yield line.row, cells


def _wrong(place: int, cell: str, point: str) -> str:
    """Return in a line what is wrong with a cell."""
    if not cell:
        return f"cell {place + 1} is empty; give a number, or leave the row out"
    remedy = "give a number, or leave the row out"
    if _POINTED.fullmatch(cell):
        remedy = f"write a decimal {'comma' if point == ',' else 'point'}, as the cells before it"
        remedy += ", and nothing between thousands"
    elif "#" in cell:
        remedy = "a note is a line that begins with #"
    return f"cell {place + 1} is {shown(cell)}, which is no number; {remedy}"
