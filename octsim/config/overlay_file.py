"""Files that hold a config, or a part of one: read in bounds, or refused in one line."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from octsim.base.errors import ConfigError, printable
from octsim.base.files import read_bounded, reason
from octsim.config.bounds import MOST_BYTES, require_bounded
from octsim.config.yaml_text import read_text


def read_overlay(path: Path) -> Mapping[str, Any]:
    """Read what a YAML or JSON file holds.

    Raises
    ------
    ConfigError
        If it can't be read, or does not hold keys with values: one line, with the file and, where
        something in it is wrong, the line and the column.
    """
    try:
        content = read_text(_text(path))
    except ConfigError as error:
        raise ConfigError(f"{printable(path)}{error}") from None
    if content is None:
        return {}
    name = printable(path)
    if not isinstance(content, Mapping):
        raise ConfigError(
            f"{name}: holds {_kind(content)}, not keys with values; write it as in "
            "config/default.yaml"
        )
    try:
        require_bounded(content)
    except ConfigError as error:
        raise ConfigError(f"{name}: {error}") from None
    return content


def _kind(content: object) -> str:
    kinds = {list: "a list", str: "text", bool: "true or false", int: "a number", float: "a number"}
    return kinds.get(type(content), f"a {type(content).__name__}")


def _text(path: Path) -> str:
    """Return the text of a file."""
    try:
        data = read_bounded(path, MOST_BYTES)
    except OSError as error:
        raise ConfigError(f": can't be read ({reason(error)}); give a YAML file") from None
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        kind = " but UTF-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else ""
        raise ConfigError(
            f", line {line}: it is not text in UTF-8{kind}; save it as that"
        ) from None
