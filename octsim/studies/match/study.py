"""A lab's spectrum beside the model's, and the model that fits it (`snakemake match`)."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import ConfigError
from octsim.config.derive import with_flat_source
from octsim.config.maxwell import beyond_maxwell
from octsim.config.models import Config
from octsim.config.source import source_of
from octsim.datasets.files import flags, flags_of_missing, make
from octsim.phase.fringe_status import WITH_PHASE, FringeStatus
from octsim.stages.focus_law import focus_line
from octsim.studies.calibration.missing import SystematicStatus
from octsim.studies.calibration.parameters import parameter_named
from octsim.studies.calibration.scheme import waves_of
from octsim.studies.calibration.sensitivity import MISFIT, sensitivity_at
from octsim.studies.match.fit import PARAMETERS, Match, Observed, match
from octsim.studies.responses.separability import Separability

Array = NDArray[np.float64]
_MORE = 1.5
"""χ² over its freedom, from which more is left than noise leaves."""
_SOURCE = 0.05
"""Root mean square difference of the sources' shapes, over the largest power, that is said."""


def match_of_spectra(
    config: Config,
    measured: xr.Dataset,
    calibration: xr.Dataset,
    law: xr.Dataset | None = None,
) -> xr.Dataset:
    """Compare the mean of measured spectra at rest with the modelled one, and fit the model.

    Parameters
    ----------
    config : Config
        Whose ``expansion.diameter`` the neuron has, and whose first ``expansion.rest`` spectra are
        at rest.
    measured, calibration : Dataset
        Of these stages.
    law : Dataset, optional
        The fitted law; needed only where ``sweep.focus`` is ``law``.

    Returns
    -------
    Dataset
        measured_spectrum, modelled_spectrum and matched_spectrum (wavenumber); of each parameter
        what is believed, what fits best, its standard error and correlation; χ² of both; depths and
        visibilities beside each other; and the slope with its error by that fit.

    Raises
    ------
    OctsimError
        If Maxwell's equations are not solved for the scene, or no spectrum has a phase.
    """
    if reason := beyond_maxwell(config):
        raise ConfigError(f"match: spectra are compared with Maxwell's equations, but {reason}")
    exact = with_flat_source(waves_of(config))
    diameter = config.expansion.diameter
    line = focus_line(config, law)
    focus = line.at(diameter)
    observed = _observed(config, measured)
    found = match(exact, observed, diameter, focus)
    errors = np.sqrt(np.diag(found.covariance))
    tolerance = np.array([config.calibration.tolerances.of[name] for name in PARAMETERS])
    status = np.where(errors < tolerance, Separability.SEPARABLE, Separability.NOT_SEPARABLE)
    believed = _believed(exact, diameter, focus)
    return make(
        "match",
        config,
        "The mean of measured spectra beside modelled ones, and the model that fits it best",
        {
            "measured_spectrum": ("wavenumber", observed.counts),
            "measured_spectrum_error": ("wavenumber", observed.error),
            "modelled_spectrum": ("wavenumber", found.configured),
            "matched_spectrum": ("wavenumber", found.fitted),
            "believed": ("parameter", believed),
            "matched": ("parameter", believed + found.change),
            "matched_error": ("parameter", errors),
            "match_tolerance": ("parameter", tolerance),
            "match_status": ("parameter", *flags(Separability, status)),
            "match_correlation": (
                ("parameter", "other_parameter"), found.covariance / np.outer(errors, errors)
            ),
            "chi_square": found.chi_square,
            "configured_chi_square": found.configured_chi_square,
            "degrees_of_freedom": observed.counts.size - len(PARAMETERS) - 1,
            "misfit": _misfit(observed, found.fitted),
            "configured_misfit": _misfit(observed, found.configured),
            "source_difference": _source_difference(config, observed),
            "measured_depth": float(measured["measured_depth"]),
            "nominal_depth": config.swept_group_index * diameter,
            **_slope(calibration, diameter, line.slope, found, tolerance),
        },
        {
            "wavenumber": observed.wavenumber,
            "wavelength": ("wavenumber", 2 * np.pi / observed.wavenumber),
            "parameter": list(PARAMETERS),
            "other_parameter": list(PARAMETERS),
            "parameter_unit": ("parameter", [parameter_named(name).unit for name in PARAMETERS]),
        },
    )  # fmt: skip


def _observed(config: Config, measured: xr.Dataset) -> Observed:
    """Return the mean spectrum at rest, in the band."""
    status = measured["spectrum_status"].values[: config.expansion.rest]
    whole = np.isin(status, WITH_PHASE) & (status != FringeStatus.SATURATED)
    if not whole.any():
        raise ConfigError(
            f"expansion.rest: none of the first {status.size} spectra has a phase, so nothing is "
            "known of the neuron at rest; give spectra that have"
        )
    power = measured["source_power"].values
    inside = np.isfinite(power)
    counts = measured["counts"][: whole.size].values[whole][:, inside].astype(float)
    net = counts.mean(axis=0) - measured["dark_level"].values[inside]
    variance = measured["sample_variance"].values[inside] / whole.sum()
    if not (variance > 1e-12 * net.max() ** 2 / net.size**2).all():
        raise ConfigError(
            "match: the measured spectra do not scatter, so how well they are known is not; give "
            "measured.spectra as they were recorded"
        )
    return Observed(measured["wavenumber"].values[inside], net, power[inside], np.sqrt(variance))


