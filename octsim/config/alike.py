"""Combinations of a grid that take about as much as each other, counted together."""

import math
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

from pydantic import BaseModel

from octsim.base.remembered import remembered
from octsim.config.grid import axes, combinations, row_text, varied_keys
from octsim.config.models import FIXED, Config, Grid

_COSTS_NOTHING = (
    "scene.gap", "objective.numerical_aperture", "objective.focus_distance",
    "objective.magnification", "detector.core_diameter", "processing",
)  # fmt: skip
"""Keys that no cost follows from, nor from parts of them."""
_MEASURED = re.compile(r"([-+]?[0-9][0-9.e+-]*) ([^\W\d]\S*)")


def alike(config: Config, *keys: str) -> Iterator[tuple[Config, int]]:
    """Yield a config of each kind of combinations that cost about the same, and how many there are.

    Of one kind are numbers that are the same to three digits, but whole ones, which count things.

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
    """Yield the combinations of what costs follow from, and how often each is there."""
    varied = {k: v for k, v in config.grid.varied.items() if not _costs_nothing(k)}
    standing = {key: _standing_for(values) for key, values in varied.items()}
    product = config.grid.combine == "product"
    kept = {key: _unique(values) if product else values for key, values in standing.items()}
    grid = Grid.model_validate({"combine": config.grid.combine, **kept})
    few = combinations(config.model_copy(update={"grid": grid}), *keys)
    if product:
        lost = math.prod(
            len(axis.rows) for axis in axes(config, *keys) if _costs_nothing(axis.keys[0])
        )
        counts = {key: Counter(map(_value_text, values)) for key, values in standing.items()}
        for at in few:
            each = (counts[key][_value_text(value)] for key, value in at.values.items())
            yield at.config, lost * math.prod(each)
        return
    bearing = varied_keys(config, *keys)
    rows = zip(*(config.grid.varied[key] for key in bearing), strict=True)
    places = {row_text(row): place for place, row in enumerate(rows)}.values()
    columns = [standing[key] for key in bearing if key in standing]
    together = Counter(row_text(tuple(one[place] for one in columns)) for place in places)
    for at in few:
        yield at.config, together.get(row_text(tuple(at.values.values())), 1)


def _standing_for(values: Sequence[Any]) -> list[Any]:
    """Return for each value the first of those that cost about the same."""
    first: dict[str, Any] = {}
    return [first.setdefault(_about(value), value) for value in values]


def _about(value: Any) -> str:
    """Return a value as text, a number or length to three digits: it costs as much to 1 %."""
    if isinstance(value, str) and (found := _MEASURED.fullmatch(value)):
        return f"{float(found[1]):.3g} {found[2]}"
    return f"{value:.3g}" if isinstance(value, float) else _value_text(value)


def _unique(values: Sequence[Any]) -> list[Any]:
    return list({_value_text(value): value for value in values}.values())


def _value_text(value: Any) -> str:
    return row_text((value,))


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
