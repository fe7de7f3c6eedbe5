"""What a lab can look at to find its focus, and where that is greatest."""

from collections.abc import Mapping
from enum import IntEnum
from typing import NamedTuple

import numpy as np
import xarray as xr

from octsim.phase.derivatives import Array

CRITERIA: Mapping[str, str] = {
    "intensity": "mean intensity over the band",
    "visibility": "visibility of the fringe of the neuron's far side",
    "depth_peak": "height of that fringe's peak in the depth profile",
}
"""Each by its name, and what it is."""


class CriterionStatus(IntEnum):
    """Whether a criterion has a peak over the focus."""

    KNOWN = 0
    AT_THE_END = 1
    """It is greatest at the first or the last focus."""
    NO_FRINGE = 2
    """It has no value at some focus, as the spectrum has no fringe there."""


class Peak(NamedTuple):
    """The greatest value over the focus."""

    at: float
    """µm; NaN without a peak."""
    prominence: float
    """By how much it is above the higher end of the scan, over it; 0 without a peak."""
    status: CriterionStatus = CriterionStatus.KNOWN


def peak(foci: Array, values: Array) -> Peak:
    """Return the greatest of values (F,) at even foci (F,), by a parabola through three."""
    if np.isnan(values).any():
        return Peak(np.nan, 0.0, CriterionStatus.NO_FRINGE)
    place = int(values.argmax())
    if place in (0, values.size - 1):
        return Peak(np.nan, 0.0, CriterionStatus.AT_THE_END)
    left, top, right = values[place - 1 : place + 2]
    shift = 0.5 * (left - right) / (left - 2 * top + right)
    ends = max(values[0], values[-1])
    at = foci[place] + shift * (foci[1] - foci[0])
    return Peak(float(at), float((top - ends) / top))


def peaks(seen: xr.Dataset) -> dict[str, xr.DataArray]:
    """Return where each criterion is greatest over the focus, and how well what is there is known.

    Parameters
    ----------
    seen : Dataset
        brightness, fringe_visibility, depth_peak and total_error, along
        focus_offset.

    Returns
    -------
    dict
        criterion_offset and criterion_prominence, along criterion in the place of focus_offset;
        criterion_error, total_error at that focus, between those that were tried; and the
        `CriterionStatus` of both.
    """
    foci = seen["focus_offset"].values
    scans = {
        "intensity": seen["brightness"],
        "visibility": seen["fringe_visibility"],
        "depth_peak": seen["depth_peak"],
    }
    found = [
        xr.apply_ufunc(
            lambda values: peak(foci, values), scans[name], input_core_dims=[["focus_offset"]],
            output_core_dims=[[], [], []], vectorize=True,
        )
        for name in CRITERIA
    ]  # fmt: skip
    names = xr.Variable("criterion", list(CRITERIA))
    offset = xr.concat([at for at, _, _ in found], names)
    error = xr.apply_ufunc(
        lambda at, values: np.interp(at, foci, values), offset, seen["total_error"],
        input_core_dims=[[], ["focus_offset"]], vectorize=True,
    )  # fmt: skip
    status = xr.concat([status for *_, status in found], names)
    # where there is a peak, an estimator has no error beside it
    missing = status.where(offset.isnull(), int(CriterionStatus.NO_FRINGE))
    error_status = missing.where(error.isnull(), int(CriterionStatus.KNOWN))
    return {
        "criterion_offset": offset,
        "criterion_prominence": xr.concat([high for _, high, _ in found], names),
        "criterion_status": status,
        "criterion_error": error,
        "criterion_error_status": error_status,
    }
