"""When the rows of a text were written: in columns of numbers, or as dates and times of day."""

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.measured.readers.names import is_counting, known, rising, spanned, told_as, with_unit
from octsim.measured.recording import Values
from octsim.phase.measured_headings import Heading

Array = NDArray[np.float64]
_CLOCK = re.compile(r"(?:(\d{4}-\d\d-\d\d)[T ])?(\d{1,2}):(\d\d):(\d\d(?:[.,]\d+)?)Z?", re.ASCII)
_DAY = 86400.0


def stamped(cells: Sequence[str]) -> Array | None:
    """Return times of day in seconds, from the first midnight on; None if some cell is none.

    As ``14:02:03.5``, or with a day before it, as ``2024-05-01 14:02:03.5``; a time of day without
    one that falls is of the next day.
    """
    matches = [_CLOCK.fullmatch(cell) for cell in cells]
    if not cells or not all(matches):
        return None
    found = [one for one in matches if one]
    try:
        days = np.array([np.datetime64(one[1] or "1970-01-01", "D") for one in found])
    except ValueError:  # a month or a day that there is not
        return None
    clock = np.array(
        [3600 * int(one[2]) + 60 * int(one[3]) + float(one[4].replace(",", ".")) for one in found]
    )
    late = np.zeros(clock.size)
    if not any(one[1] for one in found):
        late[1:] = np.cumsum(np.diff(clock) < -_DAY / 2)
    return np.asarray(clock + _DAY * ((days - days[0]).astype(float) + late))


class _Column(NamedTuple):
    """A column before spectra that are rows."""

    heading: str
    values: Array | None
    """None of a text that is no time."""
    clock: bool
    """Whether they are times of day, in s."""


def times_in(
    headings: Sequence[str],
    lead: Sequence[Sequence[str]],
    numbers: Array,
    milliseconds: bool,
    where: str,
) -> tuple[Values | None, list[str]]:
    """Return the times in the columns before spectra that are rows, and what is to be said.

    Parameters
    ----------
    headings : sequence of str
        Of these columns; none where there are none.
    lead : sequence
        Cells of each row that are no numbers, which stand first.
    numbers : ndarray, shape (T, C)
        Those behind them.
    milliseconds : bool
        Whether a column of numbers without a heading is of milliseconds, as OceanView writes it.
    where : str
        For what is said of a unit that is not known.

    Raises
    ------
    DatasetError
        If a column of times has a unit that is not known.
    """
    texts = [stamped(cells) for cells in zip(*lead, strict=True)]
    values = [*texts, *numbers.T]
    columns = [
        _Column(heading, one, place < len(texts))
        for place, (heading, one) in enumerate(
            zip(headings or [""] * len(values), values, strict=True)
        )
    ]
    for column in columns:
        heading = known(column.heading)
        if heading is not None and heading.name == "time" and column.values is not None:
            heading = Heading("time", "s") if column.clock else heading
            times, unsaid = with_unit(column.values, heading, where)
            return times, [told_as(repr(column.heading), times, unsaid)]
    for column in reversed(columns):
        if column.values is not None and not column.heading:
            return _unnamed(column.values, column.clock, milliseconds)
    return None, ["no column before the spectra is of times"] if columns else []


def _unnamed(values: Array, clock: bool, milliseconds: bool) -> tuple[Values | None, list[str]]:
    """Return the numbers of a column without a heading as times, where they may be."""
    if not clock and not milliseconds and (is_counting(values) or not rising(values)):
        return None, ["the first column has no heading, and is not taken for times"]
    unit = "ms" if milliseconds and not clock else "s"
    what = "times of day" if clock else f"times in {unit}"
    sure = "" if clock or milliseconds else "warning: "
    said = f"{sure}a column without a heading is taken for {what}: {spanned(values)}"
    return Values(values, "time", unit), [said]
