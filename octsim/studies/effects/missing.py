"""Which changes are not measured, and why."""

from collections.abc import Mapping
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from octsim.datasets.files import flags
from octsim.studies.effects.bench import Bench
from octsim.studies.effects.changes import unwraps

_CONFIGURED = "configured_slope_change"
_KINDS = {"": "mean_slope_change", "local_": "slope_change_scatter", "configured_": _CONFIGURED}
"""Of each kind of measure one, by what its status is called before."""


class ChangeStatus(IntEnum):
    """Whether a change is measured, and why not."""

    MEASURED = 0
    NOT_MEASURED = 1
    """There are no spectra with the effect; effect_status says why."""
    NO_FRINGE = 2
    """Too few diameters have a fringe, with the effect and without it."""
    TOO_FAR_APART = 3
    """The diameters are, for phases by the run's estimator to be followed from one to the next."""


def change_status(
    values: ArrayLike, measured: ArrayLike = True, *, apart: bool = False
) -> NDArray[np.int64]:
    """Return the `ChangeStatus` of changes, NaN where they are missing.

    Parameters
    ----------
    values : array_like
        Changes, of any shape.
    measured : array_like of bool
        Whether there are spectra, of a shape that is broadcast to that.
    apart : bool
        Whether they are by phases of diameters that are too far apart.
    """
    missing = ChangeStatus.TOO_FAR_APART if apart else ChangeStatus.NO_FRINGE
    return np.where(
        ~np.isnan(values), ChangeStatus.MEASURED,
        np.where(measured, missing, ChangeStatus.NOT_MEASURED),
    )  # fmt: skip


def change_statuses(
    bench: Bench, values: Mapping[str, Any], measured: ArrayLike = True, *, noise: bool = False
) -> dict[str, Any]:
    """Return why measures are missing, by the statuses' names, each with its attributes.

    Parameters
    ----------
    bench : Bench
        Of the diameters that they are of.
    values : mapping
        Those of `octsim.studies.effects.changes.Measures` by their names, (N,), that are asked of.
    measured : array_like of bool
        Whether there are spectra, (N,).
    noise : bool
        Whether they are the measures' noise.
    """
    apart = not unwraps(bench.config, bench.diameter)
    return {
        f"{kind}{'noise' if noise else 'change'}_status": flags(
            ChangeStatus,
            change_status(
                values[name], measured, apart=apart and name == _CONFIGURED
            ),
        )
        for kind, name in _KINDS.items()
        if name in values
    }  # fmt: skip
