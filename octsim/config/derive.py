"""Configs as plain data: what stands under dotted keys, and configs made from others."""

import functools
import itertools
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from octsim.base.errors import ConfigError
from octsim.config.abilities import as_far_as
from octsim.config.bounds import bounded
from octsim.config.checks import require_possible
from octsim.config.messages import explain
from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.schemes.table import COUNTED_RAYS, FULL_WAVE, LIGHT_PATHS, PRESETS

_PRESET = "tracing.preset"
_SET_BY_PRESETS = sorted({f"tracing.{key}" for preset in PRESETS.values() for key in preset})


def part_of(data: Mapping[str, Any], key: str) -> Any:
    """Return what stands under a dotted key of a config's plain data, or None."""
    part: Any = data
    for name in key.split("."):
        if isinstance(part, list) and name.isdigit() and int(name) < len(part):
            part = part[int(name)]
        else:
            part = part.get(name) if isinstance(part, Mapping) else None
    return part


def parts_of(data: Mapping[str, Any], *keys: str) -> dict[str, object]:
    """Return what stands under dotted keys of a config's plain data, and how they are varied."""
    grid = data.get("grid", {})
    varied = {
        f"grid.{key}": value
        for key, value in grid.items()
        if key != "combine" and bears_on(key, *keys)
    }
    how = {"grid.combine": grid["combine"]} if varied else {}
    return {key: part_of(data, key) for key in keys} | varied | how


def overlap(one: str, other: str) -> bool:
    """Return whether one of two dotted keys is the other, or holds it."""
    return f"{one}.".startswith(f"{other}.") or f"{other}.".startswith(f"{one}.")


def bears_on(key: str, *read: str) -> bool:
    """Return whether a varied key sets any of some others, or parts of them."""
    # a preset stands for other keys
    sets = (key, *_SET_BY_PRESETS) if key == _PRESET else (key,)
    return any(overlap(one, other) for one in sets for other in read)


def nested(key: str, value: object) -> dict[str, Any]:
    """Return the overlay that sets one dotted key.

    Examples
    --------
    >>> nested("scene.gap", "5 nm")
    {'scene': {'gap': '5 nm'}}
    """
    first, _, rest = key.partition(".")
    return {first: nested(rest, value) if rest else value}


def nested_all(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the overlay that sets some dotted keys."""
    return functools.reduce(merge, itertools.starmap(nested, values.items()), {})


def merge(base: Mapping[str, Any], overlay: Mapping[str, Any]) -> dict[str, Any]:
    """Lay one mapping over another: mappings merge deeply, everything else replaces.

    Of a list, a mapping from places in it, as text, replaces entries, or parts of them; and of a
    range, a number of values the step between them, or the step the number.
    """
    replaced = {_INSTEAD[key] for key in overlay if key in _INSTEAD}
    kept = {key: value for key, value in base.items() if key not in replaced - overlay.keys()}
    return {**kept, **{key: _laid(base.get(key), value) for key, value in overlay.items()}}


_INSTEAD = {"num": "step", "step": "num"}
"""What of a range replaces what."""


def _laid(below: Any, value: Any) -> Any:
    if isinstance(value, str) or not isinstance(value, Mapping):
        return value
    if isinstance(below, list) and value and value.keys() <= {str(i) for i in range(len(below))}:
        return [_laid(part, value.get(str(place), part)) for place, part in enumerate(below)]
    return merge(below, value) if isinstance(below, Mapping) else value


def overlaid(base: Mapping[str, Any], overlay: Mapping[str, Any]) -> dict[str, Any]:
    """Lay an overlay over a config's plain data, and below it what a preset it names stands for."""
    tracing = overlay.get("tracing")
    name = tracing.get("preset") if isinstance(tracing, Mapping) else None
    below = merge(base, {"tracing": PRESETS.get(name, {})}) if isinstance(name, str) else base
    return merge(below, overlay)


def validated(data: Mapping[str, Any]) -> Config:
    """Return the config of plain data, each key checked.

    Raises
    ------
    ConfigError
        If a key is unknown or a value wrong; one line for each problem.
    """
    try:
        return Config.model_validate(data)
    except ValidationError as error:
        raise ConfigError(*bounded(map(explain, error.errors()))) from None


def config_at(base: Mapping[str, Any], values: Mapping[str, Any]) -> Config:
    """Return a config, of plain data, with some dotted keys at other values.

    Raises
    ------
    ValidationError
        If a value is wrong.
    """
    return Config.model_validate(overlaid(base, nested_all(values)))


def changed(config: Config, *overlays: Mapping[str, Any]) -> Config:
    """Return a config with overlays laid over it, checked without remarks: the run's are made.

    Raises
    ------
    ConfigError
        If a value is wrong, or the whole impossible.
    """
    data = config.to_dict()
    for overlay in overlays:
        data = merge(data, overlay)
    other = validated(data)
    if not other.grid.varied:
        require_possible(other)
    return other


def calibrating(config: Config) -> Processing:
    """Return the run's processing with the calibration's estimator."""
    return config.processing.model_copy(update={"estimator": config.calibration.estimator})


def with_flat_source(config: Config) -> Config:
    """Return a config whose source is flat, as what is compared with a formula for one needs."""
    return config.model_copy(
        update={"spectrum": config.spectrum.model_copy(update={"source": "flat"})}
    )


def by_rays(config: Config, rays: int) -> Config:
    """Return a config that counts some number of rays."""
    asked = {"preset": None, "scheme": COUNTED_RAYS.name, "rays": rays}
    return changed(as_far_as(COUNTED_RAYS, config), {"tracing": asked})


def counting_rays(config: Config) -> Config:
    """Return a config that counts as many rays as its key ``tracing.rays`` says."""
    tracing = config.tracing.model_copy(update={"scheme": COUNTED_RAYS.name})
    return as_far_as(COUNTED_RAYS, config).model_copy(update={"tracing": tracing})


def by_accuracy(config: Config, accuracy: float, **tracing: int) -> Config:
    """Return a config that integrates light paths to an accuracy."""
    asked = {"preset": None, "scheme": LIGHT_PATHS.name, "accuracy": accuracy}
    return changed(as_far_as(LIGHT_PATHS, config), {"tracing": asked | tracing})


def by_light_paths(config: Config) -> Config:
    """Return a config whose light is that of the light paths, at their preset standard."""
    tracing = config.tracing.model_copy(
        update={"scheme": LIGHT_PATHS.name, **LIGHT_PATHS.presets["standard"]}
    )
    return as_far_as(LIGHT_PATHS, config).model_copy(update={"tracing": tracing})


def by_waves(config: Config) -> Config:
    """Return a config of the scheme fullwave, at its preset exact."""
    tracing = config.tracing.model_copy(
        update={"scheme": FULL_WAVE.name, **FULL_WAVE.presets["exact"]}
    )
    return as_far_as(FULL_WAVE, config).model_copy(update={"tracing": tracing})


def reference(config: Config) -> Config:
    """Return the config whose results errors are measured from."""
    most = max(15, config.tracing.max_intersections)
    return by_accuracy(config, 1e-9, max_intersections=most)
