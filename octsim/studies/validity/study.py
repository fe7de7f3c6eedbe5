"""Where rays can be believed: beside Maxwell's equations, case by case (`snakemake validity`)."""

import itertools
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.threads import each
from octsim.config.models import Config, FocusLine
from octsim.datasets.files import flags, flags_of_missing, make
from octsim.datasets.statuses import MeanStatus
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.phase.fringe_status import FringeStatus
from octsim.schemes.light import AccuracyStatus
from octsim.stages.focus_law import focus_line
from octsim.studies.validity.cases import SCHEMES, Case, cases
from octsim.studies.validity.errors import (
    ESTIMATORS,
    FOCUS_MODES,
    Seen,
    Window,
    differences,
    seen,
)

Array = NDArray[np.float64]
DIAMETERS = 11
"""Of the sweep's range, ends included, that every case is compared at."""
LARGEST_STEP = 0.01
"""µm; between the diameters of a difference, where the sweep's own are farther apart."""
BOUNDS = (0.01, 0.03, 0.1)
"""Relative errors of the slope that the map is drawn for."""


class Compared(NamedTuple):
    """A case at a diameter."""

    exact: Seen
    rays: tuple[Seen, ...]
    """By `SCHEMES`."""


def windows(config: Config, line: FocusLine, number: int) -> list[Window]:
    """Return the windows about some evenly spaced diameters of the sweep."""
    sweep = config.sweep.diameters
    step = min((sweep.stop - sweep.start) / (sweep.num - 1), LARGEST_STEP, sweep.start / 2)
    steps = step * np.array([-1.0, 0.0, 1.0])

    def about(diameter: float) -> Window:
        near = diameter + steps
        held = np.full(near.size, line.at(diameter))
        follows = line.at(near)
        follows[1] = held[1]
        return Window(near, np.stack([follows, held]))

    return [about(d) for d in np.linspace(sweep.start, sweep.stop, number).tolist()]


def validity(
    config: Config,
    law: xr.Dataset | None = None,
    threads: int = 1,
    points: Points | None = None,
    number: int = DIAMETERS,
) -> xr.Dataset:
    """Compare rays with Maxwell's equations for the config's instrument, and others near it.

    The pupil, the numerical aperture, the index of the neuron and the gap are varied, one at a
    time, for rays and waves alike; a pupil weighs rays as they are launched. The focus is that of
    the config's law, and follows the diameter or is held while a slope is taken; slopes are by the
    thesis's Fourier transform and by a least-squares sinusoid at the nominal depth of each
    diameter.

    Parameters
    ----------
    config : Config
    law : Dataset, optional
        The fitted law; needed only where ``sweep.focus`` is ``law``.
    threads : int
        How many windows are at work at a time.
    points : Points, optional
        Where light that was found before is kept.
    number : int
        How many diameters.

    Returns
    -------
    Dataset
        exact_phase_slope (case, focus_mode, estimator, diameter); by scheme of rays
        ray_phase_slope, ray_slope_error, ray_phase_error, ray_visibility_error and
        ray_spectrum_error (case, ray_scheme, diameter), NaN where a spectrum has no fringe, as
        fringe_status says of Maxwell's and ray_fringe_status of rays';
        mean_slope_error and its standard error over the diameters, with mean_slope_error_status;
        and the map, share_within (…, bound_of_error): the share of the diameters where the slope's
        error is within it.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted, or Maxwell's equations are not solved for the
        config.
    """
    every, line = cases(config), focus_line(config, law)
    places = windows(config, line, number)

    def compared(at: tuple[tuple[Instrument, ...], Window]) -> Compared:
        (exact, *rays), window = at
        return Compared(seen(exact, window), tuple(seen(one, window) for one in rays))

    benches = [tuple(Instrument(one, points) for one in (case.exact, *case.rays)) for case in every]
    found = list(each(compared, itertools.product(benches, places), threads))
    rows = [found[first : first + number] for first in range(0, len(found), number)]
    return make(
        "validity",
        config,
        "Errors of rays beside Maxwell's equations, one quantity varied at a time",
        _variables(rows),
        {
            **_coordinates(every),
            "diameter": np.array([window.diameter[1] for window in places]),
            "focus": ("diameter", np.array([window.foci[0, 1] for window in places])),
        },
    )


