"""A config by the scheme fullwave, and what that can't do of it."""

from octsim.config.checks import impossible
from octsim.config.derive import by_waves
from octsim.config.models import Config
from octsim.schemes.table import FULL_WAVE


def by_maxwell(config: Config, accuracy: float = FULL_WAVE.presets["exact"]["accuracy"]) -> Config:
    """Return a plain config, not checked, whose light is found by Maxwell's equations."""
    exact = by_waves(config)
    tracing = exact.tracing.model_copy(update={"accuracy": accuracy})
    return exact.model_copy(update={"tracing": tracing})


def beyond_maxwell(config: Config) -> str:
    """Say in a line why Maxwell's equations are not solved for a plain config; empty if they are.

    Examples
    --------
    >>> beyond_maxwell(Config())
    ''
    """
    return next(iter(impossible(by_maxwell(config))), "")
