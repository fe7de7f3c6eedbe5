"""Which numbers of a setting are not measured, and why."""

from collections.abc import Mapping, Sequence
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.datasets.files import flags
from octsim.datasets.statuses import first_reason
from octsim.studies.tradeoff.settings import Setting, is_of_the_trade, is_of_waves

Array = NDArray[np.float64]


class SettingStatus(IntEnum):
    """Whether a number of a setting is measured, and why not."""

    MEASURED = 0
    FEWER_DIAMETERS = 1
    """Only some of the sweep's diameters are traced, so that there is no phase slope."""
    NOT_OF_THE_TRADE = 2
    """What it varies is no way to find light, but how it is sampled, or the reference."""
    BEYOND_SCHEME = 3
    """Maxwell's equations are not solved for the scene; the attribute `maxwell` says why."""
    BY_WAVES = 4
    """Its light is waves, of which no segments are traced."""
    NO_LAW = 5
    """No focus law is fitted with it, or it has too few centres."""
    OTHER_FACTOR = 6
    """It is of settings that vary another factor alone."""
    TOO_FEW = 7
    """Too few settings follow a law."""


def setting_statuses(
    listed: Sequence[Setting], values: Mapping[str, Array], *, solved: bool
) -> dict[str, Any]:
    """Return why numbers of settings are missing, as variables.

    Parameters
    ----------
    listed : sequence of Setting
        N settings.
    values : mapping
        The dataset's variables of these by their names, (N,).
    solved : bool
        Whether Maxwell's equations are solved for the scene.
    """
    few = np.array([setting.every > 1 for setting in listed])
    waves = np.array([is_of_waves(setting.config) for setting in listed])
    traded = np.array([is_of_the_trade(setting) for setting in listed])
    counted = np.array([setting.factor == "tracing.rays" for setting in listed])
    no_law, no_change, no_error = (
        np.isnan(values[name]) for name in ("law_slope_error", "intensity_change", "rays_law_error")
    )
    away = (~traded, SettingStatus.NOT_OF_THE_TRADE)
    beyond = (np.full(few.shape, not solved), SettingStatus.BEYOND_SCHEME)
    reasons = {
        "slope_error_status": [(few, SettingStatus.FEWER_DIAMETERS)],
        "maxwell_status": [beyond, away],
        "maxwell_slope_status": [beyond, away, (few, SettingStatus.FEWER_DIAMETERS)],
        "segments_status": [(waves, SettingStatus.BY_WAVES)],
        "law_error_status": [(no_law, SettingStatus.NO_LAW)],
        "intensity_change_status": [(no_change, SettingStatus.OTHER_FACTOR)],
        "rays_law_status": [
            (~counted, SettingStatus.OTHER_FACTOR),
            (no_error, SettingStatus.TOO_FEW),
        ],
    }
    return {
        name: ("setting", *flags(SettingStatus, first_reason(those, SettingStatus.MEASURED)))
        for name, those in reasons.items()
    }


class TargetStatus(IntEnum):
    """Whether it is known what an error costs."""

    KNOWN = 0
    NONE_TRIED = 1
    """No accuracy of light paths that was tried has as small an error."""
    TOO_FEW = 2
    """Too few numbers of rays were tried to tell what counted rays need."""


def target_status(rays_needed: Array, needed: Array) -> NDArray[np.int64]:
    """Return the `TargetStatus` of the segments that rays and light paths need for errors (T,)."""
    return np.select(
        [np.isnan(rays_needed), np.isnan(needed)],
        [TargetStatus.TOO_FEW, TargetStatus.NONE_TRIED],
        TargetStatus.KNOWN,
    )
