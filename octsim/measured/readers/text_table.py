"""Text files of spectra: as columns beside their axis, or as rows below it."""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import DatasetError
from octsim.config.units import find_unit
from octsim.measured.readers.names import (
    AXES,
    FEWEST,
    counts_samples,
    is_counting,
    known,
    plausible,
    rising,
    times_of,
    told_as,
    unit_of,
    with_unit,
)
from octsim.measured.readers.text_form import Form
from octsim.measured.readers.text_lines import is_number
from octsim.measured.readers.text_numbers import Table
from octsim.measured.readers.text_stamps import times_in
from octsim.measured.recording import Values
from octsim.phase.measured_headings import Heading, listed, of_errors, parse
from octsim.phase.measured_tables import shown

Array = NDArray[np.float64]
_STRAY = re.compile(r"[-+.,]?\d")
_CELL = re.compile(r"([-+\d.,eE]+)\s*([^\W\d_]*)")


class Read(NamedTuple):
    """A text as its numbers were read."""

    path: Path
    form: Form
    table: Table
    axis: Heading | None
    """What its header says that the axis is."""
    milliseconds: bool
    """Whether it is of OceanView, which writes these before each spectrum."""

    @property
    def numbers(self) -> Array:
        """(R, C)."""
        return self.table.numbers


class Laid(NamedTuple):
    """Spectra of a text as rows."""

    counts: Array
    """(T, K)."""
    axis: Values | None
    time: Values | None
    by: str
    """What tells that the samples are these, in words."""
    notes: tuple[str, ...]


class _Tail(NamedTuple):
    """The numbers that stand among the headings, behind some that are none."""

    first: int
    values: Array
    unit: str


def laid_by_headings(read: Read, samples: int | None) -> Laid | None:
    """Return the spectra as the headings tell them; None where these don't.

    Parameters
    ----------
    read : Read
    samples : int or None
        K, if it is known.

    Raises
    ------
    DatasetError
        If headings contradict the numbers, or are those of other columns than of spectra.
    """
    top = read.form.top
    if not top:
        return None
    tail = _tail(top, read.form.point)
    headings = [known(text) for text in top]
    named = [place for place, one in enumerate(headings) if one and one.name in AXES]
    if named and named[0] >= read.form.lead:
        heading = headings[named[0]]
        assert heading is not None, "as it is named"
        if tail is None or not _is_below(read, named[0], heading, tail):
            return columns(read, named[0], heading, f"the heading {top[named[0]]!r}")
        return _below(read, tail, heading)
    dated = any(one and one.name == "time" for one in headings)
    likely = (
        None if tail is None or tail.unit not in ("", "nm", "um", "µm") else _likely(read, tail)
    )
    if tail is not None and likely is not None:
        beside = None if dated or read.form.lead else plausible(read.numbers[:, 0])
        if beside and samples == len(read.numbers) != tail.values.size:
            return columns(read, 0, Heading("wavelength", beside), "the length of the axis")
        if beside and samples is None:
            raise both(read)
        return _below(read, tail, likely)
    if dated:
        return _without_axis(read, headings)
    _refuse_stray(read, tail)
    return None


def both(read: Read) -> DatasetError:
    """Return the error of a text whose first row and first column may both be the axis."""
    return DatasetError(
        f"{read.path}: the first row, row {read.form.top_row}, and the first column may both be "
        "wavelengths; head the one that is 'wavelength (nm)', or give measured.axis with a file, "
        "whose length tells"
    )


def _tail(top: tuple[str, ...], point: str) -> _Tail | None:
    """Return the numbers at the end of headings, with the unit that all of them have."""
    matches = [_CELL.fullmatch(text) for text in top]
    found = [
        one if one and (is_number(one[1], point) or is_number(one[1], ".")) else None
        for one in matches
    ]
    first = next((at for at in range(len(top), 0, -1) if found[at - 1] is None), 0)
    numbers = [one for one in found[first:] if one]
    units = {unit_of(one[2]) for one in numbers}
    if not numbers or len(units) > 1:
        return None
    values = np.array([float(one[1].replace(",", ".")) for one in numbers])
    return _Tail(first, values, units.pop())


def _likely(read: Read, tail: _Tail) -> Heading | None:
    """Return what numbers in the headings may be along the samples; None if they are none."""
    if tail.unit:
        ordered = plausible(tail.values, tail.unit) is not None
        return Heading("wavelength", tail.unit) if ordered else None
    if read.axis is not None and tail.values.size >= FEWEST:
        return read.axis
    unit = plausible(tail.values)
    return Heading("wavelength", None) if unit else None


