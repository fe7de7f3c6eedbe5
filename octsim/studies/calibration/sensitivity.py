"""How a phase turns with the diameter at a fixed focus, and changes of the diameter by that."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from octsim.base.errors import DatasetError, OctsimError

Array = NDArray[np.float64]
MISFIT = 0.05
"""Residual of the best fit over a spectrum, root mean squares, from which it is no match."""
LARGEST = 20.0
"""Change of the diameter, nm, up to which a slope and its curvature serve."""


class Sensitivity(NamedTuple):
    """A calibration at one diameter."""

    slope: float
    """At a fixed focus and gap, mrad/nm."""
    standard_error: float
    """Of the slope, systematic, mrad/nm."""
    curvature: float
    """Change of the slope with the diameter, mrad/nm²."""


class Expansion(NamedTuple):
    """A change of the diameter with its standard errors, nm, each of the phase's shape."""

    expansion: Array
    statistical_error: Array
    """By the error of the phase."""
    systematic_error: Array
    """By the error of the slope: the same fraction of every expansion."""

    @property
    def standard_error(self) -> Array:
        """Both together, nm."""
        both: Array = np.hypot(self.statistical_error, self.systematic_error)
        return both


def sensitivity_at(diameter: float, calibration: xr.Dataset) -> Sensitivity:
    """Return a calibration interpolated at a diameter (µm): by cubic splines, its error by lines.

    An error that is not known at one of the diameters beside is NaN.

    Raises
    ------
    OctsimError
        If the diameter is outside the calibration's.
    """
    known = calibration["diameter"].values
    if not known[0] <= diameter <= known[-1]:
        raise OctsimError(
            f"diameter: {diameter:g} um given, outside the calibration's {known[0]:g} to "
            f"{known[-1]:g} um; widen calibration.diameters and run the stage calibration again"
        )
    slope, curvature = (
        float(CubicSpline(known, calibration[name].values)(diameter))
        for name in ("fixed_focus_phase_slope", "phase_curvature")
    )
    error = calibration["fixed_focus_phase_slope_standard_error"].values
    return Sensitivity(slope, float(np.interp(diameter, known, error)), curvature)


def matched(at: Sensitivity, match: xr.Dataset) -> Sensitivity:
    """Return a sensitivity with the slope of the neuron that fits measured spectra best.

    Raises
    ------
    DatasetError
        If none does.
    """
    misfit = float(match["misfit"])
    if misfit > MISFIT:
        raise DatasetError(
            f"expansion.slope: match given, but the best fit leaves {misfit:.0%} of the spectrum, "
            "so it is no match; see match.nc, or give calibration"
        )
    return at._replace(
        slope=float(match["matched_phase_slope"]),
        standard_error=float(match["matched_phase_slope_standard_error"]),
    )


def solved(phase: ArrayLike, at: Sensitivity, diameter: float, phase_error: ArrayLike) -> Expansion:
    """Return the changes of the diameter by a sensitivity; see `expansion`."""
    moved = 1e3 * np.asarray(phase, float)  # mrad
    # the slope where the phase ends; without a root the neuron would have to shrink beyond the turn
    end = np.sqrt(np.maximum(at.slope**2 + 2 * at.curvature * moved, 0.0))
    change = 2 * moved / (at.slope + end)
    if (np.abs(change) > LARGEST).any():
        largest = float(np.nanmax(np.abs(moved)))
        raise OctsimError(
            f"phase: a change of {largest:.4g} mrad given, more than the {LARGEST:g} nm that the "
            f"calibration holds for at {diameter:g} um; take the diameter and the rest nearer to it"
        )
    statistical = np.abs(1e3 * np.asarray(phase_error, float) / end)
    systematic = np.abs(change) * at.standard_error / end
    return Expansion(change, np.broadcast_to(statistical, change.shape), systematic)
