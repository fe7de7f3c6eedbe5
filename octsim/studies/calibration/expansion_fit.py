"""From phases in several bands to all that may have changed (`snakemake expansion`)."""

import warnings
from collections.abc import Hashable, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.errors import DatasetError, OctsimWarning
from octsim.config.calibration import DIAMETER
from octsim.config.models import Config
from octsim.datasets.files import flags, flags_of_missing, make
from octsim.phase.derivatives import Array
from octsim.phase.measured_series import Series
from octsim.phase.outliers import Standing, outliers
from octsim.phase.rest_error import ErrorStatus, smallest_step, stated_change
from octsim.studies.calibration.expansion_doubts import doubts
from octsim.studies.calibration.missing import (
    MisfitStatus,
    SystematicStatus,
    misfit_status,
    series_statuses,
)
from octsim.studies.responses.quantities import CONFIGURED
from octsim.studies.responses.separability import Separability, errors_of, told_apart

LARGEST = 5.0
"""Change of a quantity, nm or 1e-3 of an index, up to which responses serve: they are straight."""


class Matrix(NamedTuple):
    """Responses of B phases to Q quantities at one diameter."""

    response: Array
    """(B, Q), mrad for each nm, or 1e-3 of an index."""
    shift: Array
    """Its changes by what is not known of the instrument, (P, B, Q): their squares add."""


class Fitted(NamedTuple):
    """Changes of Q quantities at T times, nm or 1e-3 of an index; NaN where a phase is missing."""

    change: Array
    """(T, Q)."""
    statistical: Array
    """Covariance by the errors of the phases, (T, Q, Q)."""
    systematic: Array
    """Covariance by those of the responses, (T, Q, Q)."""
    chi_square: Array
    """Of the phases, for each degree of freedom, (T,); NaN where there is none."""


def matrix_at(config: Config, responses: xr.Dataset) -> Matrix:
    """Return the responses of the phases in ``expansion.bands`` to what ``expansion.fit`` names.

    Raises
    ------
    DatasetError
        If the responses are not of the diameter, or of those bands.
    """
    given = config.expansion
    known, bands = responses["diameter"].values, np.array(given.bands)
    of = np.column_stack([responses["band_min"].values, responses["band_max"].values])
    if not np.isclose(known, given.diameter, rtol=0, atol=1e-9).any():
        raise DatasetError(
            f"expansion.diameter: {given.diameter:g} um given, and the responses are of "
            f"{known[0]:g} to {known[-1]:g} um, but not of it; run the stage responses again"
        )
    if of.shape != bands.shape or not np.allclose(of, bands, rtol=0, atol=1e-9):
        raise DatasetError(
            "expansion.bands: the responses are of other bands; run the stage responses again"
        )
    place: dict[Hashable, list[str]] = {
        "observable": [f"band_{number + 1}" for number in range(len(bands))],
        "quantity": list(given.fit),
    }
    one = responses.sel(diameter=given.diameter, method="nearest")
    response = one["phase_response"].sel({"variant": CONFIGURED, **place})
    shift = one["phase_response_shift"].sel(place).stack(off=("parameter", "side"))
    # a difference may be wrong in any of its numbers, by itself
    rough = one["phase_response_difference_error"].sel({"variant": CONFIGURED, **place}).values
    alone = np.eye(rough.size).reshape(-1, *rough.shape) * rough
    by = np.concatenate([shift.transpose("off", "observable", "quantity").values, alone])
    if np.isnan(one["phase_response_standard_error"].sel({"variant": CONFIGURED, **place})).any():
        by = np.full_like(by, np.nan)
    return Matrix(response.values, by)


def fitted_changes(matrix: Matrix, phase: Array, error: Array) -> Fitted:
    r"""Return the changes that phases are of, by weighted least squares.

    .. math:: x = W y, \quad W = (R^T C^{-1} R)^{-1} R^T C^{-1},

    with the errors of the phases, C, between bands independent. Their covariance is
    :math:`(R^T C^{-1} R)^{-1}`, that by the responses
    :math:`\sum_p (W \Delta_p x)(W \Delta_p x)^T`.

    Parameters
    ----------
    matrix : Matrix
    phase, error : ndarray, shape (T, B)
        Changes of the phases from rest and their standard errors, rad; NaN where one is missing.
    """
    moved, sigma = 1e3 * phase, 1e3 * error
    times, many = len(phase), matrix.response.shape[1]
    change, chi_square = np.full((times, many), np.nan), np.full(times, np.nan)
    statistical, systematic = (np.full((times, many, many), np.nan) for _ in range(2))
    freedom = phase.shape[1] - many
    for at in np.flatnonzero(np.isfinite(moved).all(axis=1)):
        # where errors are not known, or none, phases count alike
        known = np.isfinite(sigma[at]).all() and (sigma[at] > 0).all()
        scale = sigma[at] if known else np.ones_like(sigma[at])
        weighted = matrix.response / scale[:, np.newaxis]
        onto = np.linalg.pinv(weighted) / scale
        change[at] = onto @ moved[at]
        statistical[at] = (onto * sigma[at] ** 2) @ onto.T
        off = (matrix.shift @ change[at]) @ onto.T
        systematic[at] = off.T @ off
        if freedom and known:
            rest = (moved[at] - matrix.response @ change[at]) / scale
            chi_square[at] = (rest**2).sum() / freedom
    return Fitted(change, statistical, systematic, chi_square)


