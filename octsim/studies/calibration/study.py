"""The calibration: how far the phase moves when the neuron alone does (`snakemake calibration`)."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from octsim.base.threads import each
from octsim.config.derive import by_rays, calibrating
from octsim.config.following import calibration_diameters
from octsim.config.given import taking_config
from octsim.config.maxwell import beyond_maxwell
from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.config.scene_keys import variable_name
from octsim.datasets.files import flags, flags_of_missing, make
from octsim.instrument.points import Points
from octsim.optics.two_beams import predicted_phase_slope
from octsim.phase.derivatives import Array
from octsim.schemes.light import AccuracyStatus
from octsim.stages.focus_law import focus_line
from octsim.studies.calibration.parameters import parameters_of
from octsim.studies.calibration.scheme import (
    MISSED,
    MODEL,
    ModelStatus,
    OtherSchemeStatus,
    SlopeErrorStatus,
    converged,
    paths_of,
    rays_because,
    require_budget,
    waves_of,
)
from octsim.studies.calibration.slopes import bench_of, slopes_at

RAYS = 3000
"""The thesis's rays, whose slope over such steps is stored beside, to compare."""
_POINTS = 17
"""Spectra of each parameter, of the curvature, and of each other scheme or less."""


def by_fft(config: Config) -> Processing:
    """Return the run's processing with the thesis's estimator."""
    return config.processing.model_copy(update={"estimator": "fft"})


@taking_config
def calibration(
    config: Config,
    law: xr.Dataset | None = None,
    threads: int = 1,
    points: Points | None = None,
) -> xr.Dataset:
    """Differentiate the phase over the diameter at a fixed focus and gap, and say how surely.

    An action potential does not move the objective. At each diameter the focus is the law's, and
    is held while the diameter moves by ``calibration.step`` to each side; so are the gap and the
    estimator's settings. Spectra are by ``calibration.scheme``, whatever the run's own: by
    Maxwell's equations, unless these can't be solved for the scene.

    Parameters
    ----------
    config : Config
    law : Dataset, optional
        The fitted law; needed only where ``sweep.focus`` is ``law``.
    threads : int
        How many diameters are at work at a time.
    points : Points, optional
        Where light that was found before is kept.

    Returns
    -------
    Dataset
        Over the diameter: fixed_focus_phase_slope with its systematic standard error, its inverse
        diameter_per_phase and phase_curvature; the slope whose focus follows, the thesis's Fourier
        transform's, that of other schemes and those of each side's light by itself, beside;
        sensitivities to each parameter and what its tolerance makes of it,
        budget(diameter, parameter), with the error of the finite differences; model_status; and
        statuses that say why a number is missing.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted, a diameter has no fringe, the scheme that is
        given can't do the scene, or it takes longer than ``budget.cpu_hours``.

    Examples
    --------
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
    >>> calibration["fixed_focus_phase_slope"].round(1).values.tolist()
    [24.2, 24.1, 24.1, 24.1, 24.1, 24.1, 24.0, 24.0]
    """
    own, line = converged(config), focus_line(config, law)
    diameters = calibration_diameters(config).values()
    spectra = _POINTS * (len(parameters_of(own)) + 4)
    require_budget(own, "calibration", "a calibration by scheme {} takes", spectra, diameters)
    foci = line.at(diameters)
    processing = calibrating(config), by_fft(config)
    bench = bench_of(own, _others(config), processing, line.slope, points)
    places = zip(diameters.tolist(), foci.tolist(), strict=True)
    rows = list(each(lambda place: slopes_at(bench, *place), places, threads))
    named = [*parameters_of(own), *([MODEL] if rays_because(config) else [])]
    return make(
        "calibration",
        config,
        "Change of the phase with the diameter, at a fixed focus and gap",
        _variables(config, own, diameters, rows)
        | {"focus": ("diameter", foci), "slope": line.slope, "intercept": line.intercept},
        {"diameter": diameters, "parameter": named},
    )


def _others(config: Config) -> dict[str, Config]:
    """Return the instrument by every scheme that can, by the variable of its slope.

    By rays it is without what these can't do, as a pupil or an offset.
    """
    waves = {} if beyond_maxwell(config) else {"maxwell_phase_slope": waves_of(config)}
    return {
        "rays_phase_slope": by_rays(config, RAYS), "light_paths_phase_slope": paths_of(config),
    } | waves  # fmt: skip


