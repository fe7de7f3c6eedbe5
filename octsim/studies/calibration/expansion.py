"""From a measured phase to nanometres (`snakemake expansion`)."""

import warnings
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from octsim.base.errors import ConfigError, DatasetError, OctsimError, OctsimWarning
from octsim.config.calibration import DIAMETER
from octsim.config.models import Config
from octsim.datasets.files import flags, make
from octsim.measured.phases import series_of
from octsim.phase.measured_bands import read_series_of_bands
from octsim.phase.measured_series import Series, read_series
from octsim.phase.outliers import Standing, outliers
from octsim.phase.rest_error import ErrorStatus, smallest_step, stated_change
from octsim.studies.calibration.expansion_doubts import doubts as doubts
from octsim.studies.calibration.expansion_doubts import named_samples, outliers_in
from octsim.studies.calibration.expansion_fit import series_fit

Array = NDArray[np.float64]
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


def expansion(
    phase: ArrayLike, diameter: float, calibration: xr.Dataset, phase_error: ArrayLike = 0.0
) -> Expansion:
    r"""Return the changes of the diameter that changes of the phase are of.

    The phase of a neuron that swells by δ at a fixed focus moves by

    .. math:: \varphi = s \delta + c \delta^2 / 2,

    which is solved for δ.

    Parameters
    ----------
    phase : array_like
        Changes of the phase from rest, rad, unwrapped; NaN gives NaN.
    diameter : float
        Of the neuron at rest, µm.
    calibration : Dataset
        Of the stage calibration, made with the estimator that the phases are from.
    phase_error : array_like
        One standard deviation of each change, rad.

    Returns
    -------
    Expansion
        In nm, of the phase's shape.

    Raises
    ------
    OctsimError
        If the diameter is outside the calibration's, or a change is too large for it.

    Examples
    --------
    A phase that moved by 11 mrad: ``octsim.expansion(0.011, 1.4, calibration)``.
    """
    at = sensitivity_at(diameter, calibration)
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


def _file_of(config: Config) -> str:
    """Return the file of the series that a config names; refuse a config that names none."""
    if config.expansion.series is None:
        raise ConfigError(
            "expansion.series: not given; name the CSV or netCDF file that holds time and phase, "
            "or give measured.spectra"
        )
    return config.expansion.series


def expansion_of_series(
    config: Config,
    calibration: xr.Dataset | None,
    responses: xr.Dataset | None = None,
    measured: xr.Dataset | None = None,
) -> xr.Dataset:
    """Return the expansions of the series that a config names.

    By a calibration, see `series_expansion`; where phases are of several bands, or more than the
    diameter is fitted, by responses: see `octsim.studies.calibration.expansion_fit.series_fit`.
    Phases are those of the file that ``expansion.series`` names, or of measured spectra.

    Raises
    ------
    OctsimError
        If there is no such series, or the series or the diameter does not serve.
    """
    if measured is not None and config.expansion.series is None:
        return _of_spectra(config, calibration, measured)
    file = _file_of(config)  # without one nothing else is there
    if config.expansion.several and responses is not None:
        series = read_series_of_bands(file, len(config.expansion.bands))
        return series_fit(config, series, responses)
    if calibration is None or config.expansion.several:
        lacking = "responses" if config.expansion.several else "calibration"
        raise OctsimError(f"{lacking}: not given; expansion.fit and bands ask for it")
    return series_expansion(config, read_series(file), calibration)


def _of_spectra(config: Config, calibration: xr.Dataset | None, measured: xr.Dataset) -> xr.Dataset:
    """Return the expansions of measured spectra."""
    if config.expansion.several or calibration is None:
        raise ConfigError(
            "expansion.fit: more than the diameter, or bands given, but measured spectra have one "
            "phase each; leave expansion.bands out and fit: [diameter]"
        )
    series = series_of(measured, config.measured.average)
    return series_expansion(config, series, calibration, float(measured["chain_error"]))


