"""Phase slopes and calibrations of scenes, by rays and by Maxwell (`snakemake scenes`)."""

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.base.threads import each
from octsim.config.models import Config
from octsim.datasets.files import flags, flags_of_missing, make
from octsim.datasets.statuses import MeanStatus
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.phase.derivatives import wrapped
from octsim.phase.fringe_status import FringeStatus
from octsim.schemes.light import AccuracyStatus
from octsim.stages.focus_law import focus_line
from octsim.studies.detector.over_diameter import mean_of_known, root_mean_square
from octsim.studies.scenes.cases import SCHEMES, Case, CaseStatus, ChangeStatus, cases
from octsim.studies.scenes.tolerated import TOLERANCE, ToleratedStatus, tolerated, tolerated_status
from octsim.studies.validity.errors import ESTIMATORS, FOCUS_MODES, Seen, seen
from octsim.studies.validity.study import windows

Array = NDArray[np.float64]
DIAMETERS = 7
"""Of the sweep's range, ends included."""


def scenes(
    config: Config,
    law: xr.Dataset | None = None,
    threads: int = 1,
    points: Points | None = None,
    number: int = DIAMETERS,
) -> xr.Dataset:
    """Measure the phase slope of scenes about the configured one, one thing varied at a time.

    The focus is that of the config's law, which is not fitted anew; it follows the diameter or is
    held while a slope is taken, as for `octsim.studies.validity.study.validity`.

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
        scene_phase_slope (case, scheme, focus_mode, estimator, diameter), and its change from the
        configured scene's by the same scheme, mean, scatter and worst over the diameters;
        scene_phase_change (case, scheme, diameter); what of a quantity moves the held slope by
        `TOLERANCE`, tolerated (case, scheme); and statuses, which say where a number is missing,
        and why.

    Raises
    ------
    OctsimError
        If the law is needed and could not be fitted, or no cylinder is swept.
    """
    every, line = cases(config), focus_line(config, law)
    places = windows(config, line, number)
    benches = {
        (row, column): Instrument(one, points)
        for row, case in enumerate(every)
        for column, one in enumerate(case.by)
        if one is not None
    }
    asked = list(itertools.product(benches, range(number)))
    found = each(lambda at: seen(benches[at[0]], places[at[1]]), asked, threads)
    table: dict[tuple[int, int], list[Seen]] = {at: [] for at in benches}
    for (at, _), one in zip(asked, found, strict=True):
        table[at].append(one)
    return make(
        "scenes",
        config,
        "Phase slopes of scenes, one thing varied at a time, by rays and by Maxwell's equations",
        _variables(every, table, number),
        {
            "case": [case.name for case in every],
            "quantity": ("case", [case.quantity for case in every]),
            "quantity_amount": ("case", np.array([case.value for case in every])),
            "quantity_unit": ("case", [case.unit for case in every]),
            "scheme": list(SCHEMES),
            "focus_mode": list(FOCUS_MODES),
            "estimator": list(ESTIMATORS),
            "diameter": np.array([window.diameter[1] for window in places]),
            "focus": ("diameter", np.array([window.foci[0, 1] for window in places])),
        },
    ).assign_attrs(tolerance=TOLERANCE)


def _variables(
    every: Sequence[Case], table: dict[tuple[int, int], list[Seen]], number: int
) -> dict[str, Any]:
    shape = len(every), len(SCHEMES)
    slope = np.full((*shape, len(FOCUS_MODES), len(ESTIMATORS), number), np.nan)
    phase, error = (np.full((*shape, number), np.nan) for _ in range(2))
    fringe = np.full((*shape, number), FringeStatus.NO_LIGHT)
    status = np.full((*shape, number), AccuracyStatus.NOT_CONTROLLED)
    measured = np.full(shape, CaseStatus.NOT_BY_THIS_SCHEME)
    measured[[case.long for case in every], SCHEMES.index("fullwave")] = CaseStatus.TOO_LONG
    for at, row in table.items():
        measured[at] = CaseStatus.MEASURED
        slope[at] = np.moveaxis(np.array([one.slope for one in row]), 0, -1)
        phase[at], error[at] = [one.phase for one in row], [one.error for one in row]
        fringe[at], status[at] = [one.fringe for one in row], [one.status for one in row]
    change = slope - slope[:1]
    kinds = ("case", "scheme", "focus_mode", "estimator")
    known = np.isfinite(change)
    several = known.sum(axis=-1) > 1
    of_several = np.where(several[..., np.newaxis], change, np.nan)
    mean = mean_of_known(of_several)
    worst = np.where(several, np.where(known, np.abs(change), 0.0).max(axis=-1), np.nan)
    moved = wrapped(phase - phase[:1])
    has = (measured == CaseStatus.MEASURED) & (measured[0] == CaseStatus.MEASURED)
    missing = np.where(has, ChangeStatus.NO_FRINGE, ChangeStatus.NOT_MEASURED)
    changed = np.where(np.isfinite(moved), ChangeStatus.MEASURED, missing[..., np.newaxis])
    return {
        "scene_phase_slope": ((*kinds, "diameter"), slope),
        "scene_slope_change": ((*kinds, "diameter"), change),
        "scene_mean_change": (kinds, mean),
        "scene_change_scatter": (kinds, root_mean_square(of_several - mean[..., np.newaxis])),
        "scene_worst_change": (kinds, worst),
        "scene_phase_change": (("case", "scheme", "diameter"), moved),
        "tolerated": (("case", "scheme"), tolerated(every, slope)),
        "case_status": (("case", "scheme"), *flags(CaseStatus, measured)),
        "change_status": (("case", "scheme", "diameter"), *flags(ChangeStatus, changed)),
        "mean_change_status": (kinds, *flags_of_missing(mean, MeanStatus.TOO_FEW)),
        "tolerated_status": (
            ("case", "scheme"),
            *flags(ToleratedStatus, tolerated_status(every, slope)),
        ),
        "intensity_error": (("case", "scheme", "diameter"), error),
        "accuracy_status": (("case", "scheme", "diameter"), *flags(AccuracyStatus, status)),
        "fringe_status": (("case", "scheme", "diameter"), *flags(FringeStatus, fringe)),
    }


def summary(table: xr.Dataset) -> str:
    """Return in one line what moves the held slope most, by Maxwell where that is known."""
    held = table.sel(focus_mode="held", estimator="sinusoid")
    worst = held["scene_worst_change"].sel(scheme="fullwave")
    worst = worst.where(np.isfinite(worst), held["scene_worst_change"].sel(scheme="paths"))
    if not np.isfinite(worst).any():
        return "scenes: no slope is known"
    largest = int(worst.argmax("case"))
    return (
        f"scenes: the slope at a held focus moves most by {table['case'].values[largest]}, "
        f"up to {float(worst[largest]):.2g} mrad/nm at some diameter"
    )
