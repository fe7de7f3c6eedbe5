"""A config that varies its keys: the axes of the grid, and the config at each combination."""

import itertools
import json
import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from octsim.base.errors import ConfigError
from octsim.config.checks import plain_remarks
from octsim.config.configs_at import ConfigsAt
from octsim.config.derive import bears_on
from octsim.config.fields import as_text as as_text
from octsim.config.models import FIXED as FIXED
from octsim.config.models import Config

_NUMBERS = re.compile(r"[-+]?[0-9][0-9.e+-]*")


class Axis(NamedTuple):
    """One dimension of the grid."""

    keys: tuple[str, ...]
    """Dotted keys that vary along it: one, or those that are zipped."""
    rows: tuple[tuple[Any, ...], ...]
    """Value of each key, as plain data, at each position."""
    zipped: bool = False
    """Whether all keys of the grid vary along it together."""


class Combination(NamedTuple):
    """One point of the grid."""

    position: tuple[int, ...]
    """Position along each axis."""
    values: Mapping[str, Any]
    """What each varied key is, as plain data."""
    config: Config
    """The config there, without a grid."""

    def __str__(self) -> str:
        return ", ".join(f"{key} = {as_text(value)}" for key, value in self.values.items())


def value_at(config: Config, key: str) -> Any:
    """Return what a dotted key of a config is, in its own units; None if it has no such part."""
    value: Any = config
    for name in key.split("."):
        if isinstance(value, tuple) and name.isdigit():
            value = value[int(name)] if int(name) < len(value) else None
        else:
            value = getattr(value, name, None)
    return value


def axes(config: Config, *keys: str) -> tuple[Axis, ...]:
    """Return the axes of a config's grid.

    Parameters
    ----------
    config : Config
        A checked config.
    *keys : str
        Dotted keys: only what varies these, or parts of them, counts. Without any, all does.
    """
    varied = {key: tuple(config.grid.varied[key]) for key in varied_keys(config, *keys)}
    if config.grid.combine == "product":
        return tuple(
            Axis((key,), tuple((value,) for value in values)) for key, values in varied.items()
        )
    if not varied:
        return ()
    # of rows that only differ in what does not count, one is enough
    rows = {row_text(row): row for row in zip(*varied.values(), strict=True)}
    return (Axis(tuple(varied), tuple(rows.values()), zipped=True),)


def varied_keys(config: Config, *keys: str) -> tuple[str, ...]:
    """Return the keys that the grid's axes have, as far as it varies some keys (`axes`)."""
    return tuple(key for key in config.grid.varied if not keys or bears_on(key, *keys))


def row_text(row: tuple[Any, ...]) -> str:
    """Write the values of a row so that others are written otherwise, a hundred times as fast."""
    return json.dumps(row, sort_keys=True, default=str)


def combinations(config: Config, *keys: str) -> Iterator[Combination]:
    """Return each combination of the grid, as far as it varies some keys; the last axis fastest.

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config({"grid": {"scene.gap": ["5 nm", "20 nm"]}})
    >>> [one.config.scene.gap for one in octsim.combinations(config)]
    [0.005, 0.02]
    """
    if not config.grid.varied:
        yield Combination((), {}, config)
        return
    along = axes(config, *keys)
    configs = ConfigsAt({**config.to_dict(), "grid": {}})
    for position in itertools.product(*(range(len(axis.rows)) for axis in along)):
        values = {
            key: value
            for axis, row in zip(along, position, strict=True)
            for key, value in zip(axis.keys, axis.rows[row], strict=True)
        }
        yield Combination(position, values, configs.at(values))


class Remarks:
    """What is possible but likely not meant, of combinations that are added one after the other."""

    def __init__(self) -> None:
        self._said: dict[str, list[str]] = {}
        self._total = 0

    def add(self, config: Config) -> None:
        """Add what is to be said of a combination's config."""
        self._total += 1
        for remark in plain_remarks(config):
            self._said.setdefault(_NUMBERS.sub("", remark), []).append(remark)

    def lines(self) -> list[str]:
        """Return a line for each that is alike but for its numbers."""
        return [
            f"{lines[0]} (at {len(lines)} of {self._total} combinations)"
            for lines in self._said.values()
        ]


def remarks(config: Config) -> list[str]:
    """Return what is possible but likely not meant, a line each, of all combinations together."""
    if not config.grid.varied:
        return plain_remarks(config)
    said = Remarks()
    for combination in combinations(config):
        said.add(combination.config)
    return said.lines()


def without_grid(config: Config, target: str) -> Config:
    """Return a config that varies nothing.

    Raises
    ------
    ConfigError
        If it varies something, as a target of a single config can't.
    """
    if config.grid.varied:
        keys = ", ".join(config.grid.varied)
        raise ConfigError(
            f"grid: {keys} given, but {target} is of a single config; ask for it in a config "
            "without a grid"
        )
    return config