def series_expansion(
    config: Config, series: Series, calibration: xr.Dataset, chain_error: float = 0.0
) -> xr.Dataset:
    """Return the expansions of a series of phases.

    Parameters
    ----------
    config : Config
    series : Series
    calibration : Dataset
    chain_error : float
        Relative error of changes of the phase by what was done before, as a source's spectrum.

    Returns
    -------
    Dataset
        phase_change, expansion, statistical_error and systematic_error (time); the diameter, the
        slope with its systematic error and the number of missing samples; where the statistical
        error is from (error_status, rest_scatter, smallest_step), and the drift that was
        subtracted; the series itself, as it was measured: measured_phase and, where it is known,
        measured_phase_error (time); and, unless ``expansion.outliers`` is off, outlier (time).

    Raises
    ------
    OctsimError
        If the series or the diameter does not serve; see `stated_change` and `expansion`.

    Warns
    -----
    OctsimWarning
        Of each thing that the numbers may not be worth: see `doubts`.
    """
    settings, alone = config.expansion, outliers(series)
    dropped = alone if settings.outliers == "drop" else np.zeros_like(alone)
    kept = series._replace(phase=np.where(dropped, np.nan, series.phase))
    try:
        change, status = stated_change(
            kept, settings.rest, settings.drift != "none", settings.references
        )
        found = expansion(change.phase, settings.diameter, calibration, change.error)
    except OctsimError as error:
        if not (alone & ~dropped).any():
            raise
        raise DatasetError(
            f"{error}; {named_samples(alone, series.time)} stand out from their neighbours: "
            "expansion.outliers: drop leaves them out"
        ) from None
    at = sensitivity_at(settings.diameter, calibration)
    systematic = np.hypot(found.systematic_error, chain_error * np.abs(found.expansion))
    missing = np.where(np.isfinite(change.phase), 0.0, np.nan)
    measured = {"measured_phase": ("time", series.phase)}
    if series.phase_error is not None:
        measured["measured_phase_error"] = ("time", series.phase_error)
    marked = (
        {}
        if settings.outliers == "off"
        else {"outlier": ("time", *flags(Standing, alone.astype(int)))}
    )
    made = make(
        "expansion",
        config,
        "Change of the diameter over time, from a measured phase",
        {
            "phase_change": ("time", change.phase),
            "expansion": ("time", found.expansion),
            "statistical_error": ("time", found.statistical_error),
            "systematic_error": ("time", systematic + missing),
            "diameter": settings.diameter,
            "fixed_focus_phase_slope": at.slope,
            "fixed_focus_phase_slope_standard_error": at.standard_error,
            "samples_missing": int(np.isnan(change.phase).sum()),
            "error_status": ((), *flags(ErrorStatus, np.array(status))),
            "rest_scatter": change.scatter,
            "smallest_step": smallest_step(series.phase),
            "drift": change.drift,
            **measured,
            **marked,
        },
        {"time": series.time},
    )
    for doubt in doubts(made):
        warnings.warn(doubt, OctsimWarning, stacklevel=2)
    return made


def summary(found: xr.Dataset) -> str:
    """Return what a series comes to, in one line; an outlier is never its largest change."""
    alone = outliers_in(found)
    sizes = np.where(alone, np.nan, np.abs(found["expansion"].values))
    one = found.isel(time=int(np.nanargmax(sizes)))
    statistical, systematic = (
        "unknown" if np.isnan(error) else f"{error:.4f}"
        for error in (float(one[f"{name}_error"]) for name in ("statistical", "systematic"))
    )
    besides = f", {alone.sum()} outliers not counted" if alone.any() else ""
    if "quantity" in found.dims:
        others = [
            f"{name} {float(one['change'].sel(quantity=name)):+.4f} {unit}"
            for name, unit in zip(one["quantity"].values, one["quantity_unit"].values, strict=True)
            if name != DIAMETER
        ]
        besides += f", with {', '.join(others)}" if others else ""
    return (
        f"largest change {float(one['expansion']):+.4f} nm at {float(one['time']):.6g} s, ± "
        f"{statistical} (statistical) ± {systematic} (systematic){besides}; "
        f"{int(found['samples_missing'])} of {sizes.size} samples missing"
    )
