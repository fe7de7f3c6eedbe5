"""Combinations of a grid that take as much as each other, counted together."""

import math
from collections import Counter
from collections.abc import Iterator

from pydantic import BaseModel

from octsim.base.remembered import remembered
from octsim.config.grid import axes, combinations, row_text
from octsim.config.models import FIXED, Config, Grid

_COSTS_NOTHING = (
    "scene.gap", "objective.numerical_aperture", "objective.focus_distance",
    "objective.magnification", "detector.core_diameter", "processing",
)  # fmt: skip
"""Keys that no cost follows from, nor from parts of them."""


def alike(config: Config, *keys: str) -> Iterator[tuple[Config, int]]:
    """Yield a config of each kind of combinations that cost the same, and how many there are.

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
    every = axes(config, *keys)
    varied = config.grid.varied
    kept = {key: values for key, values in varied.items() if not _costs_nothing(key)}
    grid = Grid.model_validate({"combine": config.grid.combine, **kept})
    reduced = config.model_copy(update={"grid": grid})
    if config.grid.combine == "product":
        lost = math.prod(len(axis.rows) for axis in every if _costs_nothing(axis.keys[0]))
        yield from ((at.config, lost) for at in combinations(reduced, *keys))
        return
    counts: dict[str, int] = {}
    for axis in every:
        places = [place for place, key in enumerate(axis.keys) if not _costs_nothing(key)]
        counts = Counter(row_text(tuple(row[place] for place in places)) for row in axis.rows)
    for at in combinations(reduced, *keys):
        yield at.config, counts.get(row_text(tuple(at.values.values())), 1)


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
