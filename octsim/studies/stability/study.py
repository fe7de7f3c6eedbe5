"""The stability matrix: octsim's doubles beside 50 digits, cell by cell (`snakemake stability`)."""

import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from octsim.config.models import Config
from octsim.datasets.files import flags, make
from octsim.studies.stability.compare import measure
from octsim.studies.stability.matrix import cells
from octsim.studies.stability.pairs import RAYS
from octsim.studies.stability.verdict import NumberStatus, Row, Status

JUDGED = ("phase", "amplitude", "phase_slope", "spectrum", "launch")
"""What of a cell has an error beside its bound."""
FIELDS = {"error": "error", "condition": "condition", "share": "of_bound"}
"""Of each, what ends the names of its variables, and the field of its judgement."""
NUMBERS = (
    "paths_compared", "paths_at_edge", "optical_path_length_error", "single_phase_error",
    "single_amplitude_error", "single_lost",
)  # fmt: skip
_RUN = (Status.WITHIN, Status.EDGE, Status.BEYOND, Status.WARNED)
"""Statuses of a cell in which something is measured."""
_TOLD = {
    **{f"{name}_error_status": f"{name}_error" for name in JUDGED},
    "single_error_status": "single_phase_error",
    "paths_status": "optical_path_length_error",
}
"""Statuses of numbers, and one of the numbers that each is of."""


def row(place: int, base: Config, most: int) -> Row:
    """Return what is measured in the cell at a place of the matrix."""
    return measure(cells(base)[place], base, most)


def stability(
    config: Config,
    threads: int = 1,
    prepare: Callable[[], None] | None = None,
    most: int = RAYS,
) -> xr.Dataset:
    """Return what is measured in every cell of the matrix.

    Parameters
    ----------
    config : Config
        The config that the matrix starts from.
    threads : int
        How many processes work at a time.
    prepare : callable, optional
        What each of several does first.
    most : int
        Most rays of a cell that are traced with 50 digits.

    Returns
    -------
    Dataset
        For each cell, named corner / factor / value: errors, condition numbers, fractions of
        the bound max(1e-9, 8 ε × condition number), what float32 would cost, status and reason;
        and statuses that say why a number is missing.
    """
    matrix = cells(config)
    work, places = partial(row, base=config, most=most), range(len(matrix))
    if threads == 1:
        rows = list(map(work, places))
    else:
        # forked, as the workflow's script can't be imported anew by a fresh interpreter
        context = multiprocessing.get_context("fork")
        with ProcessPoolExecutor(threads, context, prepare) as pool:
            rows = list(pool.map(work, places))
    variables: dict[str, Any] = {
        name: ("cell", np.array([getattr(r, name) for r in rows])) for name in NUMBERS
    }
    for name in JUDGED:
        for ending, field in FIELDS.items():
            values = np.array([getattr(getattr(r, name), field) for r in rows])
            variables[f"{name}_{ending}"] = ("cell", values)
    codes, meaning = flags(Status, np.array([r.status for r in rows]))
    variables["status"] = ("cell", codes, meaning | {"long_name": "what became of the cell"})
    variables["reason"] = ("cell", [r.reason for r in rows])
    run = np.isin(codes, _RUN)
    for name, of in _TOLD.items():
        missing = np.where(run, NumberStatus.NO_PATH, NumberStatus.NOT_RUN)
        known = ~np.isnan(variables[of][1])
        status = np.where(known, NumberStatus.MEASURED, missing)
        variables[name] = ("cell", *flags(NumberStatus, status))
    return make(
        "stability",
        config,
        "Error of octsim's doubles against a tracer of 50 digits, at the extremes",
        variables,
        {
            "cell": [cell.name for cell in matrix],
            "corner": ("cell", [cell.corner for cell in matrix]),
            "factor": ("cell", [cell.factor for cell in matrix]),
            "value": ("cell", [cell.value for cell in matrix]),
        },
    )


def summary(dataset: xr.Dataset) -> str:
    """Return what the matrix shows, in one line."""
    status = dataset["status"].values
    counts = [
        f"{int((status == member).sum())} {member.name.lower().replace('_', ' ')}"
        for member in Status
        if (status == member).any()
    ]
    return f"stability: {status.size} cells, {', '.join(counts)}"
