"""A measured series of phases: reading it, and its change from rest."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import DatasetError, FileError
from octsim.phase.measured_headings import factor, places, problem
from octsim.phase.measured_netcdf import read_variables
from octsim.phase.measured_tables import FORM, is_netcdf, numbers, read_table
from octsim.phase.stand_ins import stand_ins

Array = NDArray[np.float64]

NEEDED, OPTIONAL = ("time", "phase"), ("phase_error",)
"""What a series holds."""
LARGEST_STEP = 0.75 * np.pi
"""Between neighbouring samples, rad; beyond it no one can tell which way round a phase went."""


class Series(NamedTuple):
    """Phases over time, each (T,); NaN where a sample is missing."""

    time: Array
    """Increasing, s."""
    phase: Array
    """rad, wrapped or not."""
    phase_error: Array | None = None
    """One standard deviation of each, rad, where it is known."""


class PhaseChange(NamedTuple):
    """Change of the phase from rest, rad, and its standard error; NaN where it is missing."""

    phase: Array
    error: Array
    scatter: float
    """Of the samples at rest about their mean or line, rad; NaN where errors are given."""
    freedom: float
    """Degrees of freedom that it has; infinite where errors are given."""
    drift: float
    """Of the line that was subtracted, rad/s; 0 where it was the mean."""


def read_series(path: str | Path) -> Series:
    r"""Read time, phase and, where it is given, phase_error from a CSV or netCDF file.

    A CSV file has one heading, `time,phase` or with units `time (ms),phase (mrad)`; see
    `octsim.phase.measured_headings.parse` for how it may be written. Commas, semicolons or tabs
    stand between cells, lines that begin with # are not read, and neither are other columns; an
    empty cell or `nan` is a missing sample. A netCDF file has variables of these names over one
    dimension, with units as attributes. Without units they are s and rad.

    Raises
    ------
    DatasetError
        If the file is missing, can't be read, or does not hold a series; with the row of the file
        or the sample, both counted from 1.

    Examples
    --------
    >>> import octsim
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "phases.csv")
    ...     _ = file.write_text("time (ms),phase (mrad)\n0,1\n1,12\n")
    ...     series = octsim.read_series(file)
    >>> series.phase.tolist()
    [0.001, 0.012]
    """
    return read_as(Path(path), list, lambda _: None)


Renamed = Callable[[Sequence[str]], list[str]]
"""Takes headings, and returns what they are read as."""


def read_as(path: Path, renamed: Renamed, wrong: Callable[[Sequence[str]], str | None]) -> Series:
    """Read a series as `read_series` does, of headings that stand for others.

    Parameters
    ----------
    path : Path
    renamed : callable
        Returns what headings are read as.
    wrong : callable
        Returns what is wrong with headings as they are, if something is.
    """

    def problem_of(headings: Sequence[str], form: str = FORM) -> str | None:
        return wrong(headings) or problem(renamed(headings), NEEDED, OPTIONAL, form)

    try:
        if is_netcdf(path):
            return _of_netcdf(path, renamed, problem_of)
        return _of_csv(path, renamed, problem_of)
    except FileError as error:
        raise DatasetError(str(error)) from None


def _of_csv(path: Path, renamed: Renamed, problem_of: Callable[..., str | None]) -> Series:
    table = read_table(path, problem_of)
    columns = {
        name: (numbers(table, place, name), factor(heading))
        for name, (place, heading) in places(renamed(table.headings), NEEDED + OPTIONAL).items()
    }
    return _series(columns, lambda sample: f"{path}, row {table.rows[sample]}", str(path))


def _of_netcdf(path: Path, renamed: Renamed, problem_of: Callable[..., str | None]) -> Series:
    stored = read_variables(path)
    names = list(map(str, stored.variables))
    units = [stored[name].attrs.get("units") for name in names]
    headings = [
        name if unit is None else f"{name} ({unit})"
        for name, unit in zip(names, units, strict=True)
    ]
    if what := problem_of(headings, "as the name of a variable of numbers"):
        raise DatasetError(f"{path}: {what}")
    found = places(renamed(headings), NEEDED + OPTIONAL)
    dimensions = {name: stored[names[place]].dims for name, (place, _) in found.items()}
    if len(set(dimensions.values())) > 1 or len(dimensions["phase"]) != 1:
        said = ", ".join(f"{name} ({', '.join(map(str, of))})" for name, of in dimensions.items())
        raise DatasetError(
            f"{path}: the dimensions are {said}; give them all one and the same, a sample each"
        )
    columns = {
        name: (stored[names[place]].values, factor(heading))
        for name, (place, heading) in found.items()
    }
    return _series(columns, lambda _: str(path), str(path))


def _series(
    columns: Mapping[str, tuple[Array, float]], where: Callable[[int], str], name: str
) -> Series:
    """Make a series of columns in units of some size, if it is one; say where it is not."""
    for what, (values, _) in columns.items():
        marked = stand_ins(values)
        if marked.any():
            at = int(marked.argmax())
            raise DatasetError(
                f"{where(at)}: {what} of sample {at + 1} is {values[at]:g}, which stands for no "
                "value; leave it empty, or give the value"
            )
    series = Series(**{what: size * values for what, (values, size) in columns.items()})
    if found := _unfit(series):
        place, said = found
        raise DatasetError(f"{name if place is None else where(place)}: {said}")
    return series


def _unfit(series: Series) -> tuple[int | None, str] | None:
    """Return at which sample something is wrong with a series, and what, if something is."""
    time, phase, error = series
    if np.isinf(phase).any():
        at = int(np.isinf(phase).argmax())
        return at, f"the phase of sample {at + 1} is infinite; leave it out"
    if not np.isfinite(phase).any():
        return None, "no sample has a phase; give one that has"
    if not np.isfinite(time).all():
        at = int((~np.isfinite(time)).argmax())
        return at, f"sample {at + 1} has no time; give it one"
    late = np.diff(time) <= 0
    if late.any():
        at = 1 + int(late.argmax())
        return at, (
            f"the time goes from {time[at - 1]:g} to {time[at]:g} s at sample {at + 1}; sort the "
            "samples by time, each once"
        )
    if error is not None:
        bad = np.isfinite(phase) & ~(np.isfinite(error) & (error >= 0))
        if bad.any():
            at = int(bad.argmax())
            said = f"phase_error of sample {at + 1} is {error[at]:g}; give a number of 0 or more"
            return at, said
    return None


def change_from_rest(
    series: Series,
    rest: int,
    drifts: bool = False,
    references: Sequence[tuple[int, int]] = (),
) -> PhaseChange:
    r"""Unwrap a series' phases, and subtract what they are where nothing moves.

    That is the mean over the samples at rest or, where the phase drifts, the straight line through
    them by least squares. Missing samples stay missing, and are passed over when phases are
    unwrapped. Without a phase_error, the scatter of the samples at rest serves for all. The error
    of a change is that of the sample and of the mean or line, together: for errors e_i of n samples
    at rest at the times t_i,

    .. math:: e^2 + \sum_i e_i^2 (1/n + a_i (t - \bar t))^2, \quad
              a_i = (t_i - \bar t) / \sum_j (t_j - \bar t)^2,

    where all a are 0 without a drift.

    Parameters
    ----------
    series : Series
    rest : int
        Samples at the start that are at rest.
    drifts : bool
        Whether a line takes the place of the mean.
    references : sequence of pairs of int
        More samples that are at rest: from the first to the last of each, counted from 1.

    Raises
    ------
    DatasetError
        If too few of them have a phase, or a phase moves too far between samples to be unwrapped.
    """
    phase, there = unwrapped(series), np.isfinite(series.phase)
    still = _at_rest(series, rest, references) & there
    count = int(still.sum())
    needed = (1 if series.phase_error is not None else 3) + drifts
    if count < needed:
        raise DatasetError(
            f"expansion.rest: of the first {rest} of {phase.size} samples"
            f"{' and those of reference' if references else ''} {count} have a phase, and {needed} "
            "are needed; give more samples at rest, or phase_error"
        )
    lever = series.time - series.time[still].mean()
    turn = lever[still] / (lever[still] ** 2).sum() if drifts else np.zeros(count)
    slope = (turn * phase[still]).sum()
    level = phase[still] - slope * lever[still]
    if series.phase_error is None:
        scatter, freedom = float(level.std(ddof=1 + drifts)), count - 1.0 - drifts
        error = np.full_like(phase, scatter)
    else:
        scatter, freedom, error = np.nan, np.inf, series.phase_error
    of_rest = error[still] ** 2
    crossed, turned = count * (turn * of_rest).sum(), count**2 * (turn**2 * of_rest).sum()
    shared = of_rest.sum() + 2 * crossed * lever + turned * lever**2
    both = np.hypot(error, np.sqrt(shared) / count)
    return PhaseChange(
        phase - (level.mean() + slope * lever),
        np.where(there, both, np.nan),
        scatter,
        freedom,
        float(slope),
    )


def unwrapped(series: Series) -> Array:
    """Return the phases of a series unwrapped, rad, those that are there one after the other.

    Raises
    ------
    DatasetError
        If one moves too far for that from one sample to the next.
    """
    phase, there = series.phase.copy(), np.flatnonzero(np.isfinite(series.phase))
    phase[there] = np.unwrap(series.phase[there])
    steps, given = np.abs(np.diff(phase[there])), np.abs(np.diff(series.phase[there]))
    for moved, most, remedy in (
        (given, 2 * np.pi + LARGEST_STEP, "leave out a value that stands for none"),
        (steps, LARGEST_STEP, "sample faster"),
    ):
        if (moved > most).any():
            at = there[int(moved.argmax()) + 1]
            raise DatasetError(
                f"series: the phase moves by {moved.max():.3g} rad up to {series.time[at]:g} s "
                f"(sample {at + 1}), which can't be unwrapped beyond {most:.3g}; {remedy}"
            )
    return phase


def _at_rest(series: Series, rest: int, references: Sequence[tuple[int, int]]) -> NDArray[np.bool_]:
    """Mark the samples that are at rest, (T,)."""
    still = np.zeros(series.phase.size, bool)
    beyond = [f"{first} to {last}" for first, last in references if last > still.size]
    if rest > still.size or beyond:
        key, asked = ("rest", f"the first {rest}") if rest > still.size else ("drift", beyond[0])
        raise DatasetError(
            f"expansion.{key}: {asked} of {still.size} samples asked for; give samples that are "
            "there"
        )
    for first, last in ((1, rest), *references):
        still[first - 1 : last] = True
    return still
