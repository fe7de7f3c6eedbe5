"""From measured spectra's phases to a series that moves: what is left out, and what is averaged."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import DatasetError
from octsim.phase.fringe_status import WITH_PHASE, FringeStatus
from octsim.phase.measured_series import Series

Array = NDArray[np.float64]
_LEFT_OUT = FringeStatus.SATURATED


def series_of(found: xr.Dataset, average: int = 1) -> Series:
    """Return the phases of `measured.nc` as a series.

    Spectra without a phase, and those with samples at full scale, are missing samples. Of some that
    are averaged, one after the other, the phase is that of their mean phasor, with the time of
    their middle; what is left over at the end is not used.

    Parameters
    ----------
    found : Dataset
        Of the stage measured.
    average : int
        Spectra to a sample.

    Raises
    ------
    DatasetError
        If there are fewer spectra than that.
    """
    status = found["spectrum_status"].values
    whole = np.isin(status, WITH_PHASE) & (status != _LEFT_OUT)
    time, phase, error = (
        np.asarray(found[name].values, float)
        for name in ("time", "fringe_phase", "fringe_phase_error")
    )
    phase, error = np.where(whole, phase, np.nan), np.where(whole, error, np.nan)
    if average == 1:
        return Series(time, phase, error)
    samples = time.size // average
    if samples == 0:
        raise DatasetError(
            f"measured.average: {average} given, but there are {time.size} spectra; give fewer"
        )
    time, phase, error = (
        one[: samples * average].reshape(samples, average) for one in (time, phase, error)
    )
    count = np.isfinite(phase).sum(axis=1)
    phasor = np.nansum(np.exp(1j * phase), axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        spread = np.sqrt(np.nansum(error**2, axis=1)) / count
    mean = np.where(count > 0, np.angle(phasor), np.nan)
    return Series(time.mean(axis=1), mean, np.where(count > 0, spread, np.nan))
