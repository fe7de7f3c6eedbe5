"""Where numbers begin in a text file, and how they stand there."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from octsim.base.errors import DatasetError
from octsim.measured.readers.names import AXES, FEWEST, known
from octsim.measured.readers.text_lines import (
    BLANKS,
    SEPARATORS,
    Line,
    Text,
    cut,
    cut_headings,
    is_empty,
    is_note,
    is_number,
    lines,
)
from octsim.phase.measured_tables import shown

MOST_HEADER = 10_000
"""Lines in which rows of numbers must begin."""
_BEGIN = re.compile(rb"^(?:>{3,}[ \t]*Begin[^\n]*|\[Data\][^\n]*)\n", re.MULTILINE | re.IGNORECASE)
"""What stands above the numbers of OceanView and ThorSpectra."""
_END = re.compile(rb"\n[ \t]*(?:>{3,}[ \t]*End|\[End)[^\n]*\s*\Z", re.IGNORECASE)
_WORDS = {"\t": "tabs", ";": "semicolons", ",": "commas", BLANKS: "blanks"}


class Form(NamedTuple):
    """How rows of numbers stand in a text."""

    separator: str
    point: str
    """The decimal mark."""
    columns: int
    """Cells in a row."""
    lead: int
    """Cells at the beginning of a row that are no numbers."""
    start: int
    """Byte at which the rows begin."""
    row: int
    """In which they do."""
    end: int
    top: tuple[str, ...]
    """The headings, one for each column; none where there are none."""
    top_row: int
    header: tuple[str, ...]
    """The other lines above."""

    @property
    def said(self) -> str:
        """The form in words."""
        marks = ", with decimal commas" if self.point == "," else ""
        lines = "line is" if len(self.header) == 1 else "lines are"
        above = f"; {len(self.header)} {lines} above, and not read" if self.header else ""
        between = f"cells are separated by {_WORDS[self.separator]}{marks}"
        return f"{between if self.columns > 1 else 'each row has one cell'}{above}"


class _Shape(NamedTuple):
    """A line that may be a row of numbers."""

    cells: list[str]
    lead: int


def find_form(path: Path, text: Text) -> Form:
    """Return how numbers stand in a text: the first two rows of as many of them tell.

    Parameters
    ----------
    path : path
        For what is said of it.
    text : Text

    Raises
    ------
    DatasetError
        If there are no such rows, or the first has another number of cells than the next.
    """
    data = text.data
    if not data.strip():
        raise DatasetError(f"{path}: empty; give a file with spectra")
    begun = _BEGIN.search(data[: 1 << 20])
    start = begun.end() if begun else 0
    row = 1 + data.count(b"\n", 0, start)
    end = _end(data)
    above = [line.text for line in lines(data, 0, 1, start)]
    header: list[Line] = []
    for line, after in _pairs(lines(data, start, row, end), header):
        form = _form(path, text, line, after, header, end)
        if form is not None:
            return form._replace(header=(*above, *form.header))
        header.append(line)
        if len(header) > MOST_HEADER:
            break
    raise DatasetError(
        f"{path}: no rows of numbers within its first {len(above) + len(header)} lines; write a "
        "first column headed 'wavelength (nm)' and a column of counts for each spectrum"
    )


def _end(data: bytes) -> int:
    """Return the byte at which rows end, before a line that says so."""
    begin = max(len(data) - 4096, 0)
    match = _END.search(data, begin)
    return match.start() + 1 if match else len(data)


def _pairs(every: Iterator[Line], header: list[Line]) -> Iterator[tuple[Line, Line | None]]:
    """Return each line with the next one; notes go to the header."""
    before: Line | None = None
    for line in every:
        if is_note(line.text):
            header.append(line)
        elif not is_empty(line.text):
            if before is not None:
                yield before, line
            before = line
    if before is not None:
        yield before, None


def _shape(line: Line, separator: str, point: str) -> _Shape | None:
    """Return a line as a row of numbers behind cells that are none; None if it is no such."""
    cells = cut(line.text, separator)
    lead = next((at for at, cell in enumerate(cells) if is_number(cell, point)), len(cells))
    rest = cells[lead:]
    if not rest or not all(is_number(cell, point) for cell in rest):
        return None
    return _Shape(cells, lead) if lead == 0 or len(rest) >= FEWEST else None


_BARE_SERIES = [",0"]
"""Headings of an index and a series without a name, as pandas writes them; elsewhere 0 is 0."""


def _form(
    path: Path, text: Text, line: Line, after: Line | None, header: list[Line], end: int
) -> Form | None:
    """Return the form of a text whose numbers begin in some line; None if they don't."""
    best: tuple[int, str, str, _Shape, int] | None = None
    ragged: tuple[int, int] | None = None
    for separator in SEPARATORS:
        for point in (".", ",") if separator != "," else (".",):
            first = _shape(line, separator, point)
            then = _shape(after, separator, point) if after is not None else first
            if first is None or then is None or then.lead > max(first.lead, 1):
                continue
            if first.cells == _BARE_SERIES and then.cells[0][:1] != ",":
                continue
            count = len(then.cells)
            bare = first.lead == 0 and len(first.cells) == count - 1 >= FEWEST
            if len(first.cells) != count and not bare:
                several = min(len(first.cells), count) > 1 and first.lead == then.lead == 0
                ragged = (len(first.cells), count) if several else ragged
            elif best is None or count - then.lead > best[0] - best[4]:
                best = count, separator, point, first, then.lead
    if best is not None:
        return _of(path, text, line, best, header, end)
    if ragged is not None and after is not None:
        raise DatasetError(
            f"{path}, row {after.row}: {shown(after.text)} given, {ragged[1]} cells, and row "
            f"{line.row} has {ragged[0]}; write as many in each row"
        )
    return None