def _believed(config: Config, diameter: float, focus: float) -> Array:
    given = {name: parameter_named(name).believed(config) for name in PARAMETERS}
    return np.array([*(given | {"diameter": diameter, "focus": focus}).values()])


def _misfit(observed: Observed, modelled: Array) -> float:
    """Return the root mean square of what a model leaves, over that of the spectrum."""
    off = observed.counts - modelled
    return float(np.sqrt((off**2).mean() / (observed.counts**2).mean()))


def _source_difference(config: Config, observed: Observed) -> float:
    """Return how far the calibration's source is from the measured one, over the largest power."""
    source = source_of(config.spectrum.source)
    flat = np.ones_like(observed.source)
    power = flat if source is None else source.power(observed.wavenumber)
    scale = (power @ observed.source) / (power @ power)
    return float(np.sqrt(((scale * power - observed.source) ** 2).mean()))


def _slope(
    calibration: xr.Dataset, diameter: float, law_slope: float, found: Match, tolerance: Array
) -> dict[str, Any]:
    """Return the slope by the fit and what was believed, together, and its error.

    Sensitivities of a calibration are by nm, and hold the focus where the law has it.
    """
    at, known = sensitivity_at(diameter, calibration), calibration["diameter"].values
    names = [str(name) for name in calibration["parameter"].values]

    def rate(name: str) -> float:
        values = calibration.get(f"{name}_sensitivity")
        per_unit = 1e3 if parameter_named(name).unit == "um" else 1.0
        return 0.0 if values is None else per_unit * float(np.interp(diameter, known, values))

    rates = np.array([rate(name) for name in PARAMETERS])
    # a larger diameter at a held focus is one whose focus is off the law
    focus, size = PARAMETERS.index("focus"), PARAMETERS.index("diameter")
    rates[size] -= law_slope * rates[focus]
    certain = np.diag(1 / np.maximum(tolerance, 1e-3 * np.sqrt(np.diag(found.covariance))) ** 2)
    fitted = np.linalg.inv(found.covariance)
    both = np.linalg.inv(fitted + certain)
    budget = calibration["budget"]
    others = sum(
        _budget(budget, name, diameter, known) ** 2 for name in names if name not in PARAMETERS
    )
    error = float(np.sqrt(rates @ both @ rates + others))
    return {
        "fixed_focus_phase_slope": at.slope,
        "fixed_focus_phase_slope_standard_error": at.standard_error,
        "systematic_status": ((), *flags_of_missing(at.standard_error, SystematicStatus.NOT_KNOWN)),
        "matched_phase_slope": at.slope + float(rates @ both @ fitted @ found.change),
        "matched_phase_slope_standard_error": error,
        "matched_systematic_status": ((), *flags_of_missing(error, SystematicStatus.NOT_KNOWN)),
    }


def _budget(budget: xr.DataArray, name: str, diameter: float, known: Array) -> float:
    return float(np.interp(diameter, known, budget.sel(parameter=name).values))


def summary(found: xr.Dataset) -> str:
    """Return in one line what fits best."""
    told = ", ".join(
        f"{name} {float(found['matched'].sel(parameter=name)):.5g} ± "
        f"{float(found['matched_error'].sel(parameter=name)):.2g}"
        for name in PARAMETERS
    )
    reduced = float(found["chi_square"]) / float(found["degrees_of_freedom"])
    left = f" (the fit leaves {float(found['misfit']):.2g} of the spectrum; errors are widened)"
    return (
        f"match: {told} (um, 1); χ² over its freedom {reduced:.3g}"
        f"{left if reduced > _MORE else ''}, of the config as it is "
        f"{float(found['configured_chi_square']) / float(found['degrees_of_freedom']):.3g}; slope "
        f"{float(found['matched_phase_slope']):.4g} ± "
        f"{float(found['matched_phase_slope_standard_error']):.2g} mrad/nm"
    )


def doubts(found: xr.Dataset) -> Iterator[str]:
    """Say, a line each, where the lab's neuron is not what the config says."""
    misfit = float(found["misfit"])
    if misfit > MISFIT:
        yield (
            f"match: the best fit leaves {misfit:.0%} of the spectrum, so no neuron of this scene "
            "has it; look for other surfaces, a membrane or myelin, and at dark and reference"
        )
    for name in PARAMETERS:
        one = found.sel(parameter=name)
        off = float(one["matched"] - one["believed"])
        if abs(off) > 3 * max(float(one["match_tolerance"]), float(one["matched_error"])):
            yield (
                f"match: {name} fits best at {float(one['matched']):.5g}, {off:+.3g} from what the "
                "config says, far beyond its tolerance; give that in the config, and calibrate anew"
            )
    if float(found["source_difference"]) > _SOURCE:
        yield (
            "match: spectrum.source differs from the measured source by "
            f"{float(found['source_difference']):.0%} of its largest power, so the calibration is "
            "of another one; give it the file of this source"
        )
