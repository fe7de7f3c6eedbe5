"""A measured series of phases in several bands: a column of each, with its number."""

import re
from collections.abc import Sequence
from pathlib import Path

from octsim.base.errors import DatasetError
from octsim.phase.measured_headings import listed, parse
from octsim.phase.measured_series import Series, read_as

_NUMBERED = re.compile(r"\s*phase([\s_-]*error)?[\s_-]*(\d+)(?![^\W_])(.*)", re.IGNORECASE)
_ELSE = "another column"


def read_series_of_bands(path: str | Path, count: int) -> tuple[Series, ...]:
    """Read the series of each band from a file with the headings time, phase_1, phase_2, ...

    Units and, maybe, phase_error_1, ... are as those of `read_series`; a phase without a number is
    another column.

    Parameters
    ----------
    path : path
    count : int
        Bands that there are.

    Raises
    ------
    DatasetError
        If the file can't be read, does not hold that many phases, or one is no series.
    """

    def wrong(headings: Sequence[str]) -> str | None:
        matches = [_NUMBERED.fullmatch(text) for text in headings]
        found = {int(match[2]) for match in matches if match and not match[1]}
        if found == set(range(1, count + 1)):
            return None
        there = ", ".join(f"phase_{number}" for number in sorted(found)) or "no phase with a number"
        return (
            f"it holds {there} under the headings {listed(headings)}, and expansion.bands has "
            f"{count}; write a column phase_1 to phase_{count}, one for each band in its order"
        )

    def of(number: int, text: str) -> str:
        match = _NUMBERED.fullmatch(text)
        if match is None:
            known = parse(text)
            return _ELSE if known and known.name.startswith("phase") else text
        if int(match[2]) != number:
            return _ELSE
        return f"phase{'_error' if match[1] else ''}{match[3]}"

    read = tuple(
        read_as(Path(path), lambda headings, n=n: [of(n, text) for text in headings], wrong)  # type: ignore[misc]
        for n in range(1, count + 1)
    )
    with_error = [one.phase_error is not None for one in read]
    if len(set(with_error)) > 1:
        lacking = 1 + with_error.index(False)
        raise DatasetError(
            f"{path}: phase_error_{lacking} is not there, but that of another phase is; give one "
            "for each phase, or for none"
        )
    return read
