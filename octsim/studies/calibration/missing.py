"""Why numbers of an expansion are missing."""

from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from octsim.datasets.files import flags, flags_of_missing
from octsim.phase.derivatives import Array


class SampleStatus(IntEnum):
    """Whether a sample of a series is used."""

    USED = 0
    MISSING = 1
    """It has no phase."""
    LEFT_OUT = 2
    """It stands alone, far from its neighbours, and expansion.outliers is drop."""


class ScatterStatus(IntEnum):
    """Whether the scatter of a phase at rest is looked at."""

    KNOWN = 0
    NOT_NEEDED = 1
    """The phase's error is given."""


class StepStatus(IntEnum):
    """Whether a recorder's smallest step is seen."""

    KNOWN = 0
    NOT_SEEN = 1
    """All phases are equal, or not as many steps apart as a whole number."""


class SystematicStatus(IntEnum):
    """Whether the error of the slope, or of responses, is known."""

    KNOWN = 0
    NOT_KNOWN = 1
    """It is not in the dataset that they are of, whose statuses say why."""


class MisfitStatus(IntEnum):
    """Whether it is known how far phases are from what fits them best."""

    KNOWN = 0
    MISSING = 1
    """A phase is."""
    NO_FREEDOM = 2
    """There are as many quantities as phases, or the phases' errors are not known."""


def series_statuses(
    over: tuple[str, ...], phase: Array, dropped: NDArray[np.bool_], scatter: ArrayLike,
    step: ArrayLike,
) -> dict[str, Any]:  # fmt: skip
    """Return why numbers of measured series are missing, as variables.

    Parameters
    ----------
    over : tuple of str
        Dimensions of the phases: time, and maybe band.
    phase : ndarray
        As they were measured.
    dropped : ndarray of bool
        Those that are left out as outliers.
    scatter, step : array_like
        Scatter at rest and smallest step, of one series or of each band's.
    """
    samples = np.select(
        [np.isnan(phase), dropped], [SampleStatus.MISSING, SampleStatus.LEFT_OUT], SampleStatus.USED
    )
    return {
        "sample_status": (over, *flags(SampleStatus, samples)),
        "rest_scatter_status": (
            over[1:], *flags_of_missing(scatter, ScatterStatus.NOT_NEEDED),
        ),
        "smallest_step_status": (over[1:], *flags_of_missing(step, StepStatus.NOT_SEEN)),
    }  # fmt: skip


def misfit_status(misfit: Array, change: Array) -> NDArray[np.int64]:
    """Return the `MisfitStatus` of misfits (T,) of phases that changes (T, Q) are fitted to."""
    return np.select(
        [~np.isnan(misfit), np.isnan(change).any(axis=1)],
        [MisfitStatus.KNOWN, MisfitStatus.MISSING],
        MisfitStatus.NO_FREEDOM,
    )
