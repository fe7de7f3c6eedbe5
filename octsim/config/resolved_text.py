"""A whole config as a person reads it: YAML with units, and beside what is set its default."""

from collections.abc import Iterator, Mapping
from typing import Any

import yaml

from octsim.config.following import (
    calibration_diameters,
    fitted_diameters,
    scan_diameter,
    scan_foci,
)
from octsim.config.grid import combinations, value_at
from octsim.config.models import Config
from octsim.config.units import format_length

_WIDTH = 100


def resolved_lines(config: Config) -> list[str]:
    """Return a config as lines of YAML that `load_config` reads back to the same config.

    A comment says what the thesis has, where that is something else, and what follows the sweep.
    """
    return [*_lines(config.to_dict(), Config().to_dict(), "", _followed(config))]


def _followed(config: Config) -> dict[str, str]:
    """Return what each key is that follows the sweep, of the first combination of a grid."""
    first = next(combinations(config)).config
    every = {
        "focus_scan.diameter": format_length(scan_diameter(first)),
        "focus_scan.focus": _text(scan_foci(first).model_dump(mode="json")),
        "focus_law.diameters": _text(fitted_diameters(first).model_dump(mode="json")),
        "calibration.diameters": _text(calibration_diameters(first).model_dump(mode="json")),
    }
    return {key: text for key, text in every.items() if value_at(first, key) is None}


def _lines(
    data: Mapping[str, Any], default: Any, indent: str, followed: Mapping[str, str], path: str = ""
) -> Iterator[str]:
    for key, value in data.items():
        usual = default.get(key) if isinstance(default, Mapping) else None
        line = f"{indent}{key}: {_text(value)}"
        nests = isinstance(value, Mapping) and value
        if nests and (not indent or len(line) > _WIDTH or _differs_within(value, usual)):
            yield f"{indent}{key}:"
            yield from _lines(value, usual, indent + "  ", followed, f"{path}{key}.")
            continue
        if of_sweep := followed.get(f"{path}{key}"):
            yield f"{line}  # follows the sweep: {of_sweep}"
            continue
        known = isinstance(default, Mapping) and key in default
        yield f"{line}  # thesis: {_text(usual)}" if known and value != usual else line


def _differs_within(value: Mapping[str, Any], usual: Any) -> bool:
    """Return whether some of a section's own keys are set: then each has a line."""
    return isinstance(usual, Mapping) and value != usual and value.keys() == usual.keys()


def _text(value: Any) -> str:
    """Write a value as YAML in one line, keys as they come."""
    text: str = yaml.safe_dump(
        value, default_flow_style=True, width=10_000, sort_keys=False, allow_unicode=True
    )
    return text.removesuffix("...\n").strip()


def differing(config: Config) -> dict[str, Any]:
    """Return what of a config is not as the thesis has it, as plain data of its own shape."""
    return _differing(config.to_dict(), Config().to_dict())


def _differing(data: Mapping[str, Any], usual: Mapping[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in data.items():
        other = usual.get(key)
        if isinstance(value, Mapping) and isinstance(other, Mapping):
            if within := _differing(value, other):
                found[key] = within
        elif value != other:
            found[key] = value
    return found
