"""Text with rows of numbers: what stands between its cells, and the blocks that headings begin."""

import csv
import re
from collections.abc import Callable
from typing import NamedTuple

from octsim.base.files import read_bounded, reason
from octsim.config.units import parse_length

_MOST_BYTES = 8_000_000
_MOST_LINES = 50_000

_COMMA = re.compile(r"([-+]?[0-9]+),([0-9]+(?:[eE][-+]?[0-9]+)?)")
_OF_WORDS = re.compile(r"(?<=[^\s,;])\s+(?=[(\[])|(?<=refractive)\s+(?=index)|"
                       r"(?<=extinction)\s+(?=coefficient)", re.IGNORECASE)  # fmt: skip


WAVELENGTH = re.compile(
    r"(?:wavelengths?|lambda|λ|wl|wvl)[\s_,/]*(?:in\s+)?"
    r"(?:\(\s*(.+?)\s*\)|\[\s*(.+?)\s*\]|([^\W\d_]+))?",
    re.IGNORECASE,
)
"""The heading of wavelengths, with their unit or without."""


class Block(NamedTuple):
    """Rows below a heading, if there is one."""

    heading: list[str] | None
    rows: list[tuple[int, list[str]]]
    """Number of each row in the file, counted from 1, and its cells."""


def is_number(cell: str) -> bool:
    """Return whether a cell is a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def unit_in(heading: re.Match[str]) -> str | None:
    """Return the unit in a heading of wavelengths; None without one."""
    return heading[1] or heading[2] or heading[3]


def unit_of(
    file: str, given: str | None, said: str | None, form: str, usual: str | None = None
) -> str:
    """Return the unit of a file's wavelengths: as given, as its heading says, or as is usual.

    Raises
    ------
    ValueError
        If none says it, or two differ; with the form that the file should have.
    """
    if said and given and parse_length(f"1 {said}") != parse_length(f"1 {given}"):
        raise ValueError(f"unit: {given} is given, but {file} says {said}; leave one of them out")
    if unit := given or said or usual:
        return unit
    raise ValueError(
        f"{file} does not say the unit of its wavelengths; {form}, or give the unit beside it, "
        f"as {{table: {file}, unit: nm}}"
    )


def read_blocks(file: str, is_heading: Callable[[list[str]], bool]) -> list[Block]:
    """Read the blocks of a file: one, or one more for each heading between rows.

    Lines that begin with # are not read, but as a heading where there is none else.

    Parameters
    ----------
    file : str
        Path of it, from the current folder.
    is_heading : callable
        Whether cells are a heading.

    Raises
    ------
    ValueError
        If it can't be read.
    """
    lines, remarks = _lines(file)
    between = _between([line for _, line in lines])
    blocks: list[Block] = []
    for number, line in lines:
        cells = _cells(line, between)
        headed = not is_number(cells[0]) and (not blocks or is_heading(cells))
        if headed or not blocks:
            blocks.append(Block(cells if headed else None, []))
        if headed:
            blocks[-1] = Block(_heading(line, between), [])
        else:
            blocks[-1].rows.append((number, cells))
    if blocks and blocks[0].heading is None:
        said = [_heading(remark, mark) for remark in remarks for mark in (between, ",", " ")]
        heading = next((cells for cells in said[::-1] if is_heading(cells)), None)
        blocks[0] = Block(heading, blocks[0].rows)
    return blocks


def _lines(file: str) -> tuple[list[tuple[int, str]], list[str]]:
    """Return the lines that hold cells with their numbers, and the remarks above all of them."""
    try:
        text = read_bounded(file, _MOST_BYTES).decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        why = reason(error) if isinstance(error, OSError) else "it is not text"
        raise ValueError(f"{file} can't be read ({why}); give a CSV file") from None
    given = text.splitlines()
    if len(given) > _MOST_LINES:
        raise ValueError(f"{file} holds {len(given)} lines; give {_MOST_LINES} at most")
    lines, remarks = list[tuple[int, str]](), list[str]()
    for number, line in enumerate(map(str.strip, given), 1):
        if line.startswith("#") and not lines:
            remarks.append(line.lstrip("# "))
        elif line and not line.startswith("#"):
            lines.append((number, line))
    return lines, remarks


def _between(lines: list[str]) -> str:
    """Return what stands between cells; a blank is any white space."""
    line = next(
        (line for line in lines if re.match(r"[-+.]?[0-9]", line)), lines[0] if lines else ""
    )
    for mark in ";\t":
        if mark in line:
            return mark
    cells = line.split()
    pointed = [_COMMA.sub(r"\1.\2", cell) for cell in cells]
    # 600,5 1,39 has decimal commas; 600, 1.39 and 600,1.39 have commas between cells
    spaced = len(cells) > 1 and all(map(is_number, pointed))
    return " " if spaced or (len(cells) > 1 and "," not in line) else ","


def _cells(line: str, between: str) -> list[str]:
    cells = line.split() if between == " " else _quoted(line, between)
    stripped = [cell.strip() for cell in cells]
    if between == ",":
        return stripped
    return [_COMMA.sub(r"\1.\2", cell) if _COMMA.fullmatch(cell) else cell for cell in stripped]


def _quoted(line: str, between: str, mark: str = '"') -> list[str]:
    blanks = between == " "  # of which several may follow each other
    try:
        return next(csv.reader([line], delimiter=between, quotechar=mark, skipinitialspace=blanks))
    except csv.Error as error:
        raise ValueError(
            f"{line[:40]!r}... can't be read ({error}); give a number in each cell"
        ) from None


def _heading(line: str, between: str) -> list[str]:
    if between == " ":
        mark = next((one for one in "\"'" if one in line), None)
        if mark:
            return _quoted(line, " ", mark)
        parts = re.split(r"\s{2,}", _OF_WORDS.sub("_", line))
        return parts if len(parts) > 1 else parts[0].replace(", ", ",").split()
    cells = _cells(line, between)
    if between == "," and '"' not in line:
        # a unit after a comma, as in Wavelength, nm
        for place in range(len(cells) - 1, 0, -1):
            if re.fullmatch(r"[nµμupm]m|[åÅA]|angstroms?|microns?|micrometers?", cells[place]):
                cells[place - 1 : place + 1] = [f"{cells[place - 1]} ({cells[place]})"]
    return cells