def _of(
    path: Path,
    text: Text,
    line: Line,
    best: tuple[int, str, str, _Shape, int],
    header: list[Line],
    end: int,
) -> Form:
    count, separator, point, first, lead = best
    above = sorted(one for one in header if one.row < line.row)
    top: tuple[str, ...] = ()
    top_row, start, row = line.row, line.start, line.row
    if len(first.cells) == count - 1:  # an axis, above a column that has no heading
        top = ("", *first.cells)
    elif first.lead > 0 and _heads(first, lead):
        top = tuple(first.cells)
        if not any(known(cell) for cell in top[: first.lead]) and any(top[: first.lead]):
            _above(path, [*above, line], separator, count)  # which refuses it below headings
    if top:
        stop = text.data.find(b"\n", line.start, end)
        start, row = (end if stop < 0 else stop + 1), line.row + 1
        lead = lead if text.data[start:end].strip() else 0
    else:
        top, top_row = _above(path, above, separator, count) or (top, top_row)
    if separator != ",":
        point = _point(text.data, start, end, point)
    return Form(
        separator, point, count, lead, start, row, end, top, top_row,
        tuple(one.text for one in above if one.row != top_row),
    )  # fmt: skip


def _heads(first: _Shape, lead: int) -> bool:
    """Whether a line of text and numbers is one of headings, and not the first of the rows."""
    return first.lead > lead or any(known(cell) for cell in first.cells[: first.lead])


def _above(
    path: Path, above: list[Line], separator: str, count: int
) -> tuple[tuple[str, ...], int] | None:
    """Return the headings above the numbers and their row: a line, or a note below the last one.

    Up to three lines are looked at, as names, units and comments may stand in one each.
    """
    texts = [line for line in above if not is_note(line.text)][-3:]
    notes = [line for line in above if is_note(line.text) and [line] > texts[-1:]]
    likely = [*texts[-1:], *reversed(notes)]
    found = [(_headings(path, line, separator, count), line) for line in likely]
    found += [(_cells(line, separator, count), line) for line in reversed(texts[:-1])]
    named = [pair for pair in found if any(_is_axis(cell) for cell in pair[0])]
    chosen = next(iter(named or [pair for pair in found[: len(likely)] if pair[0]]), None)
    if chosen is None:
        return None
    for cells, line in found:
        if line > chosen[1] and any(is_number(cell, ".") for cell in cells):
            raise DatasetError(
                f"{path}, row {line.row}: {shown(line.text)} given, between the headings and the "
                "numbers, where a cell is no number; mend it, or leave the row out"
            )
    return chosen[0], chosen[1].row


def _is_axis(cell: str) -> bool:
    heading = known(cell)
    return heading is not None and heading.name in AXES


def _cells(line: Line, separator: str, count: int) -> tuple[str, ...]:
    """Return as many headings as there are columns, if they stand in a line; none else."""
    text = line.text.lstrip(" #")
    every = (cut_headings(text, one) for one in (separator, *SEPARATORS))
    return tuple(next((cells for cells in every if len(cells) == count), ()))


def _headings(path: Path, line: Line, separator: str, count: int) -> tuple[str, ...]:
    """Return the headings in a line, of which one or two may stand for all columns."""
    whole = _cells(line, separator, count)
    cells = cut_headings(line.text.lstrip(" #"), separator)
    if whole or not cells or not _is_axis(cells[0]):
        return whole
    if len(cells) > min(2, count):
        raise DatasetError(
            f"{path}, row {line.row}: {len(cells)} headings over {count} columns of numbers; give "
            "each column one"
        )
    return (*cells, *[""] * (count - len(cells)))


def _point(data: bytes, start: int, end: int, likely: str) -> str:
    """Return the decimal mark of rows in which a comma separates no cells."""
    comma, dot = data.find(b",", start, end), data.find(b".", start, end)
    if likely == "." and comma >= 0 and dot < 0:
        return ","
    return likely