def _is_below(read: Read, place: int, heading: Heading, tail: _Tail) -> bool:
    """Whether a heading of the axis is of the numbers in its row, and not of those below it."""
    unit = unit_of(heading.unit) if heading.unit else None
    column = read.numbers[:, place - read.form.lead]
    if not column.size:
        return True
    return plausible(tail.values, unit) is not None and plausible(column, unit) is None


def _below(read: Read, tail: _Tail, heading: Heading) -> Laid:
    """Return spectra that are rows below their axis."""
    where = f"{read.path}, row {read.form.top_row}"
    axis, unsaid = with_unit(tail.values, heading, where)
    what = f"row {read.form.top_row}"
    return rows(read, tail.first, axis, what, told_as(what, axis, unsaid))


def rows(read: Read, first: int, axis: Values | None, by: str, *said: str) -> Laid:
    """Return spectra that are rows.

    Parameters
    ----------
    read : Read
    first : int
        Columns that stand before the counts.
    axis : Values or None
    by : str
        What tells.
    *said : str
        What is to be said.
    """
    own = first - read.form.lead
    # a heading of the axis is of what stands beside it, not of what stands below
    headings = [
        "" if (one := known(text)) and one.name in AXES else text
        for text in ([] if by == "the first row" else read.form.top[:first])
    ]
    where = f"{read.path}, row {read.form.top_row}"
    before = read.numbers[:, :own]
    time, notes = times_in(headings, read.table.lead, before, read.milliseconds, where)
    return Laid(read.numbers[:, own:], axis, time, by, (*said, *notes))


def _without_axis(read: Read, headings: list[Heading | None]) -> Laid:
    """Return spectra that are rows behind their time, with no axis above them."""
    names = read.form.top
    first = 1 + max(place for place, one in enumerate(headings) if one and one.name == "time")
    _refuse_others(read, list(names[first:]))
    if len(names) - first < FEWEST:
        raise DatasetError(
            f"{read.path}, row {read.form.top_row}: the headings are {listed(names)}, of a time "
            f"and {len(names) - first} columns beside it, which are no spectra; give spectra"
        )
    return rows(read, first, None, f"the heading {names[first - 1]!r}")


def columns(read: Read, place: int, heading: Heading, by: str) -> Laid:
    """Return spectra that are columns beside their axis.

    Parameters
    ----------
    read : Read
    place : int
        Column of the axis.
    heading : Heading
        What it is.
    by : str
        What tells.

    Raises
    ------
    DatasetError
        If another column is of no spectrum.
    """
    lead, top = read.form.lead, read.form.top or ("",) * read.form.columns
    where = f"{read.path}, row {read.form.top_row}"
    axis, unsaid = with_unit(read.numbers[:, place - lead], heading, where)
    what = f"column {place + 1}" + f", {top[place]!r}" * bool(top[place])
    notes = [told_as(what, axis, unsaid)]
    kept = []
    for other in range(read.form.columns):
        if other < lead or (
            other < place and (counts_samples(top[other]) or is_counting(read.numbers[:, other]))
        ):
            notes.append(f"column {other + 1} is not read, as it does but count")
        elif other != place:
            kept.append(other)
    _refuse_others(read, [top[other] for other in kept])
    named = not top[place] or known(top[place])
    time, said = times_of([top[other] for other in kept]) if named else (None, "")
    counts = read.numbers[:, [other - lead for other in kept]].T
    return Laid(counts, axis, time, by, (*notes, *([said] if said else [])))


def _refuse_others(read: Read, headings: list[str]) -> None:
    """Refuse headings of what is no spectrum."""
    for text in headings:
        heading = known(text)
        if parse(text) or of_errors(text) or (heading is not None and heading.name in AXES):
            raise DatasetError(
                f"{read.path}, row {read.form.top_row}: the column {text!r} is of no spectrum, and "
                "would be read as one; leave it out"
            )


def _refuse_stray(read: Read, tail: _Tail | None) -> None:
    """Refuse a row above the numbers that is rather one of them, with a cell that is none."""
    given = read.form.top[0]
    if tail is None or (given and not _STRAY.match(given)):
        return
    if not given and (is_counting(tail.values) or (tail.values.size > 1 and rising(tail.values))):
        return
    unit = find_unit(tail.unit) if tail.unit else None
    if unit is not None and unit.dimension == "time":
        return
    problem = f"cell 1 is {shown(given)}, which is no number" if given else "a cell is missing"
    raise DatasetError(
        f"{read.path}, row {read.form.top_row}: {problem}, among others that are; mend it, or head "
        "the first column 'wavelength (nm)'"
    )
