"""A config however it is given: itself, a file's name, or what a file would hold."""

from collections.abc import Callable, Mapping
from functools import wraps
from os import PathLike
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from octsim.base.errors import ConfigError
from octsim.config.load import load_config
from octsim.config.models import Config

_Parameters = ParamSpec("_Parameters")
_Result = TypeVar("_Result")


def config_of(given: Any) -> Config:
    """Return the config that is given: as one, as a YAML file's name, or as a mapping of keys.

    Raises
    ------
    ConfigError
        If it is none, or one that can't be used.
    """
    if isinstance(given, Config):
        return given
    if isinstance(given, str | PathLike):
        return load_config(Path(given))
    if isinstance(given, Mapping):
        return load_config(given)
    raise ConfigError(
        f"config: a {type(given).__name__} given; give octsim.load_config('mine.yaml'), the "
        "file's name, or a mapping of keys"
    )


def taking_config(
    work: Callable[_Parameters, _Result],
) -> Callable[_Parameters, _Result]:
    """Let a function's first argument, its config, be given in any of these ways."""

    @wraps(work)
    def taking(*arguments: _Parameters.args, **keywords: _Parameters.kwargs) -> _Result:
        return work(*with_config(arguments), **with_named_config(keywords))

    return taking


def with_config(arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return arguments whose first, where there is one, is a config."""
    return (config_of(arguments[0]), *arguments[1:]) if arguments else arguments


def with_named_config(keywords: Mapping[str, Any]) -> dict[str, Any]:
    """Return keywords whose ``config``, where there is one, is a config."""
    return {key: config_of(one) if key == "config" else one for key, one in keywords.items()}
