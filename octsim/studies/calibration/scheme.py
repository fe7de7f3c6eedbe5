"""By which scheme a calibration finds its spectra: Maxwell's equations, or rays where it must."""

from collections.abc import Mapping
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import ConfigError
from octsim.config.abilities import asked_of_scheme
from octsim.config.derive import by_accuracy
from octsim.config.maxwell import beyond_maxwell, by_maxwell
from octsim.config.models import Config
from octsim.config.scheme import cost_by, options_of, scheme_of
from octsim.schemes.light import AccuracyStatus
from octsim.schemes.table import FULL_WAVE, LIGHT_PATHS

ACCURACY: Mapping[str, float] = {FULL_WAVE.name: 1e-6, LIGHT_PATHS.name: 1e-8}
"""Of the spectra, by scheme, so that slopes over 0.1 nm are sure to 1e-5 mrad/nm: the error of
waves is the same on both sides of so small a step, that of light paths is not."""
MISSED = (AccuracyStatus.BUDGET_SPENT, AccuracyStatus.NOT_REACHED)
"""Of spectra whose slopes' errors are not known."""
MODEL = "model"
"""Line of the budget: how far rays are from Maxwell's equations."""


class ModelStatus(IntEnum):
    """What is known of the error of the scheme itself."""

    BY_MAXWELL = 0
    """None: the slope is by Maxwell's equations."""
    COMPARED = 1
    """The slope is by rays; how far it is from Maxwell's is part of its standard error."""
    NOT_COMPARED = 2
    """The slope is by rays where Maxwell's equations are not solved; its error is not known."""


class SlopeErrorStatus(IntEnum):
    """Whether the standard error of a slope is known."""

    KNOWN = 0
    NOT_REACHED = 1
    """The accuracy is not reached; accuracy_status says why."""
    NOT_COMPARED = 2
    """The slope is by rays where Maxwell's equations are not solved."""


class OtherSchemeStatus(IntEnum):
    """Whether there is a slope by another scheme, or of one side's light."""

    KNOWN = 0
    BEYOND_SCHEME = 1
    """The scheme can't do the scene or the instrument."""
    NOT_REACHED = 2
    """Its accuracy is not reached."""
    NO_LIGHT = 3
    """The side returns none."""


def rays_because(config: Config) -> str:
    """Say in a line why a calibration's spectra are of rays; empty where they are Maxwell's."""
    if config.calibration.scheme == LIGHT_PATHS.name:
        return f"calibration.scheme: {LIGHT_PATHS.name} given"
    return beyond_maxwell(config)


def converged(config: Config) -> Config:
    """Return the config of the same instrument, solved as accurately as small steps need.

    Raises
    ------
    ConfigError
        If the scheme that ``calibration.scheme`` names can't do what the config asks for.
    """
    reason = rays_because(config)
    if not reason:
        return waves_of(config)
    if config.calibration.scheme == FULL_WAVE.name:
        raise ConfigError(
            f"calibration.scheme: {FULL_WAVE.name} given, but it can't do this scene: {reason}"
        )
    if config.calibration.scheme == LIGHT_PATHS.name:
        for asked in asked_of_scheme(config):
            if asked.ability not in LIGHT_PATHS.honours:
                raise ConfigError(
                    f"calibration.scheme: {LIGHT_PATHS.name} given, which {asked.ability.value}, "
                    f"and {asked.key}: {asked.given} is given; leave one of the two out"
                )
    return paths_of(config)


def require_budget(
    config: Config, section: str, what: str, spectra: int, diameters: NDArray[np.float64]
) -> None:
    """Refuse what takes longer than is confirmed.

    Parameters
    ----------
    config : Config
    section : str
        Whose diameters they are.
    what : str
        Takes that long, with a place for the scheme's name.
    spectra : int
        At each diameter.
    diameters : ndarray, shape (D,)
        µm.

    Raises
    ------
    ConfigError
        If it takes longer than ``budget.cpu_hours``.
    """
    scheme, options, most = scheme_of(config), options_of(config), config.budget.cpu_hours
    each = (cost_by(scheme, options, config, d).seconds for d in diameters.tolist())
    seconds = spectra * sum(each)
    hours = seconds / 3600
    if hours > most:
        raise ConfigError(
            f"budget.cpu_hours: {most:g} given, but {what.format(scheme.name)} about "
            f"{hours:.2g} h; raise it to confirm, or give fewer {section}.diameters"
        )


def waves_of(config: Config) -> Config:
    """Return the config solved by Maxwell's equations."""
    return by_maxwell(config, ACCURACY[FULL_WAVE.name])


def paths_of(config: Config) -> Config:
    """Return the config by light paths, without what these can't do of it."""
    return by_accuracy(config, ACCURACY[LIGHT_PATHS.name])
