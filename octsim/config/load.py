"""From a user's overlay to a checked config, or to one clear line for each problem."""

import re
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from octsim.base.errors import ConfigError, OctsimWarning, one_line
from octsim.base.files import require_regular
from octsim.config.checks import require_possible
from octsim.config.derive import merge, overlaid, validated
from octsim.config.fields import plain_data
from octsim.config.grid import remarks
from octsim.config.grid_values import expanded
from octsim.config.models import Config
from octsim.config.study_checks import wrong_for_studies
from octsim.config.unread import asked_for, unread, unread_scene


class _Loader(yaml.SafeLoader):
    """YAML in which a key may stand only once."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        merge = "tag:yaml.org,2002:merge"  # `<<`, which may well stand beside what it brings
        lines: dict[Any, int] = {}
        for own in (key for key, _ in node.value if key.tag != merge):
            key, line = self.construct_object(own, True), own.start_mark.line + 1
            if key in lines:
                before = f"first in line {lines[key]}; keep one of them"
                raise yaml.constructor.ConstructorError(
                    None, None, f"the key '{key}' stands twice, {before}", own.start_mark
                )
            lines[key] = line
        return super().construct_mapping(node, deep)


def read_overlay(path: Path) -> Mapping[str, Any]:
    """Read what a YAML or JSON file holds.

    Raises
    ------
    ConfigError
        If it can't be read, or does not hold keys with values.
    """
    try:
        require_regular(path)
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


_AFTER_COMMA = re.compile(r"[0-9]+( ?[^\W\d]\S*)?")


def require_points(given: Any, prefix: str = "") -> None:
    """Refuse what YAML makes of a decimal comma in braces: 1 for a key, and 39 as the next key.

    Raises
    ------
    ConfigError
        If there is one.
    """
    before: tuple[Any, Any] | None = None
    if isinstance(given, list):
        given = dict(enumerate(given))
    for key, value in given.items() if isinstance(given, Mapping) else ():
        if before and value is None and _AFTER_COMMA.fullmatch(str(key)):
            name, whole = before
            if isinstance(whole, int) and not isinstance(whole, bool):
                raise ConfigError(
                    f"{prefix}{name}: {whole},{key} given; write it with a point, as {whole}.{key}"
                )
        require_points(value, f"{prefix}{key}.")
        before = key, value


def load_config(*overlays: str | Path | Mapping[str, Any]) -> Config:
    """Lay overlays over the thesis's config and check the result.

    Parameters
    ----------
    *overlays : path or mapping
        YAML or JSON files, or what they would hold; a later one wins. Mappings merge deeply,
        everything else replaces.

    Returns
    -------
    Config
        The whole config, frozen; lengths in µm.

    Raises
    ------
    ConfigError
        If a file can't be read, a key is unknown, or a value has the wrong type, lacks its unit or
        is impossible. Its text has one line for each problem: key path, what was given, what to do.

    Warns
    -----
    OctsimWarning
        If something is possible but likely not meant, such as a diameter step that is so large that
        the unwrapped phase is ambiguous, or a key that is given and not read.

    Examples
    --------
    >>> load_config({"scene": {"gap": "20 nm"}}).scene.gap
    0.02
    """
    config, said = load_and_tell(*overlays)
    for remark in said:
        warnings.warn(remark, OctsimWarning, stacklevel=2)
    return config


def load_and_tell(*overlays: str | Path | Mapping[str, Any]) -> tuple[Config, list[str]]:
    """Return the config as `load_config` does, and what that warns of, a line each."""
    given: dict[str, Any] = {}
    asked: dict[str, Any] = {}
    for overlay in overlays:
        own = overlay if isinstance(overlay, Mapping) else read_overlay(Path(overlay))
        own = plain_data(own)
        require_points(own)
        asked |= asked_for(own, given)
        given = merge(given, own)
    config = validated(overlaid(Config().to_dict(), given))
    if config.grid.varied:
        config = expanded(config)
    else:
        require_possible(config)
    # here alone: studies of other scenes leave out what these do not have
    if wrong := list(wrong_for_studies(config)):
        raise ConfigError(*wrong)
    said = [*remarks(config), *unread(config, asked), *unread_scene(config, asked)]
    return config, list(map(one_line, said))
