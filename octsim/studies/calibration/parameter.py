"""What of the instrument and the neuron may differ from what is believed: what a row of it is."""

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from octsim.config.derive import nested, part_of
from octsim.config.dispersion import moved
from octsim.config.grid import value_at
from octsim.config.models import Config
from octsim.config.units import format_length

Overlay = Mapping[str, Any]


def _anything(_: Config) -> tuple[float, float]:
    return -math.inf, math.inf


def above_aperture(config: Config, index: float) -> tuple[float, float]:
    """Return the limits of an index that the numerical aperture stays below."""
    return max(1.0, (index + config.objective.numerical_aperture) / 2), 10.0


class Parameter(NamedTuple):
    """Something that may be off, and how a config is changed to have it so."""

    step: float
    """Largest change, for a derivative."""
    believed: Callable[[Config], float]
    """Returns what it is in a config."""
    overlay: Callable[[Config, float], Overlay]
    """Returns what makes it some value in a config."""
    limits: Callable[[Config], tuple[float, float]] = _anything
    """Returns the least and the most that it may be, with the others within theirs."""
    counts: Callable[[Config], bool] = lambda _: True
    """Returns whether a config's scheme sees it."""
    unit: str = "um"
    """um, rad, or 1."""


def keyed(step: float, key_of: Callable[[Config], str], **others: Any) -> Parameter:
    """Return a parameter that is a key of the config."""

    def overlay(config: Config, value: float) -> Overlay:
        key = key_of(config)
        as_text = isinstance(part_of(config.to_dict(), key), str)
        return nested(key, format_length(value) if as_text else value)

    def believed(config: Config) -> float:
        return float(value_at(config, key_of(config)))

    return Parameter(step, believed, overlay, **others)


def index_of(medium_of: Callable[[Config], str], **others: Any) -> Parameter:
    """Return a parameter that is the index of a medium, as dispersive as it is believed to be."""

    def believed(config: Config) -> float:
        material = config.scene.refractive_index.of[medium_of(config)]
        return material.index(config.spectrum.middle).real

    def overlay(config: Config, value: float) -> Overlay:
        medium = medium_of(config)
        given = config.scene.refractive_index.given[medium]
        index = moved(given, value, config.spectrum.middle)
        return nested(f"scene.refractive_index.{medium}", index)

    given: dict[str, Any] = {"limits": lambda _: (1.0, 10.0), "unit": "1"} | others
    return Parameter(1e-3, believed, overlay, **given)