def interpolation_error(diameter: Array, slope: Array) -> Array:
    """Return how far a cubic spline through every second point misses the others, shape (D,).

    At a point of that half it is the larger of its neighbours'. The spline through all points is
    nearer than this, about 16 times.
    """
    missed = np.zeros_like(slope)
    half = CubicSpline(diameter[::2], slope[::2])
    missed[1::2] = np.abs(half(diameter[1::2]) - slope[1::2])
    if diameter.size % 2 == 0:  # the last one is beyond that half
        missed[-1] = missed[-3]
    around = np.pad(missed, 1)
    return np.maximum(missed, np.maximum(around[:-2], around[2:]))


def _variables(
    config: Config, own: Config, diameters: Array, rows: Sequence[dict[str, Any]]
) -> dict[str, Any]:
    """Return the variables of what is known at each diameter, with the budget of the errors."""
    column = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    parameters = parameters_of(own)
    slope, sensitivity = column["fixed_focus_phase_slope"], column.pop("sensitivity")
    spread, shift = column.pop("spread"), column.pop("shift")
    budget, budget_error = np.hypot(spread, shift), column.pop("budget_error")
    parts = [*spread.T, shift.sum(axis=1)]  # shifts add, whatever their signs
    exact = column.setdefault("maxwell_phase_slope", np.full(slope.size, np.nan))
    if rays_because(config):
        away = np.abs(slope - exact)
        known = np.where(np.isnan(away), ModelStatus.NOT_COMPARED, ModelStatus.COMPARED)
        budget = np.column_stack([budget, away])
        budget_error = np.column_stack([budget_error, 0.0 * away])
        parts.append(away)
    else:
        known = np.full(slope.size, ModelStatus.BY_MAXWELL)
    missed = interpolation_error(diameters, slope)
    parts += [*budget_error.T, missed, column["difference_error"]]
    late = np.isin(column["accuracy_status"], MISSED)
    error = np.where(late, np.nan, np.linalg.norm(parts, axis=0))
    k = config.spectrum.wavenumbers()
    statuses = _statuses(column, error, late, budget, beyond=bool(beyond_maxwell(config)))
    return {
        **statuses,
        "accuracy_status": ("diameter", *flags(AccuracyStatus, column.pop("accuracy_status"))),
        **{name: ("diameter", values) for name, values in column.items()},
        "model_status": ("diameter", *flags(ModelStatus, known)),
        "fixed_focus_phase_slope_standard_error": ("diameter", error),
        "diameter_per_phase": ("diameter", 1 / slope),
        "diameter_per_phase_standard_error": ("diameter", error / slope**2),
        "interpolation_error": ("diameter", missed),
        **{
            # to a length they are per µm
            f"{variable_name(name)}_sensitivity": (
                "diameter", sensitivity[:, number] * (1e-3 if one.unit == "um" else 1.0),
            )
            for number, (name, one) in enumerate(parameters.items())
        },
        "slope_shift": ("diameter", shift.sum(axis=1)),
        "budget": (("diameter", "parameter"), budget),
        "budget_error": (("diameter", "parameter"), budget_error),
        "predicted_phase_slope": predicted_phase_slope(config.swept_material, k[0], k[-1]),
    }  # fmt: skip


def _statuses(
    column: Mapping[str, Array], error: Array, late: NDArray[np.bool_], budget: Array, *,
    beyond: bool,
) -> dict[str, Any]:  # fmt: skip
    """Return why errors, and slopes by other schemes and of each side's light, are missing."""
    why = np.where(late, SlopeErrorStatus.NOT_REACHED, SlopeErrorStatus.NOT_COMPARED)
    of_error = np.where(np.isnan(error), why, SlopeErrorStatus.KNOWN)
    of_budget = flags_of_missing(budget, SlopeErrorStatus.NOT_COMPARED)
    waves = OtherSchemeStatus.BEYOND_SCHEME if beyond else OtherSchemeStatus.NOT_REACHED
    others = {
        "maxwell": waves, "rays": OtherSchemeStatus.NOT_REACHED,
        "light_paths": OtherSchemeStatus.NOT_REACHED,
        "near_side": OtherSchemeStatus.NO_LIGHT, "far_side": OtherSchemeStatus.NO_LIGHT,
    }  # fmt: skip
    return {
        "standard_error_status": ("diameter", *flags(SlopeErrorStatus, of_error)),
        "budget_status": (("diameter", "parameter"), *of_budget),
        **{
            f"{name}_slope_status": (
                "diameter",
                *flags_of_missing(column[f"{name}_phase_slope"], code),
            )
            for name, code in others.items()
        },
    }
