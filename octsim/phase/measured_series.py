"""A measured series of phases: reading it, and its change from rest."""

import csv
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import DatasetError
from octsim.base.files import reason
from octsim.config.units import known_units

Array = NDArray[np.float64]

UNITS: Mapping[str, tuple[str, ...]] = {
    "time": ("s", "ms", "us", "µs"),
    "phase": ("rad", "mrad"),
    "phase_error": ("rad", "mrad"),
}
"""What a series holds, and the units that may stand beside it; the first where none does."""
LARGEST_STEP = 0.75 * np.pi
"""Between neighbouring samples, rad; beyond it no one can tell which way round a phase went."""
_NETCDF = (".nc", ".nc4", ".cdf")
_HEADING = re.compile(r"\s*(\w+)\s*(?:[(\[]\s*(\S+?)\s*[)\]])?\s*")


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


def read_series(path: str | Path) -> Series:
    """Read time, phase and, where it is given, phase_error from a CSV or netCDF file.

    A CSV file has one heading, `time,phase` or with units `time (ms),phase (mrad)`; an empty cell
    or `nan` is a missing sample, and what stands behind # is not read. A netCDF file has variables
    of these names over one dimension, with units as attributes. Without units they are s and rad.

    Raises
    ------
    DatasetError
        If the file is missing, can't be read, or does not hold a series.
    """
    path = Path(path)
    try:
        columns = _netcdf(path) if path.suffix.lower() in _NETCDF else _csv(path)
    except FileNotFoundError:
        raise DatasetError(f"{path}: not there; give the series' file") from None
    except (OSError, RuntimeError, UnicodeDecodeError) as error:
        raise DatasetError(f"{path}: can't be read ({reason(error)}); give CSV or netCDF") from None
    for name in ("time", "phase"):
        if name not in columns:
            raise DatasetError(f"{path}: holds no '{name}'; name it so, in its heading or variable")
    series = Series(columns["time"], columns["phase"], columns.get("phase_error"))
    if problem := _problem(series):
        raise DatasetError(f"{path}: {problem}")
    return series


def _problem(series: Series) -> str | None:
    """Return in a line what is wrong with a series, if something is."""
    time, phase, error = series
    if phase.ndim != 1 or any(part is not None and part.shape != phase.shape for part in series):
        return "time, phase and phase_error are not of one length; give each sample all of them"
    if phase.size == 0 or not np.isfinite(phase).any():
        return "no sample has a phase; give one that has"
    if np.isinf(phase).any():
        return f"the phase of sample {1 + int(np.isinf(phase).argmax())} is infinite; leave it out"
    if not np.isfinite(time).all():
        return f"sample {1 + int((~np.isfinite(time)).argmax())} has no time; give it one"
    late = np.diff(time) <= 0
    if late.any():
        at = 1 + int(late.argmax())
        return (
            f"the time goes from {time[at - 1]:g} to {time[at]:g} s at sample {at + 1}; sort the "
            "samples by time, each once"
        )
    if error is not None:
        bad = np.isfinite(phase) & ~(np.isfinite(error) & (error >= 0))
        if bad.any():
            at = int(bad.argmax())
            return f"phase_error of sample {at + 1} is {error[at]:g}; give a number of 0 or more"
    return None


def _scale(path: Path, name: str, units: str | None) -> float:
    known = UNITS[name]
    if units is not None and units not in known:
        raise DatasetError(
            f"{path}: the unit of {name} is '{units}'; the known ones are {', '.join(known)}"
        )
    return float(known_units()[units or known[0]].size)


def _csv(path: Path) -> dict[str, Array]:
    lines = (line.split("#")[0] for line in path.read_text(encoding="utf-8-sig").splitlines())
    heading, *rows = list(csv.reader(line for line in lines if line.strip())) or [[]]
    found = [_HEADING.fullmatch(cell) for cell in heading]
    units = {match[1]: match[2] for match in found if match}
    places = {match[1]: place for place, match in enumerate(found) if match}
    return {
        name: _scale(path, name, units[name]) * _numbers(path, name, place, rows)
        for name, place in places.items()
        if name in UNITS
    }


def _numbers(path: Path, name: str, place: int, rows: Iterable[list[str]]) -> Array:
    numbers = []
    for number, row in enumerate(rows, start=1):
        cell = row[place].strip() if place < len(row) else ""
        try:
            numbers.append(float(cell) if cell else np.nan)
        except ValueError:
            raise DatasetError(
                f"{path}: {name} of sample {number} is '{cell}'; give a number, or leave it empty"
            ) from None
    return np.array(numbers, float)


def _netcdf(path: Path) -> dict[str, Array]:
    try:
        stored = xr.load_dataset(path, engine="netcdf4", decode_times=False, decode_timedelta=False)
    except ValueError as error:
        raise DatasetError(f"{path}: can't be read ({reason(error)}); give netCDF or CSV") from None
    return {
        name: _scale(path, name, stored[name].attrs.get("units"))
        * stored[name].values.astype(float)
        for name in UNITS
        if name in stored.variables
    }


def change_from_rest(series: Series, rest: int) -> PhaseChange:
    """Unwrap a series' phases, and subtract their mean over the first samples, where nothing moves.

    Missing samples stay missing, and are passed over when phases are unwrapped. Without a
    phase_error, the scatter of the samples at rest serves for all. The error of a change is that of
    the sample and of the mean at rest, together.

    Parameters
    ----------
    series : Series
    rest : int
        Samples at the start that are at rest.

    Raises
    ------
    DatasetError
        If too few of them have a phase, or a phase moves too far between samples to be unwrapped.
    """
    phase, there = series.phase.copy(), np.isfinite(series.phase)
    phase[there] = np.unwrap(series.phase[there])
    steps = np.abs(np.diff(phase[there]))
    if (steps > LARGEST_STEP).any():
        at = int(steps.argmax())
        raise DatasetError(
            f"series: the phase moves by {steps[at]:.3g} rad up to {series.time[there][at + 1]:g} s"
            f", which can't be unwrapped beyond {LARGEST_STEP:.3g}; sample faster"
        )
    still = phase[:rest][there[:rest]]
    needed = 1 if series.phase_error is not None else 3
    if still.size < needed or rest > phase.size:
        raise DatasetError(
            f"expansion.rest: of the first {rest} of {phase.size} samples {still.size} have a "
            f"phase, and {needed} are needed; give more samples at rest, or phase_error"
        )
    if series.phase_error is None:
        error = np.full_like(phase, still.std(ddof=1))
    else:
        error = series.phase_error
    at_rest = np.sqrt((error[:rest][there[:rest]] ** 2).sum()) / still.size
    return PhaseChange(phase - still.mean(), np.where(there, np.hypot(error, at_rest), np.nan))
