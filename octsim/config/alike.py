"""Combinations of a grid that take about as much as each other, counted together."""

import itertools
import math
import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from octsim.base.remembered import remembered
from octsim.config.configs_at import ConfigsAt
from octsim.config.grid import Axis, axes, row_text
from octsim.config.models import FIXED, Config

_COSTS_NOTHING = (
    "scene.gap", "objective.numerical_aperture", "objective.focus_distance",
    "objective.magnification", "detector.core_diameter", "processing",
)  # fmt: skip
"""Keys that no cost follows from, nor from parts of them."""
_INDEX = "scene.refractive_index."
_MEASURED = re.compile(r"([-+]?[0-9][0-9.]*(?:e[-+]?[0-9]+)?) (\S+)")


def alike(config: Config, *keys: str) -> Iterator[tuple[Config, int]]:
    """Yield a config of each kind of combinations that cost about the same, and how many there are.

    Numbers and lengths that are the same to three digits are of one kind; whole numbers, which
    count things, and indices that several media have, between which nothing is reflected, are of
    their own.

    Parameters
    ----------
    config : Config
        A checked config.
    *keys : str
        Dotted keys: combinations of what varies these, or parts of them.
    """
    kinds: dict[tuple[str, ...], int] = {}
    firsts: dict[tuple[str, ...], Config] = {}
    for one, count in _of_costs(config, keys):
        kind = tuple(_as_text(getattr(one, name)) for name in _SECTIONS)
        kinds[kind] = kinds.get(kind, 0) + count
        firsts.setdefault(kind, one)
    yield from ((firsts[kind], count) for kind, count in kinds.items())


def _of_costs(config: Config, keys: tuple[str, ...]) -> Iterator[tuple[Config, int]]:
    """Yield combinations of what costs follow from, and of how many others each is the first."""
    shared = _shared_indices(config)
    along = [_kinds_along(axis, shared) for axis in axes(config, *keys)]
    configs = ConfigsAt({**config.to_dict(), "grid": {}})
    for chosen in itertools.product(*along):
        values = {key: value for one, _ in chosen for key, value in one.items()}
        yield configs.at(values), math.prod(count for _, count in chosen)


def _kinds_along(axis: Axis, shared: frozenset[float]) -> list[tuple[dict[str, Any], int]]:
    """Return the first of the values along an axis that cost about the same, and how many do."""
    places = [place for place, key in enumerate(axis.keys) if not _costs_nothing(key)]
    counts: Counter[str] = Counter()
    firsts: dict[str, dict[str, Any]] = {}
    for row in axis.rows:
        kind = "\n".join(_rounded(row[place], shared) for place in places)
        counts[kind] += 1
        if kind not in firsts:
            firsts[kind] = {axis.keys[place]: row[place] for place in places}
    return [(firsts[kind], count) for kind, count in counts.items()]


def _shared_indices(config: Config) -> frozenset[float]:
    """Return the indices that several media have, somewhere in the grid."""
    of: dict[str, Any] = {
        name: [given] for name, given in config.scene.refractive_index.given.items()
    }
    of |= {
        key.removeprefix(_INDEX): values
        for key, values in config.grid.varied.items()
        if key.startswith(_INDEX)
    }
    counts = Counter(
        index for given in of.values() for index in {one for one in given if isinstance(one, float)}
    )
    return frozenset(index for index, media in counts.items() if media > 1)


def _rounded(value: Any, shared: frozenset[float]) -> str:
    """Return a value as text, one that is measured to three digits."""
    if isinstance(value, str) and (found := _MEASURED.fullmatch(value)):
        return f"{float(found[1]):.3g} {found[2]}"
    measured = isinstance(value, float) and value not in shared
    return f"{value:.3g}" if measured else row_text((value,))


def _costs_nothing(key: str) -> bool:
    return any(f"{key}.".startswith(f"{one}.") for one in _COSTS_NOTHING)


_SECTIONS = tuple(
    name
    for name, field in Config.model_fields.items()
    if name not in FIXED and name != "processing" and isinstance(field.annotation, type)
)


@remembered
def _as_text(section: BaseModel) -> str:
    """Return a section as text that can be compared."""
    return repr(section.model_dump(mode="json"))