def separability(matrix: Matrix, error: Array) -> NDArray[np.int64]:
    """Return the codes of `Separability` of the quantities, (Q,), by the phases' mean errors."""
    values, many = matrix.response.shape
    sigma = 1e3 * np.sqrt(np.nanmean(error**2, axis=0))
    known = np.isfinite(sigma).all() and (sigma > 0).all()
    weighted = matrix.response / (sigma if known else np.ones(values))[:, np.newaxis]
    errors = errors_of(weighted.T @ weighted)
    return told_apart(errors.together, errors.alone, values, many).astype(np.int64)


def series_fit(config: Config, series: Sequence[Series], responses: xr.Dataset) -> xr.Dataset:
    """Return all that has changed in a neuron whose phase was measured in several bands.

    Returns
    -------
    Dataset
        change, with its errors, (time, quantity), and their covariances; separability (quantity);
        expansion, statistical_error and systematic_error of the diameter (time); the rest as
        `octsim.studies.calibration.expansion.series_expansion`, with a dimension band.

    Raises
    ------
    OctsimError
        If the series or the responses do not serve, or a change is too large for these.

    Warns
    -----
    OctsimWarning
        Of each thing that the numbers may not be worth.
    """
    settings, matrix = config.expansion, matrix_at(config, responses)
    alone = np.array([outliers(one) for one in series])
    dropped = alone if settings.outliers == "drop" else np.zeros_like(alone)
    stated = [
        stated_change(
            one._replace(phase=np.where(off, np.nan, one.phase)),
            settings.rest, settings.drift != "none", settings.references,
        )
        for one, off in zip(series, dropped, strict=True)
    ]  # fmt: skip
    phase = np.column_stack([one.phase for one, _ in stated])
    error = np.column_stack([one.error for one, _ in stated])
    found = fitted_changes(matrix, phase, error)
    if (np.abs(found.change) > LARGEST).any():
        at, which = np.unravel_index(int(np.nanargmax(np.abs(found.change))), found.change.shape)
        code = Separability(int(separability(matrix, error)[which]))
        name = "" if code == Separability.SEPARABLE else f" ({code.name.lower()})"
        raise DatasetError(
            f"expansion.fit: a change of {found.change[at, which]:.4g} of {settings.fit[which]}"
            f"{name} at {series[0].time[at]:g} s, more than the {LARGEST:g} nm, or 1e-3 of an "
            "index, that responses hold for; "
            f"{code.remedy or 'fit fewer quantities, or take the rest nearer to it'}"
        )
    both = [
        np.sqrt(np.diagonal(part, axis1=1, axis2=2))
        for part in (found.statistical, found.systematic)
    ]
    first, covariances = settings.fit.index(DIAMETER), ("time", "quantity", "other_quantity")
    whole = np.column_stack([one.phase for one in series])
    measured = {"measured_phase": (("time", "band"), whole)}
    steps = np.array([smallest_step(one.phase) for one in series])
    scatter = np.array([one.scatter for one, _ in stated])
    statuses = series_statuses(("time", "band"), whole, dropped.T, scatter, steps)
    unsure = flags_of_missing(matrix.shift.sum(), SystematicStatus.NOT_KNOWN)
    misfit = misfit_status(found.chi_square, found.change)
    given = [one.phase_error for one in series if one.phase_error is not None]
    if given:
        errors = np.column_stack(given)
        measured["measured_phase_error"] = (("time", "band"), errors)
    marked = (
        {}
        if settings.outliers == "off"
        else {"outlier": ("time", *flags(Standing, alone.any(axis=0).astype(int)))}
    )
    own = responses.sel(quantity=list(settings.fit))["quantity_unit"].values
    made = make(
        "expansion",
        config,
        "Changes of a neuron over time, from phases in several bands",
        {
            "phase_change": (("time", "band"), phase),
            "change": (("time", "quantity"), found.change),
            "change_statistical_error": (("time", "quantity"), both[0]),
            "change_systematic_error": (("time", "quantity"), both[1]),
            "statistical_covariance": (covariances, found.statistical),
            "systematic_covariance": (covariances, found.systematic),
            "separability": ("quantity", *flags(Separability, separability(matrix, error))),
            "reduced_chi_square": ("time", found.chi_square),
            "quantity_unit": ("quantity", [str(unit) for unit in own]),
            "phase_response": (("band", "quantity"), matrix.response),
            "band_min": ("band", np.array(settings.bands)[:, 0]),
            "band_max": ("band", np.array(settings.bands)[:, 1]),
            "expansion": ("time", found.change[:, first]),
            "statistical_error": ("time", both[0][:, first]),
            "systematic_error": ("time", both[1][:, first]),
            "diameter": settings.diameter,
            "samples_missing": int(np.isnan(phase).any(axis=1).sum()),
            "error_status": ("band", *flags(ErrorStatus, np.array([s for _, s in stated]))),
            "rest_scatter": ("band", scatter),
            "smallest_step": ("band", steps),
            "drift": ("band", np.array([one.drift for one, _ in stated])),
            **statuses,
            "systematic_status": ((), *unsure),
            "chi_square_status": ("time", *flags(MisfitStatus, misfit)),
            **measured,
            **marked,
        },
        {"time": series[0].time, "quantity": list(settings.fit)},
    )
    for doubt in doubts(made):
        warnings.warn(doubt, OctsimWarning, stacklevel=2)
    return made
