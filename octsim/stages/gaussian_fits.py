"""Where to focus: a Gaussian plus a constant, fitted over the focus of each diameter (figure 7)."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import leastsq

from octsim.config.following import fitted_diameters
from octsim.config.models import Config
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.stages.fit_errors import StandardErrorStatus, error_status

_FLAT = 1e-12
"""Of the intensity: a range below it is rounding."""
_TOLERANCE = 1e-15
"""Relative, of the least squares: the last digit, so that no answer hangs on where it started."""
_CLEAR = 4.0
"""Times the noise: what no edge is above the brightest focus by."""
_SHORT = 0.5
"""Of the step between foci: of a narrower peak one focus alone tells."""
_ALONE = 10.0
"""How many times less such a peak has to leave than one of which several foci tell."""
_FINER = 1.4
"""Each width that is tried over the one before."""
_CENTRES = 101
"""That are tried with each width, besides the foci where they are fewer."""


class FitStatus(IntEnum):
    """What became of a Gaussian fit."""

    FITTED = 0
    NO_INTERIOR_PEAK = 1
    """The intensity has no peak between the first and the last focus."""
    NOT_CONVERGED = 2
    """Least squares found no minimum."""
    NO_LIGHT = 3
    """There is no light at any focus."""


class GaussianFit(NamedTuple):
    """A Gaussian plus a constant, each with its standard error; NaN without a peak."""

    parameters: NDArray[np.float64]
    """Centre, width, amplitude, offset, (4,)."""
    standard_errors: NDArray[np.float64]
    """Of the four parameters, (4,); NaN where they are not known."""
    residual: float
    """Root mean square of what the fit leaves."""
    status: FitStatus

    @property
    def error_status(self) -> StandardErrorStatus:
        """Whether the standard errors are known."""
        return error_status(self.standard_errors, fitted=self.status == FitStatus.FITTED)


GAUSSIAN_PARAMETERS = ("centre", "width", "amplitude", "offset")
_NOTHING = np.full(len(GAUSSIAN_PARAMETERS), np.nan)


def gaussian(
    focus: NDArray[np.float64], centre: float, width: float, amplitude: float, offset: float
) -> NDArray[np.float64]:
    """Gaussian plus a constant, offset + amplitude · exp(−(z − centre)² / (2 width²))."""
    value: NDArray[np.float64] = offset + amplitude * np.exp(
        -((focus - centre) ** 2) / (2 * width**2)
    )
    return value


def fit_gaussian(focus: NDArray[np.float64], intensity: NDArray[np.float64]) -> GaussianFit:
    """Fit a Gaussian plus a constant by least squares.

    Of all minima with a peak between the foci it is the one that leaves least. One of which a
    single focus tells has to leave ten times less than the others. They are looked for from the
    best centre of each width that is better than those beside it, and from the brightest focus
    where none of these leads to a peak.

    There is no peak where the first or the last focus is the brightest. Where the brightest is
    above these two by less than four times the noise, there is none if the centre is less than its
    standard error from either.

    Parameters
    ----------
    focus, intensity : ndarray, shape (F,)
        Increasing foci and the intensity at each; those that are not finite are left out.

    Returns
    -------
    GaussianFit
        The fit, with a named status.
    """
    there = np.isfinite(intensity)
    focus, intensity = focus[there], intensity[there]
    if not (intensity > 0).any():
        return _failed(FitStatus.NO_LIGHT)
    # in units of the range and the peak, so that the tolerances mean something
    low, height = intensity.min(), np.ptp(intensity)
    flat = height <= _FLAT * intensity.max()
    if intensity.size < _NOTHING.size or flat or intensity.max() in intensity[[0, -1]]:
        return _failed(FitStatus.NO_INTERIOR_PEAK)
    reach = focus[-1] - focus[0]
    position, level = (focus - focus[0]) / reach, (intensity - low) / height
    found = _best(position, level)
    if isinstance(found, FitStatus):
        return _failed(found)
    scale = np.array([reach, reach, height, height])
    parameters = found[0] * scale + np.array([focus[0], 0.0, 0.0, low])
    residual = float(np.sqrt(np.mean((gaussian(focus, *parameters) - intensity) ** 2)))
    return GaussianFit(parameters, found[1] * scale, residual, FitStatus.FITTED)


def _failed(status: FitStatus) -> GaussianFit:
    return GaussianFit(_NOTHING, _NOTHING, np.nan, status)


class _Minimum(NamedTuple):
    """A minimum of the sum of squares, over the range and height of the intensity."""

    parameters: NDArray[np.float64]
    standard_errors: NDArray[np.float64]
    squares: float

    @property
    def width(self) -> float:
        return float(self.parameters[1])


def _best(position: NDArray[np.float64], level: NDArray[np.float64]) -> _Minimum | FitStatus:
    """Return the peak that leaves least, or why there is none."""
    widths = _widths(position.size)
    step = _SHORT / (position.size - 1)
    brightest, clear = position[level.argmax()], 1 - level[[0, -1]].max() > _CLEAR * _noise(level)
    for starts in (
        _starts(position, level, widths),
        [np.array([brightest, width, 1.0, 0.0]) for width in widths],
    ):
        minima = [one for one in (_minimum(s, position, level) for s in starts) if one is not None]
        peaks = [one for one in minima if _is_peak(one, clear=clear)]
        if peaks:
            return min(peaks, key=lambda one: one.squares * (_ALONE if one.width < step else 1))
    return FitStatus.NO_INTERIOR_PEAK if minima else FitStatus.NOT_CONVERGED


def _is_peak(minimum: _Minimum, *, clear: bool) -> bool:
    """Return whether a minimum has a peak between the ends, surely so where that is not clear."""
    centre, _, amplitude, _ = minimum.parameters
    error = 0.0 if clear else np.nan_to_num(minimum.standard_errors[0])
    return bool(amplitude > 0 and error < centre < 1 - error)


def _noise(level: NDArray[np.float64]) -> float:
    """Return the standard deviation of noise, by the median of what bends from focus to focus."""
    return float(1.4826 * np.median(np.abs(np.diff(level, 2))) / np.sqrt(6))


def _widths(num: int) -> NDArray[np.float64]:
    """Return the widths to try of `num` foci, from half a step to the whole range."""
    narrowest = _SHORT / (num - 1)
    return np.geomspace(narrowest, 1.0, 1 + int(np.ceil(np.log(1 / narrowest) / np.log(_FINER))))


def _starts(
    position: NDArray[np.float64], level: NDArray[np.float64], widths: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """Return where to start: the best centre of each width that is better than its neighbours.

    At a centre and width, amplitude and offset follow by linear least squares, and what they
    explain is (Σ g y)² / Σ g², with the Gaussian g and the level y less their means.
    """
    centres = np.linspace(0, 1, _CENTRES)
    if position.size < _CENTRES:
        centres = np.unique(np.append(centres, position))
    mean = level.mean()
    explained, starts = [0.0], []
    for width in widths:
        shape = np.exp(-((position - centres[:, np.newaxis]) ** 2) / (2 * width**2))
        shape_mean = shape.mean(axis=1, keepdims=True)
        along = ((shape - shape_mean) * (level - mean)).sum(axis=1)
        norm = ((shape - shape_mean) ** 2).sum(axis=1)
        tells = (along > 0) & (norm > 0)
        gain = np.where(tells, along**2 / np.where(tells, norm, 1.0), 0.0)
        at = gain.argmax()
        amplitude = along[at] / norm[at] if tells[at] else 0.0
        explained.append(gain[at])
        offset = mean - amplitude * shape_mean[at, 0]
        starts.append(np.array([centres[at], width, amplitude, offset]))
    ends = np.array([*explained, 0.0])
    best = (ends[1:-1] > ends[:-2]) & (ends[1:-1] >= ends[2:])
    return [starts[place] for place in np.flatnonzero(best)]


def _minimum(
    start: NDArray[np.float64], position: NDArray[np.float64], level: NDArray[np.float64]
) -> _Minimum | None:
    """Follow the sum of squares to a minimum by Levenberg and Marquardt's way."""

    def left(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        return gaussian(position, *parameters) - level

    def gradient(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        centre, width, amplitude, _ = parameters
        off = (position - centre) / width
        shape = np.exp(-(off**2) / 2)
        slope = amplitude * shape * off / width
        return np.stack([slope, slope * off, shape, np.ones_like(shape)])

    with np.errstate(all="ignore"):  # a start that leads nowhere is left out below
        parameters, covariance, _, _, status = leastsq(
            left, start, Dfun=gradient, col_deriv=True, full_output=True, gtol=0.0,
            ftol=_TOLERANCE, xtol=_TOLERANCE, maxfev=10_000,
        )  # fmt: skip
        squares = float(np.sum(left(parameters) ** 2))
        freedom = position.size - _NOTHING.size
        errors = _NOTHING
        if covariance is not None and freedom > 0:
            errors = np.sqrt(np.diag(covariance) * squares / freedom)
        if not errors[0] < 1:
            errors = _NOTHING
    if status == 5 or not np.isfinite([*parameters, squares]).all():  # 5: still on its way
        return None
    parameters[1] = abs(parameters[1])
    return _Minimum(parameters, errors, squares)


@Streamed
def gaussian_fits(config: Config, sweep: xr.Dataset) -> Stream:
    """Fit a Gaussian plus a constant over the foci of each diameter.

    Returns
    -------
    Dataset
        centre, width, amplitude, offset, their standard errors, residual, that over the range of
        the intensity, status, that of the standard errors, and the brightest of the foci
        (diameter).

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "tracing": {"rays": 200},
    ...         "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
    ...     }
    ... )
    >>> fits = octsim.gaussian_fits(config, octsim.focus_sweep(config))
    >>> fits["centre"].round(1).values.tolist()
    [0.5, 1.0, 1.7]
    """
    title = "Gaussian plus a constant, fitted to the intensity over the focus"
    layout = Layout("gaussian_fits", config, title, law_diameters)
    stored = Stored(sweep, "focus_sweep", config, layout)
    return Stream(
        layout,
        (Part(at, 0, 1, fitted(stored.part(at))) for at in layout.combinations),
    )


def law_diameters(config: Config) -> dict[str, Coordinate]:
    """Return the coordinates of a dataset over the focus law's diameters."""
    return {"diameter": ("diameter", fitted_diameters(config).values())}


def fitted(sweep: xr.Dataset) -> dict[str, object]:
    """Return the variables of the fits to one combination's intensities over the focus."""
    fits = [
        fit_gaussian(focus, intensity)
        for focus, intensity in zip(sweep["focus"].values, sweep["intensity"].values, strict=True)
    ]
    variables: dict[str, object] = {}
    for p, name in enumerate(GAUSSIAN_PARAMETERS):
        variables[name] = ("diameter", [fit.parameters[p] for fit in fits])
        error_name = f"{name}_standard_error"
        variables[error_name] = ("diameter", [fit.standard_errors[p] for fit in fits])
    residual = np.array([fit.residual for fit in fits])
    variables["residual"] = ("diameter", residual)
    intensity, focus = sweep["intensity"].values, sweep["focus"].values
    with np.errstate(invalid="ignore"):  # where nothing is fitted there may be no range
        variables["relative_residual"] = ("diameter", residual / np.ptp(intensity, axis=1))
    variables["brightest_focus"] = ("diameter", _brightest(focus, intensity))
    variables["status"] = ("diameter", *flags(FitStatus, np.array([fit.status for fit in fits])))
    errors = np.array([fit.error_status for fit in fits])
    variables["standard_error_status"] = ("diameter", *flags(StandardErrorStatus, errors))
    return variables


def _brightest(focus: NDArray[np.float64], intensity: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the brightest focus (D,) of intensities (D, F); NaN where none is."""
    light = np.where(intensity > 0, intensity, 0.0)
    differs = light.max(axis=1) > (1 + _FLAT) * light.min(axis=1)
    return np.where(differs, focus[np.arange(len(light)), light.argmax(axis=1)], np.nan)
