"""From a measured phase to nanometres (`snakemake expansion`)."""

import warnings

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from octsim.base.errors import ConfigError, DatasetError, OctsimError, OctsimWarning
from octsim.config.calibration import DIAMETER
from octsim.config.models import Config
from octsim.datasets.files import flags, flags_of_missing, make
from octsim.measured.phases import series_of
from octsim.phase.measured_bands import read_series_of_bands
from octsim.phase.measured_series import Series, read_series
from octsim.phase.outliers import Standing, outliers
from octsim.phase.rest_error import ErrorStatus, smallest_step, stated_change
from octsim.studies.calibration.expansion_doubts import doubts as doubts
from octsim.studies.calibration.expansion_doubts import named_samples, outliers_in
from octsim.studies.calibration.expansion_fit import series_fit
from octsim.studies.calibration.missing import SystematicStatus, series_statuses
from octsim.studies.calibration.sensitivity import Expansion, matched, sensitivity_at, solved


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
    A phase that moved by 11 mrad:

    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "sweep": {"focus": {"slope": 0.58, "intercept": "66 nm"}},
    ...         "calibration": {
    ...             "diameters": {"start": "1.35 um", "stop": "1.45 um", "num": 8},
    ...             "scheme": "paths",
    ...         },
    ...     }
    ... )
    >>> calibration = octsim.calibration(config)
    >>> found = octsim.expansion(0.011, 1.4, calibration)  # 11 mrad
    >>> print(f"{found.expansion:.2f} nm")
    0.46 nm
    """
    return solved(phase, sensitivity_at(diameter, calibration), diameter, phase_error)


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
    match: xr.Dataset | None = None,
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
        return _of_spectra(config, calibration, measured, match)
    file = _file_of(config)  # without one nothing else is there
    if config.expansion.several and responses is not None:
        series = read_series_of_bands(file, len(config.expansion.bands))
        return series_fit(config, series, responses)
    if calibration is None or config.expansion.several:
        lacking = "responses" if config.expansion.several else "calibration"
        raise OctsimError(f"{lacking}: not given; expansion.fit and bands ask for it")
    return series_expansion(config, read_series(file), calibration)


def _of_spectra(
    config: Config,
    calibration: xr.Dataset | None,
    measured: xr.Dataset,
    match: xr.Dataset | None,
) -> xr.Dataset:
    """Return the expansions of measured spectra."""
    if config.expansion.several or calibration is None:
        raise ConfigError(
            "expansion.fit: more than the diameter, or bands given, but measured spectra have one "
            "phase each; leave expansion.bands out and fit: [diameter]"
        )
    series = series_of(measured, config.measured.average)
    chain_error = float(measured["chain_error"])
    return series_expansion(config, series, calibration, chain_error, match)


def series_expansion(
    config: Config,
    series: Series,
    calibration: xr.Dataset,
    chain_error: float = 0.0,
    match: xr.Dataset | None = None,
) -> xr.Dataset:
    r"""Return the expansions of a series of phases.

    Parameters
    ----------
    config : Config
    series : Series
    calibration : Dataset
    chain_error : float
        Relative error of changes of the phase by what was done before, as a source's spectrum.
    match : Dataset, optional
        Of this stage: the slope is that of the neuron which fits the spectra best.

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

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "expansion": {"diameter": "1.4 um", "rest": 4},
    ...         "sweep": {"focus": {"slope": 0.58, "intercept": "66 nm"}},
    ...         "calibration": {
    ...             "diameters": {"start": "1.35 um", "stop": "1.45 um", "num": 8},
    ...             "scheme": "paths",
    ...         },
    ...     }
    ... )
    >>> calibration = octsim.calibration(config)
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "phases.csv")
    ...     rows = "\n".join(f"{n},{p}" for n, p in enumerate([0, 1, -1, 0, 11, 5]))
    ...     _ = file.write_text("time (ms),phase (mrad)\n" + rows)
    ...     series = octsim.read_series(file)
    >>> octsim.series_expansion(config, series, calibration)["expansion"].round(1).values.tolist()
    [0.0, 0.0, -0.0, 0.0, 0.5, 0.2]
    """
    settings, alone = config.expansion, outliers(series)
    dropped = alone if settings.outliers == "drop" else np.zeros_like(alone)
    at = sensitivity_at(settings.diameter, calibration)
    if match is not None:
        at = matched(at, match)
    kept = series._replace(phase=np.where(dropped, np.nan, series.phase))
    try:
        change, status = stated_change(
            kept, settings.rest, settings.drift != "none", settings.references
        )
        found = solved(change.phase, at, settings.diameter, change.error)
    except OctsimError as error:
        if not (alone & ~dropped).any():
            raise
        raise DatasetError(
            f"{error}; {named_samples(alone, series.time)} stand out from their neighbours: "
            "expansion.outliers: drop leaves them out"
        ) from None
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
    step = smallest_step(series.phase)
    statuses = series_statuses(("time",), series.phase, dropped, change.scatter, step)
    unsure = flags_of_missing(at.standard_error, SystematicStatus.NOT_KNOWN)
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
            "smallest_step": step,
            "drift": change.drift,
            **statuses,
            "systematic_status": ((), *unsure),
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
