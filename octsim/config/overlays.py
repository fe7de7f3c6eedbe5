"""Overlays: what a user writes on top of the defaults, from files and mappings."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from octsim.base.errors import ConfigError
from octsim.schemes.table import PRESETS


def preset(given: Mapping[str, Any]) -> Mapping[str, Any]:
    """Give what a named preset stands for; keys given beside it go above."""
    tracing = given.get("tracing")
    name = tracing.get("preset") if isinstance(tracing, Mapping) else None
    return {"tracing": PRESETS.get(name, {})} if isinstance(name, str) else {}


class _Loader(yaml.SafeLoader):
    """YAML in which a key may stand only once."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        merge = "tag:yaml.org,2002:merge"  # `<<`, which may well stand beside what it brings
        keys = [self.construct_object(key, True) for key, _ in node.value if key.tag != merge]
        for key in keys:
            if keys.count(key) > 1:
                raise yaml.constructor.ConstructorError(
                    None, None, f"the key '{key}' stands twice", node.start_mark
                )
        return super().construct_mapping(node, deep)


def read_overlay(path: Path) -> Mapping[str, Any]:
    """Read what a YAML or JSON file holds.

    Raises
    ------
    ConfigError
        If it can't be read, or does not hold keys with values.
    """
    try:
        content = yaml.load(path.read_text(encoding="utf-8"), _Loader)
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise ConfigError(f"{path}: can't be read ({reason}); give a YAML file") from None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        problem = " ".join((error.problem or "not YAML").split())
        raise ConfigError(f"{path}{place}: not as YAML should be: {problem}") from None
    except yaml.YAMLError as error:
        raise ConfigError(f"{path}: not YAML: {' '.join(str(error).split())}") from None
    except ValueError as error:
        raise ConfigError(f"{path}: holds a date that there is not: {error}") from None
    if content is None:
        return {}
    if not isinstance(content, Mapping):
        raise ConfigError(
            f"{path}: holds a {type(content).__name__}, not keys with values; "
            "write it as in config/default.yaml"
        )
    return content


def merge(base: Mapping[str, Any], overlay: Mapping[str, Any]) -> dict[str, Any]:
    """Lay one mapping over another: mappings merge deeply, everything else replaces."""
    merged = dict(base)
    for key, value in overlay.items():
        below = merged.get(key)
        if isinstance(below, Mapping) and isinstance(value, Mapping):
            value = merge(below, value)
        merged[key] = value
    return merged
