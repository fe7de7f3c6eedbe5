"""The error of a phase, by the samples at rest: what their scatter can say, and where it can't."""

from collections.abc import Sequence
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, stdtrit

from octsim.phase.measured_series import PhaseChange, Series, change_from_rest

Array = NDArray[np.float64]
_DECIMALS = 9
"""Of a radian, to which phases that differ by rounding alone are equal; no recorder is as fine."""

_WHOLE = 0.01
"""Distance from a whole number that counts as none."""


class ErrorStatus(IntEnum):
    """Where the error of a phase is from."""

    GIVEN = 0
    """The series' phase_error."""
    SCATTER = 1
    """The scatter at rest, by Student's t."""
    ROUNDING = 2
    """The recorder's smallest step, as the scatter at rest is less than its rounding."""
    UNKNOWN = 3
    """All samples at rest are equal, and no step of the recorder is seen."""


def smallest_step(phase: Array) -> float:
    """Return the smallest step of a recorder, rad, by the phases that it wrote.

    NaN where none is seen: if all phases are equal, or are not as many steps apart as a whole
    number.
    """
    apart = np.diff(np.unique(np.round(phase[np.isfinite(phase)], _DECIMALS)))
    step = apart.min(initial=np.inf)
    whole = np.abs(apart / step - np.round(apart / step)) < _WHOLE
    return float(step) if apart.size and whole.all() else np.nan


def student_factor(freedom: float, deviations: float = 1.0) -> float:
    """Return how many estimated standard deviations cover as often as some that are known exactly.

    Parameters
    ----------
    freedom : float
        Degrees of freedom of the estimate: in place of one deviation 1.32 for 2 of them, 1.03 for
        19, and 1 for infinitely many.
    deviations : float
        Standard deviations as they would be if known exactly.
    """
    return float(stdtrit(freedom, ndtr(deviations))) if np.isfinite(freedom) else deviations


def stated_change(
    series: Series,
    rest: int,
    drifts: bool = False,
    references: Sequence[tuple[int, int]] = (),
) -> tuple[PhaseChange, ErrorStatus]:
    r"""Return the change of a phase from rest, with an error that covers it as one sigma should.

    A scatter estimated from few samples at rest is often too small: its error is widened to the
    interval of Student's t that covers 68.3 %. A scatter below :math:`\\Delta/\\sqrt{12}`, the
    error of rounding to a recorder's steps Δ, says nothing: rounding is stated then, both of the
    sample and of the rest, whose samples are all rounded alike, so that no mean makes it smaller.

    Parameters
    ----------
    series, rest, drifts, references
        As those of `change_from_rest`.

    Returns
    -------
    PhaseChange
        Its error is NaN where it is not known.
    ErrorStatus

    Raises
    ------
    DatasetError
        If there is no sure rest; see `change_from_rest`.
    """
    change = change_from_rest(series, rest, drifts, references)
    if series.phase_error is not None:
        return change, ErrorStatus.GIVEN
    rounding = smallest_step(series.phase) / np.sqrt(12)
    if change.scatter > np.fmax(rounding, 10.0**-_DECIMALS):
        widened = student_factor(change.freedom) * change.error
        return change._replace(error=widened), ErrorStatus.SCATTER
    rounded = series._replace(phase_error=np.full_like(series.phase, rounding))
    error = np.hypot(change_from_rest(rounded, rest, drifts, references).error, rounding)
    status = ErrorStatus.UNKNOWN if np.isnan(rounding) else ErrorStatus.ROUNDING
    return change._replace(error=error), status
