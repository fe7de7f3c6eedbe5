"""Values of a grid: written out as lists and checked, each alone and all combinations."""

import contextlib
import itertools
import math
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import ValidationError

from octsim.base.errors import ConfigError
from octsim.base.waiting import uncollected, watched
from octsim.config.checks import impossible
from octsim.config.configs_at import ConfigsAt
from octsim.config.derive import overlap, part_of
from octsim.config.grid import (
    Combination,
    Remarks,
    as_text,
    axes,
    combinations,
    row_text,
    value_at,
)
from octsim.config.grid_keys import plain_key, require_varied
from octsim.config.known_keys import known_keys
from octsim.config.messages import explain
from octsim.config.models import Config, Grid
from octsim.config.ranges import counted, evenly
from octsim.config.units import ANGLE, ATTENUATION, LENGTH, RATIO, Quantity, parse

MOST = 100_000
"""Combinations of one grid."""
_RANGES = ({"start", "stop", "num"}, {"start", "stop", "step"})
_SHOWN = 5  # problems of combinations that are listed
_LOOKING = "looking at the grid"
_COUNTED = 1000  # of more of them, it is said that they are many


@uncollected()
def expanded(config: Config, *, whole: bool = True) -> tuple[Config, list[str]]:
    """Check a config's grid as a whole, and write its values out as lists in the config's units.

    Parameters
    ----------
    config : Config
        A config whose sections are checked.
    whole : bool
        Whether each combination is looked at, and not the values alone.

    Returns
    -------
    config : Config
    remarks : list of str
        What is possible but likely not meant (`octsim.config.grid.remarks`), if all is looked at.

    Raises
    ------
    ConfigError
        If a key is unknown or can't be varied, its values are none or wrong, or a combination is
        impossible. One line for each problem.
    """
    listed: dict[str, list[Any]] = {}
    for given_key, values in config.grid.varied.items():
        key = plain_key(given_key)
        if key in listed:
            raise ConfigError(f"grid.{given_key}: given beside grid.{key}, and both set the same")
        listed[key] = _listed(config, key, values)
    _check_keys(config, listed)
    given = config.model_copy(update={"grid": _grid(config, listed)})
    problems: dict[str, None] = {}
    plain = {key: list(values) for key, values in listed.items()}
    configs = ConfigsAt({**given.to_dict(), "grid": {}})
    looked = _Looked(whole)
    # along one axis, what a value is tried in is a combination, and is looked at while it is there
    alone = _zipped(config) or len(listed) == 1
    tried = max(map(len, listed.values())) if alone else sum(map(len, listed.values()))
    for position, keys, values in watched(_tried(listed, together=alone), tried, _LOOKING):
        try:
            one = configs.at(values)
        except ValidationError as error:
            for line in map(explain, error.errors()):
                of_grid = any(overlap(line.split(":")[0], other) for other in listed)
                problems[f"grid.{line}" if of_grid else line] = None
            if len(problems) > _COUNTED:
                _raise(problems)
        else:
            for key in keys:
                plain[key][position] = _plain_at(one, key)
            if alone and not problems:
                there = {key: plain[key][position] for key in keys}
                looked.at(Combination((position,), there, one))
    _raise(problems)
    checked = given.model_copy(update={"grid": _grid(config, plain)})
    _check_rows(checked)
    if whole and not alone:
        every = math.prod(map(len, plain.values()))
        for combination in watched(combinations(checked), every, _LOOKING):
            looked.at(combination)
    _raise(looked.problems)
    return checked, looked.remarks.lines()


class _Looked:
    """What is wrong with combinations, and what is likely not meant.

    Parameters
    ----------
    whole : bool
        Whether they are looked at.
    """

    def __init__(self, whole: bool) -> None:
        self.problems: dict[str, None] = {}
        self.remarks = Remarks()
        self._whole = whole

    def at(self, combination: Combination) -> None:
        """Look at one."""
        if not self._whole or len(self.problems) > _COUNTED:
            return
        for line in impossible(combination.config):
            self.problems[f"grid, at {combination}: {line}"] = None
        if not self.problems:  # else nothing but these is said
            self.remarks.add(combination.config)


def _tried(
    listed: Mapping[str, list[Any]], *, together: bool
) -> Iterator[tuple[int, tuple[str, ...], dict[str, Any]]]:
    """Yield a position, the keys whose values there are tried, and what all keys are meanwhile."""
    if together:
        for position, row in enumerate(zip(*listed.values(), strict=True)):
            yield position, tuple(listed), dict(zip(listed, row, strict=True))
        return
    firsts = {key: values[0] for key, values in listed.items()}
    for key, values in listed.items():
        for position, value in enumerate(values):
            yield position, (key,), {**firsts, key: value}


def _plain_at(config: Config, key: str) -> Any:
    """Return what stands under a key of a config, as plain data."""
    section, _, rest = key.partition(".")
    # the key's part of the section alone, as each is written on its own
    only = {rest.partition(".")[0]} if rest else None
    return part_of({section: getattr(config, section).model_dump(mode="json", include=only)}, key)


def _zipped(config: Config) -> bool:
    return config.grid.combine == "zip"


def _grid(config: Config, values: Mapping[str, list[Any]]) -> Grid:
    return Grid.model_validate({"combine": config.grid.combine, **values})


