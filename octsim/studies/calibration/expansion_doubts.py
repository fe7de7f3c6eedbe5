"""What is doubtful about a measured series and its expansion, in words."""

import json

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import DatasetError
from octsim.config.calibration import DIAMETER, ExpansionConfig
from octsim.phase.measured_series import Series
from octsim.phase.outliers import THRESHOLD, outliers
from octsim.phase.rest_error import ErrorStatus, stated_change, student_factor
from octsim.studies.responses.separability import MOST_GROWTH, Separability

Array = NDArray[np.float64]
_NAMED = 3
"""Outliers that are named; of more, the number."""
_APART = 5.0
"""How many times a phase_error is off the scatter at rest, from which it is asked about."""
_ENOUGH = 8
"""Samples whose scatter tells that."""
_MISFIT = 3.0
"""Of the phases' reduced chi-square, from which it is said."""
_SURE = 4.0
"""Standard deviations from which a drift at rest is said to be one."""


def measured_in(found: xr.Dataset) -> Series:
    """Return the series that an expansion records, as it was measured."""
    error = found.get("measured_phase_error")
    return Series(
        found["time"].values,
        found["measured_phase"].values,
        None if error is None else error.values,
    )


def outliers_in(found: xr.Dataset) -> NDArray[np.bool_]:
    """Mark the outliers of the series that an expansion records, (T,); of bands those of any."""
    marked = [outliers(measured_in(one)) for one in bands_in(found)]
    return np.asarray(np.any(marked, axis=0))


def bands_in(found: xr.Dataset) -> list[xr.Dataset]:
    """Return an expansion by the phase of each band, or the one that has no bands."""
    if "band" not in found.dims:
        return [found]
    slope = found["phase_response"].sel(quantity=DIAMETER)
    of_each = found.assign(fixed_focus_phase_slope=slope)
    return [of_each.isel(band=number) for number in range(found.sizes["band"])]


def named_samples(marked: NDArray[np.bool_], time: Array, change: Array | None = None) -> str:
    """Name the first of some samples by number (from 1), time and, where it is known, change."""
    places = np.flatnonzero(marked)
    said = [
        f"sample {at + 1} at {time[at]:.6g} s"
        + ("" if change is None or np.isnan(change[at]) else f" ({change[at]:+.3g} nm)")
        for at in places[:_NAMED]
    ]
    more = [f"{places.size - _NAMED} more"] if places.size > _NAMED else []
    return ", ".join([*said, *more])


def doubts(found: xr.Dataset) -> list[str]:
    """Say, a line each, what of an expansion may not be as it seems, and what to do.

    These are outliers, an error at rest that is only the recorder's rounding or not known at all,
    one that was given and is 0 or far from the scatter at rest, and a drift at rest that is not
    subtracted; of phases in bands those of each, and what can't be told apart.
    """
    if "band" in found.dims:
        each = [doubts(one) for one in bands_in(found)]
        named = [f"phase_{at + 1}: {line}" for at, lines in enumerate(each) for line in lines]
        return [*_alike(found), *named]
    said = []
    settings = ExpansionConfig.model_validate(json.loads(found.attrs["config"])["expansion"])
    series, change = measured_in(found), found["expansion"].values
    alone = outliers(series)
    if alone.any():
        remedy = (
            "left out, as expansion.outliers says"
            if settings.outliers == "drop"
            else "not taken for the largest change; expansion.outliers: drop leaves them out"
        )
        at_rest = int(alone[: settings.rest].sum())
        if at_rest and settings.outliers != "drop":
            remedy += f", and {at_rest} at rest move the level of all samples and widen the error"
        said.append(
            f"outliers, more than {THRESHOLD:g} standard deviations from their neighbours: "
            f"{named_samples(alone, series.time, change)}; {remedy}"
        )
    status = int(found["error_status"])
    if status == ErrorStatus.ROUNDING:
        said.append(
            f"the samples at rest scatter by {1e3 * float(found['rest_scatter']):.3g} mrad, less "
            f"than the recorder's smallest step of {1e3 * float(found['smallest_step']):.3g} mrad "
            "can show: statistical_error is that of rounding; record finer steps, or give "
            "phase_error"
        )
    if status == ErrorStatus.UNKNOWN:
        said.append(
            "the samples at rest all have one phase, and the recorder's steps are not seen: "
            "statistical_error is not known, and NaN; give phase_error, or samples that scatter"
        )
    if settings.outliers == "drop":
        series = series._replace(phase=np.where(alone, np.nan, series.phase))
    said += _given_errors(series, settings)
    if settings.drift == "none":
        said += _drifting(series, settings.rest, float(found["fixed_focus_phase_slope"]))
    return said


def _alike(found: xr.Dataset) -> list[str]:
    """Say which quantities the phases can't tell apart, and that they may be of something else."""
    said, status = [], found["separability"].values
    names = [str(name) for name in found["quantity"].values]
    lost = [name for name, code in zip(names, status, strict=True) if code]
    if lost:
        worst = Separability(int(status.max()))
        said.append(
            f"{', '.join(lost)} {worst.name.lower()}: responses are too alike in these bands, so "
            f"an error grows more than {MOST_GROWTH:g} times by what else is fitted; "
            f"{worst.remedy}"
        )
    misfit = float(found["reduced_chi_square"].mean())
    if misfit > _MISFIT:
        said.append(
            f"the phases are {misfit:.3g} times as far (as squares) from what {', '.join(names)} "
            "can do as their errors say; something else has changed too, or the errors are larger"
        )
    return said


def _given_errors(series: Series, settings: ExpansionConfig) -> list[str]:
    """Say that a phase_error is 0, or is not of the size of what the phases at rest scatter by."""
    if series.phase_error is None:
        return []
    there = np.isfinite(series.phase)
    error = series.phase_error[there]
    remedy = "or leave the column out to have the scatter at rest instead"
    if not error.all():
        share = "throughout" if not error.any() else f"at {(error == 0).sum()} of {error.size}"
        return [f"phase_error is 0 {share}, and is no error; give the phase's error, {remedy}"]
    rest = there[: settings.rest].sum()
    if rest < _ENOUGH:
        return []
    alone = series._replace(phase_error=None)
    drifts = settings.drift != "none"
    scatter = stated_change(alone, settings.rest, drifts, settings.references)[0].scatter
    stated = float(
        np.sqrt((series.phase_error[: settings.rest][there[: settings.rest]] ** 2).mean())
    )
    if stated / _APART <= scatter <= stated * _APART:
        return []
    return [
        f"the samples at rest scatter by {1e3 * scatter:.3g} mrad, where phase_error is "
        f"{1e3 * stated:.3g} mrad; see that its unit is right, {remedy}"
    ]


def _drifting(series: Series, rest: int, slope: float) -> list[str]:
    """Say that the samples at rest drift, if they surely do and it matters by the end."""
    try:
        level, line = (stated_change(series, rest, drifts)[0] for drifts in (False, True))
    except DatasetError:  # too few of them for a line
        return []
    end = np.flatnonzero(np.isfinite(series.phase))[-1]
    moved = level.phase[end] - line.phase[end]
    if not abs(moved) > student_factor(line.freedom, _SURE) * line.error[end]:
        return []
    return [
        f"the phase at rest drifts, by {1e3 * moved:+.3g} mrad ({1e3 * moved / slope:+.3g} nm) up "
        "to the end if it goes on so; expansion.drift: linear subtracts it, or name samples at "
        "rest at the end as well: {reference: [[first, last]]}"
    ]