def _coordinates(every: Sequence[Case]) -> dict[str, Any]:
    return {
        "case": [case.name for case in every],
        "quantity": ("case", [case.quantity for case in every]),
        "quantity_value": ("case", [case.value for case in every]),
        "ray_scheme": list(SCHEMES),
        "focus_mode": list(FOCUS_MODES),
        "estimator": list(ESTIMATORS),
        "bound_of_error": np.array(BOUNDS),
    }


def _variables(rows: Sequence[Sequence[Compared]]) -> dict[str, Any]:
    exact = np.array([[at.exact.slope for at in row] for row in rows])
    fringe = np.array([[at.exact.fringe for at in row] for row in rows])
    by_rays = np.array([[[one.fringe for one in at.rays] for at in row] for row in rows])
    status = np.array([[at.exact.status for at in row] for row in rows])
    found = [[[differences(one, at.exact) for one in at.rays] for at in row] for row in rows]
    variables: dict[str, Any] = {
        "exact_phase_slope": (("case", "focus_mode", "estimator", "diameter"),
                              np.moveaxis(exact, 1, -1)),
        "intensity_error": (("case", "diameter"),
                            np.array([[at.exact.error for at in row] for row in rows])),
        "accuracy_status": (("case", "diameter"), *flags(AccuracyStatus, status)),
        "fringe_status": (("case", "diameter"), *flags(FringeStatus, fringe)),
        "ray_fringe_status": (("case", "ray_scheme", "diameter"),
                              *flags(FringeStatus, np.moveaxis(by_rays, 1, -1))),
    }  # fmt: skip
    for name in found[0][0][0]:
        # (case, diameter, scheme, ...) with the diameter last
        values = np.array([[[one[name] for one in at] for at in row] for row in found])
        own = ("focus_mode", "estimator") if values.ndim > 3 else ()
        variables[name] = ("case", "ray_scheme", *own, "diameter"), np.moveaxis(values, 1, -1)
    kinds = ("case", "ray_scheme", "focus_mode", "estimator")
    error = variables["ray_slope_error"][1]
    mean, sure = mean_error(variables["ray_phase_slope"][1], variables["exact_phase_slope"][1])
    variables["mean_slope_error"] = kinds, mean
    variables["mean_slope_error_standard_error"] = kinds, sure
    variables["mean_slope_error_status"] = kinds, *flags_of_missing(mean, MeanStatus.TOO_FEW)
    within = np.abs(error)[..., np.newaxis] <= np.array(BOUNDS)
    variables["share_within"] = (*kinds, "bound_of_error"), within.mean(axis=-2)
    return variables


def mean_error(rays: Array, exact: Array) -> tuple[Array, Array]:
    """Return by how much rays are off on average, and the standard error of that over diameters.

    It is the mean difference over the mean exact slope, as a slope near zero would rule a mean of
    ratios; NaN with fewer than two diameters.

    Parameters
    ----------
    rays : ndarray, shape (case, scheme, mode, estimator, D)
        Slopes; NaN where there is no fringe.
    exact : ndarray, shape (case, mode, estimator, D)
    """
    exact = np.broadcast_to(exact[:, np.newaxis], rays.shape)
    known = np.isfinite(rays) & np.isfinite(exact)
    count = known.sum(axis=-1)
    some = np.where(count > 1, count, np.nan)
    away = np.where(known, rays - exact, 0.0)
    mean = away.sum(axis=-1) / some
    spread = np.where(known, away - mean[..., np.newaxis], 0.0)
    slope = np.where(known, exact, 0.0).sum(axis=-1) / some
    return mean / slope, np.sqrt((spread**2).sum(axis=-1) / (some * (some - 1))) / np.abs(slope)


def summary(table: xr.Dataset) -> str:
    """Return in one line how far rays are off for the configured instrument."""
    first = table.isel(case=0).sel(ray_scheme="paths", focus_mode="follows")

    def said(estimator: str) -> str:
        one = first.sel(estimator=estimator)
        mean = float(one["mean_slope_error"])
        error = float(one["mean_slope_error_standard_error"])
        shares = ", ".join(f"{float(share):.0%}" for share in one["share_within"])
        return f"{estimator} {mean:+.1%} ± {error:.1%} (within 1, 3, 10 % at {shares})"

    return (
        "phase slope by rays beside Maxwell's equations, as configured: "
        + "; ".join(map(said, ESTIMATORS))
        + f" of {table.sizes['diameter']} diameters"
    )
