"""Files that hold refractive indices: a wavelength, n and maybe κ in each row."""

import re
from typing import NamedTuple

from octsim.config.table_text import (
    WAVELENGTH,
    Block,
    is_number,
    read_blocks,
    unit_in,
    unit_of,
)
from octsim.config.units import parse_length

FORM = "write a first row as 'wavelength (nm),n' or 'wavelength (nm),n,kappa'"
_N = (
    "n", "refractiveindex", "index", "indexofrefraction", "nreal", "realn", "ren", "nre", "ri",
    "refractiveindexn", "nrefractiveindex",
)  # fmt: skip
_KAPPA = (
    "kappa", "k", "κ", "extinctioncoefficient", "extinction", "nimag", "imagn", "imn", "nim",
    "extinctioncoefficientk", "kextinctioncoefficient", "extinctioncoefficientkappa",
)  # fmt: skip
_COLUMNS = dict.fromkeys(_N, "n") | dict.fromkeys(_KAPPA, "kappa")
_MICROMETRES = (0.01, 99.0)
"""Between these are the wavelengths of refractiveindex.info, whose heading is wl alone, in µm."""


class Rows(NamedTuple):
    """What a file holds, one value in each row."""

    wavelength: tuple[float, ...]
    """µm."""
    n: tuple[float, ...]
    kappa: tuple[float, ...] | None
    number: tuple[int, ...]
    """Of each row in the file, counted from 1."""
    unit: str
    """Of the wavelengths in the file."""


class _Heading(NamedTuple):
    """Where the columns are, and the unit of the wavelengths, if it is said."""

    columns: dict[str, int]
    unit: str | None
    cells: int
    """How many columns there are."""


def read_indices(file: str, unit: str | None) -> Rows:
    """Read the refractive indices that a file holds.

    Commas, semicolons, tabs or blanks stand between cells, and numbers may have a decimal comma
    where it is none of them. Lines that begin with # are remarks. A second block may hold κ, as
    in the CSV files of refractiveindex.info.

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
    blocks = read_blocks(file, _is_heading)
    if not blocks:
        raise ValueError(f"{file} holds nothing; {FORM}, and rows of numbers below")
    headings = [_heading(file, block, later=bool(place)) for place, block in enumerate(blocks)]
    unit = unit_of(file, unit, headings[0].unit, FORM, _by_convention(blocks[0]))
    first, *others = (
        [_values(file, number, row, heading, unit) for number, row in block.rows]
        for block, heading in zip(blocks, headings, strict=True)
    )
    wavelength, n, kappas = zip(*first, strict=True) if first else ((), (), ())
    kappa = kappas if "kappa" in headings[0].columns else None
    for other in others:
        if kappa is not None or tuple(row[0] for row in other) != wavelength:
            raise ValueError(
                f"{file} holds kappa twice, or at other wavelengths than n; give each wavelength "
                "one of each"
            )
        kappa = tuple(row[2] for row in other)
    numbers = tuple(number for number, _ in blocks[0].rows)
    return Rows(wavelength, n, kappa, numbers, unit)


def _column(cell: str) -> str | None:
    """Return what the column of a heading holds; None of another."""
    if WAVELENGTH.fullmatch(cell.strip()):
        return "wavelength"
    return _COLUMNS.get(re.sub(r"[\W_]+", "", cell.lower()))


def _is_heading(cells: list[str]) -> bool:
    found = set(map(_column, cells))
    return "wavelength" in found and bool(found & {"n", "kappa"})


def _by_convention(block: Block) -> str | None:
    """Return the unit of the wavelengths of a heading that is just wl, as those of many files."""
    if not block.heading or block.heading[0].lower() != "wl":
        return None
    first = [float(row[0]) for _, row in block.rows if is_number(row[0])]
    least, most = _MICROMETRES
    return "um" if all(least <= one <= most for one in first) else None


def _heading(file: str, block: Block, *, later: bool) -> _Heading:
    """Return what a block's heading says; a later block holds κ alone."""
    cells = block.heading
    if cells is None:
        if all(len(row) > 2 and all(map(str.isdecimal, row[1:])) for _, row in block.rows):
            raise ValueError(
                f"{file} has whole numbers alone beside its wavelengths; with decimal commas write "
                "semicolons between cells, else headings"
            )
        return _by_order(file, len(block.rows[0][1]))
    columns, unit = dict[str, int](), None
    for place, cell in enumerate(cells):
        name = _column(cell)
        if name in columns:
            raise ValueError(f"{file} has two columns of {name}; leave one of them out")
        if name:
            columns[name] = place
        if match := WAVELENGTH.fullmatch(cell.strip()):
            unit = unit_in(match)
    for name in ("wavelength", "kappa" if later else "n"):
        if name not in columns:
            found = ", ".join(f"'{cell}'" for cell in cells)
            raise ValueError(f"{file} has no column of {name} by its first row, {found}; {FORM}")
    if unit:
        _require_length(file, unit)
    return _Heading(columns, unit, len(cells))


def _by_order(file: str, count: int) -> _Heading:
    if count not in (2, 3):
        raise ValueError(f"{file} has {count} cells in its first row, and no headings; {FORM}")
    columns = {"wavelength": 0, "n": 1} | ({"kappa": 2} if count == 3 else {})
    return _Heading(columns, None, count)


def _require_length(file: str, unit: str) -> None:
    try:
        parse_length(f"1 {unit}")
    except ValueError as error:
        raise ValueError(f"the wavelengths of {file}: {error}") from None


def _values(
    file: str, number: int, row: list[str], heading: _Heading, unit: str
) -> tuple[float, float, float]:
    if any(row[heading.cells :]):
        raise ValueError(
            f"{file}, row {number}: {len(row)} cells, but {heading.cells} columns; with decimal "
            "commas write semicolons between cells"
        )
    cells = {
        name: row[place] if place < len(row) else "" for name, place in heading.columns.items()
    }
    for name, cell in cells.items():
        if not is_number(cell):
            raise ValueError(
                f"{file}, row {number}: {cell!r} is no {name}; each row has a number of each"
            )
    # as text, so that 650 nm is the same float as 0.65 um
    wavelength = parse_length(f"{cells['wavelength']} {unit}")
    return wavelength, float(cells.get("n", "nan")), float(cells.get("kappa", "0"))
