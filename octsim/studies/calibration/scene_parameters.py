"""A number of the scene that may differ from what is believed, by its dotted key."""

import math
from collections.abc import Callable
from functools import cache, lru_cache
from typing import NamedTuple

from octsim.base.errors import ConfigError
from octsim.config.derive import changed, nested
from octsim.config.models import Config
from octsim.config.scene_keys import quantity_of, scene_values
from octsim.config.scheme import scheme_of
from octsim.schemes.table import Ability
from octsim.studies.calibration.parameter import (
    Overlay,
    Parameter,
    above_aperture,
    index_of,
)

_INDEX = "scene.refractive_index."
_FARTHEST = 3.0
"""Tolerances from what is believed, within which it is looked where a scene is possible."""
_HALVINGS = 40


class _Kind(NamedTuple):
    """What numbers of a scene are of one kind."""

    step: float
    """Largest change, for a derivative."""
    least: float
    """Below which none can be."""
    ability: Ability | None = None
    """What schemes can that see them; None where all do."""


_KINDS = {
    "gap": _Kind(1e-3, 0.0),
    "x": _Kind(0.01, -math.inf, Ability.OFF_AXIS),
    "diameter": _Kind(2e-3, 1e-6),
    "thickness": _Kind(1e-3, 1e-6),
    "azimuth": _Kind(0.01, -6.3, Ability.AZIMUTH),
    "elevation": _Kind(0.01, -1.5, Ability.ELEVATION),
}
"""By the last part of their keys."""
_ATTENUATION = _Kind(1e-3, 0.0)


@cache
def scene_parameter(key: str) -> Parameter:
    """Return the parameter that a number of the scene is; only where it is one it counts."""
    if key.startswith(_INDEX):
        medium = key.removeprefix(_INDEX)

        def limits(config: Config) -> tuple[float, float]:
            if medium != config.objective.immersion:
                return -math.inf, math.inf
            return above_aperture(config, scene_values(config)[key])

        return index_of(
            lambda _: medium, limits=limits, counts=lambda config: key in scene_values(config)
        )
    kind, quantity = _kind_of(key), quantity_of(key)
    unit = "1" if quantity is None else quantity.unit

    def counts(config: Config) -> bool:
        able = kind.ability is None or kind.ability in scheme_of(config).honours
        return able and key in scene_values(config)

    return Parameter(
        kind.step,
        lambda config: scene_values(config)[key],
        lambda _, value: _overlay(key, value),
        lambda config: _limits(config.model_dump_json(), key),
        counts,
        unit,
    )


def _kind_of(key: str) -> _Kind:
    return _KINDS.get(key.rpartition(".")[2], _ATTENUATION)


def _overlay(key: str, value: float) -> Overlay:
    quantity = quantity_of(key)
    return nested(key, value if quantity is None else f"{value!r} {quantity.unit}")


@lru_cache(maxsize=256)  # by what a config is, as it has no hash
def _limits(record: str, key: str) -> tuple[float, float]:
    """Return the least and the most that a number of the scene may be, as far as it is looked."""
    config, kind = Config.model_validate_json(record), _kind_of(key)
    tolerances, at = config.calibration.tolerances, scene_values(config)[key]
    reach = max(kind.step, _FARTHEST * tolerances.of.get(key, 0.0))

    def possible(value: float) -> bool:
        try:
            changed(config, _overlay(key, value))
        except ConfigError:
            return False
        return True

    # others may come as near from their sides, all of them at once
    nearest = 1 / (2 + len(tolerances.of_scene))
    below = _room(lambda by: possible(at - by), min(reach, at - kind.least), nearest)
    return at - below, at + _room(lambda by: possible(at + by), reach, nearest)


def _room(possible: Callable[[float], bool], reach: float, nearest: float) -> float:
    """Return how far something can be moved: all of the reach, or some of what is possible."""
    if possible(reach):
        return reach
    least, most = 0.0, reach
    for _ in range(_HALVINGS):
        middle = (least + most) / 2
        least, most = (middle, most) if possible(middle) else (least, middle)
    return nearest * least
