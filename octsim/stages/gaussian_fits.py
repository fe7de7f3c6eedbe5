"""Where to focus: a Gaussian plus a constant, fitted over the focus of each diameter (figure 7)."""

import warnings
from enum import IntEnum
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import OptimizeWarning, curve_fit

from octsim.config.models import Config
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream, Streamed


class FitStatus(IntEnum):
    """What became of a Gaussian fit."""

    FITTED = 0
    NO_INTERIOR_PEAK = 1
    """The intensity has no peak between the first and the last focus."""
    NOT_CONVERGED = 2
    """Least squares found no minimum."""


class GaussianFit(NamedTuple):
    """A Gaussian plus a constant, each with its standard error; NaN without a peak."""

    parameters: NDArray[np.float64]
    """Centre, width, amplitude, offset, (4,)."""
    standard_errors: NDArray[np.float64]
    """Of the four parameters, (4,); NaN where no degree of freedom is left."""
    residual: float
    """Root mean square of what the fit leaves."""
    status: FitStatus


GAUSSIAN_PARAMETERS = ("centre", "width", "amplitude", "offset")


def gaussian(
    focus: NDArray[np.float64], centre: float, width: float, amplitude: float, offset: float
) -> NDArray[np.float64]:
    """Gaussian plus a constant, offset + amplitude · exp(−(z − centre)² / (2 width²))."""
    value: NDArray[np.float64] = offset + amplitude * np.exp(
        -((focus - centre) ** 2) / (2 * width**2)
    )
    return value


def interior_peaks(level: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the positions, not the first or the last, whose value is above its neighbours'."""
    inner = level[1:-1]
    return 1 + np.flatnonzero((inner > level[:-2]) & (inner >= level[2:]))


def fit_gaussian(focus: NDArray[np.float64], intensity: NDArray[np.float64]) -> GaussianFit:
    """Fit a Gaussian plus a constant by least squares.

    Parameters
    ----------
    focus, intensity : ndarray, shape (F,)
        Increasing foci and the intensity at each; at least four.

    Returns
    -------
    GaussianFit
        The fit, with a named status.
    """
    nothing = np.full(4, np.nan)
    # in units of the range and the peak, so that the tolerances mean something
    reach = focus[-1] - focus[0]
    low, height = intensity.min(), np.ptp(intensity)
    peaks = interior_peaks(intensity)
    if peaks.size == 0:
        return GaussianFit(nothing, nothing, np.nan, FitStatus.NO_INTERIOR_PEAK)
    position, level = (focus - focus[0]) / reach, (intensity - low) / height
    start = [position[peaks[level[peaks].argmax()]], 0.25, 1.0, 0.0]
    tolerance = 1e-12
    try:
        with np.errstate(over="ignore", under="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore", OptimizeWarning)  # a covariance may be out of reach
            fitted, covariance = curve_fit(
                gaussian, position, level, start,
                method="lm", ftol=tolerance, xtol=tolerance, gtol=0.0, maxfev=10_000,
            )  # fmt: skip
    except RuntimeError:
        return GaussianFit(nothing, nothing, np.nan, FitStatus.NOT_CONVERGED)
    if not (0 < fitted[0] < 1 and fitted[2] > 0):
        return GaussianFit(nothing, nothing, np.nan, FitStatus.NO_INTERIOR_PEAK)
    scale = np.array([reach, reach, height, height])
    parameters = fitted * scale + np.array([focus[0], 0.0, 0.0, low])
    parameters[1] = abs(parameters[1])
    standard_errors = np.sqrt(np.diag(covariance)) * scale
    standard_errors[np.isinf(standard_errors)] = np.nan
    residual = float(np.sqrt(np.mean((gaussian(focus, *parameters) - intensity) ** 2)))
    return GaussianFit(parameters, standard_errors, residual, FitStatus.FITTED)


@Streamed
def gaussian_fits(config: Config, sweep: xr.Dataset) -> Stream:
    """Fit a Gaussian plus a constant over the foci of each diameter.

    Returns
    -------
    Dataset
        centre, width, amplitude, offset, their standard errors, residual and status (diameter).
    """
    title = "Gaussian plus a constant, fitted to the intensity over the focus"
    layout = Layout("gaussian_fits", config, title, law_diameters)
    stored = Stored(sweep, "focus_sweep", config, layout)
    return Stream(
        layout,
        (Part(at, 0, 1, _fitted(stored.part(at))) for at in layout.combinations),
    )


def law_diameters(config: Config) -> dict[str, Coordinate]:
    """Return the coordinates of a dataset over the focus law's diameters."""
    return {"diameter": ("diameter", config.focus_law.diameters.values())}


def _fitted(sweep: xr.Dataset) -> dict[str, object]:
    fits = [
        fit_gaussian(focus, intensity)
        for focus, intensity in zip(sweep["focus"].values, sweep["intensity"].values, strict=True)
    ]
    variables: dict[str, object] = {}
    for p, name in enumerate(GAUSSIAN_PARAMETERS):
        variables[name] = ("diameter", [fit.parameters[p] for fit in fits])
        error_name = f"{name}_standard_error"
        variables[error_name] = ("diameter", [fit.standard_errors[p] for fit in fits])
    variables["residual"] = ("diameter", [fit.residual for fit in fits])
    variables["status"] = ("diameter", *flags(FitStatus, np.array([fit.status for fit in fits])))
    return variables