def _raise(problems: Mapping[str, None]) -> None:
    lines = list(problems)
    if len(lines) > _SHOWN:
        more = "many" if len(lines) > _COUNTED else len(lines) - _SHOWN
        lines[_SHOWN:] = [f"grid: and {more} problems more"]
    if lines:
        raise ConfigError(*lines)


def _listed(config: Config, key: str, given: Any) -> list[Any]:
    """Write out the values of one key."""
    known = set(known_keys(config))
    require_varied(config, key)
    if isinstance(given, list | tuple):
        if not given:
            raise ConfigError(f"grid.{key}: [] given; list one value or more")
        return list(given)
    if isinstance(given, Mapping) and set(given) in _RANGES:
        if f"{key}.num" in known:
            raise ConfigError(
                f"grid.{key}: {dict(given)} given, but it is itself a range: vary {key}.num, or "
                "list whole ranges"
            )
        return _spaced(key, given)
    inner = [f"{key}.{name}" for name in given] if isinstance(given, Mapping) else []
    if inner and set(inner) <= known:
        raise ConfigError(
            f"grid.{key}: {given!r} given; keys don't nest here: write grid: {{{inner[0]}: [...]}}"
        )
    if isinstance(given, Mapping) and {"start", "stop"} & set(given):
        raise ConfigError(
            f"grid.{key}: {dict(given)} given; a range has start, stop and num or step, and "
            "nothing else"
        )
    raise ConfigError(
        f"grid.{key}: {given!r} given; it should be a list of values, or a range "
        "{start: ..., stop: ..., num: ...}"
    )


def _spaced(key: str, given: Mapping[str, Any]) -> list[Any]:
    ends = [given["start"], given["stop"]]
    if any(isinstance(end, bool) for end in ends):
        raise ConfigError(f"grid.{key}: {dict(given)} given; both ends should be numbers")
    quantity = _quantity(ends)
    try:
        start, stop = [parse(quantity, end) if quantity else float(end) for end in ends]
    except (TypeError, ValueError):
        raise ConfigError(
            f"grid.{key}: {dict(given)} given; both ends should be numbers, or both lengths (or "
            "angles) with their unit"
        ) from None
    if not (math.isfinite(start) and math.isfinite(stop) and start < stop):
        raise ConfigError(
            f"grid.{key}.start: {ends[0]} given; it must be below grid.{key}.stop = {ends[1]}, "
            "or the range is empty"
        )
    num = _number_of(key, given, quantity, start, stop)
    values: list[float] = evenly(start, stop, num).tolist()
    if quantity:
        return [f"{value!r} {quantity.unit}" for value in values]
    if not all(isinstance(end, int) for end in ends):
        return values
    if not all(map(float.is_integer, values)) and isinstance(value_at(Config(), key), int):
        raise ConfigError(
            f"grid.{key}: {dict(given)} given; its {num} values are not all whole numbers; choose "
            "a num that divides the range, or list them"
        )
    return [int(value) if value.is_integer() else value for value in values]


def _number_of(
    key: str, given: Mapping[str, Any], quantity: Quantity | None, start: float, stop: float
) -> int:
    """Return how many values a range has."""
    num = given.get("num")
    if "step" in given:
        step = given["step"]
        try:
            num = (
                counted(start, stop, parse(quantity, step), quantity.unit)
                if quantity
                else counted(start, stop, float(step), "")
            )
        except (TypeError, ValueError) as error:
            raise ConfigError(f"grid.{key}: {dict(given)} given; step: {error}") from None
    if not isinstance(num, int) or isinstance(num, bool) or not 2 <= num <= MOST:
        raise ConfigError(f"grid.{key}.num: {num!r} given; a range has 2 to {MOST} values")
    return num


def _quantity(ends: list[Any]) -> Quantity | None:
    """Return what both ends of a range are, if they have units."""
    for quantity in (LENGTH, ANGLE, ATTENUATION, RATIO):
        with contextlib.suppress(ValueError):
            for end in ends:
                parse(quantity, end)
            return quantity
    return None


def _check_keys(config: Config, listed: Mapping[str, list[Any]]) -> None:
    for one, other in itertools.combinations(listed, 2):
        if overlap(one, other):
            raise ConfigError(f"grid.{one}: given beside grid.{other}, and both set the same key")
    counts = {key: len(values) for key, values in listed.items()}
    if _zipped(config) and len(set(counts.values())) > 1:
        told = ", ".join(f"{key} has {count}" for key, count in counts.items())
        raise ConfigError(f"grid: zipped keys need as many values each, but {told}")
    total = max(counts.values()) if _zipped(config) else math.prod(counts.values())
    if total > MOST:
        raise ConfigError(f"grid: {total} combinations; at most {MOST} are made in one run")


def _check_rows(config: Config) -> None:
    """Refuse a combination that stands twice."""
    count = max(len(values) for values in config.grid.varied.values())
    for axis in axes(config):
        texts = list(map(row_text, axis.rows))
        twice, times = Counter(texts).most_common(1)[0]
        if times > 1:
            row = as_text(list(axis.rows[texts.index(twice)]))
            raise ConfigError(f"grid.{axis.keys[0]}: {row} stands twice; give each value once")
        if _zipped(config) and len(texts) < count:
            raise ConfigError("grid: a zipped combination stands twice; give each once")
