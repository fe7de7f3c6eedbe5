"""Which keys of a config a dataset follows from: nothing else makes it anew."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from octsim.base.remembered import remembered
from octsim.config.derive import by_light_paths, overlap, parts_of
from octsim.config.following import FOLLOWING, follows
from octsim.config.grid import Axis, axes, combinations, row_text, varied_keys
from octsim.config.models import Config, Grid
from octsim.config.scheme import light_keys, scheme_of
from octsim.datasets.catalog import CATALOG, STAGES, jobs
from octsim.datasets.stage import LIGHT, RAYS, SUMMING, Stage

_DECIDING = (
    "tracing.scheme", "tracing.preset", "sweep.focus", "scene.refractive_index", "polarisation",
    "beam", "detector.falloff", "objective.pupil", "objective.focal_shift", "objective.immersion",
    *FOLLOWING,
)  # fmt: skip
"""Keys that decide which others are read."""


def keys_read(stage: str, config: Config) -> tuple[str, ...]:
    """Return the keys that a stage reads itself, at any combination, besides others' datasets."""
    return tuple(dict.fromkeys(key for one in _kinds(config) for key in _read(stage, one)))


def keys_behind(stage: str, config: Config) -> tuple[str, ...]:
    """Return the keys that a stage's dataset depends on: its own and those of stages before it."""
    return tuple(dict.fromkeys(key for one in _kinds(config) for key in _behind(stage, one)))


@remembered
def _kinds(config: Config) -> tuple[Config, ...]:
    """Return one plain config of each kind of combinations that may read different keys."""
    kept: dict[str, list[Any]] = {}
    for axis in axes(config, *_DECIDING):
        rows: dict[str, tuple[Any, ...]] = {}
        for row in axis.rows:
            rows.setdefault(row_text(tuple(map(_kind, axis.keys, row))), row)
        kept |= zip(axis.keys, map(list, zip(*rows.values(), strict=True)), strict=True)
    grid = Grid.model_validate({"combine": config.grid.combine, **kept})
    reduced = config.model_copy(update={"grid": grid})
    return tuple(at.config for at in combinations(reduced))


def _kind(key: str, value: Any) -> Any:
    """Return what of a value decides which other keys are read: not which number or line it is."""
    if overlap(key, "scene.refractive_index") and isinstance(value, int | float):
        return "a number"
    if overlap(key, "sweep.focus") and value != "law":
        return "a line"
    return value


def _read(stage: str, config: Config) -> Iterator[str]:
    read = [*_asked(stage, config)]
    yield from read
    if any(follows(config, one) and overlap(one, key) for one in FOLLOWING for key in read):
        yield "sweep.diameters"


def _asked(stage: str, config: Config) -> Iterator[str]:
    for key in CATALOG[stage].reads if stage in CATALOG else ():
        if key == LIGHT:
            yield from light_keys(config)
        elif key == RAYS:
            # at a preset, whatever the section tracing asks for
            every = light_keys(by_light_paths(config))
            yield from (one for one in every if not one.startswith("tracing."))
            yield "tracing.scheme"  # which decides whether it is looked at
        elif key == SUMMING:
            yield from scheme_of(config).summing_keys
        else:
            yield key


def _behind(stage: str, config: Config) -> Iterator[str]:
    for before in inputs_of(CATALOG[stage], config) if stage in CATALOG else ():
        yield from _behind(before, config)
    yield from _read(stage, config)


def stage_axes(stage: str, config: Config) -> tuple[Axis, ...]:
    """Return the axes of the grid that a stage's dataset has: those of the keys behind it.

    A stage that has nothing to do with any varied key has none.
    """
    return axes(config, *keys_behind(stage, config))


def with_the_same_axes(stages: Iterable[str], config: Config) -> list[list[str]]:
    """Return stages together whose datasets have the same axes of the grid, as most have."""
    together: dict[tuple[str, ...], list[str]] = {}
    for stage in stages:
        varied = varied_keys(config, *keys_behind(stage, config))
        together.setdefault(varied, []).append(stage)
    return list(together.values())


def needs_law(config: Config) -> bool:
    """Return whether the fitted focus law is needed at some combination."""
    return any(at.config.sweep.focus == "law" for at in combinations(config, "sweep.focus"))


def light_of(config: Config) -> frozenset[str]:
    """Return the kinds of light that the schemes of all combinations have."""
    every = combinations(config, "tracing.scheme", "tracing.preset")
    return frozenset(scheme_of(at.config).light for at in every)


def stages_of(config: Config) -> tuple[str, ...]:
    """Return the datasets of a run: all but those of light that its schemes do not have."""
    return tuple(name for name in STAGES if _exists(name, config))


def jobs_of(config: Config) -> dict[str, tuple[Stage, ...]]:
    """Return the jobs of a run, and the datasets that each makes."""
    there = stages_of(config)
    found = {
        name: tuple(row for row in rows if row.name in there)
        for name, rows in jobs(beside=False).items()
    }
    return {name: rows for name, rows in found.items() if rows}


def _exists(stage: str, config: Config) -> bool:
    kind = CATALOG[stage].light
    return not kind or kind in light_of(config)


def inputs_of(stage: Stage, config: Config) -> tuple[str, ...]:
    """Return the datasets that a stage is made from, under a config.

    A given focus needs no law, and what is traced at it does not change with the law. An expansion
    is by a calibration, or by responses where more is fitted, and of measured spectra where no
    series of phases is named; its slope is that of the config, or of what fits these best.
    """
    left = set() if needs_law(config) else {"focus_law"}
    if stage.name == "expansion":
        left.add("calibration" if config.expansion.several else "responses")
        if config.measured.spectra is None or config.expansion.series is not None:
            left.add("measured")
        if config.expansion.slope != "match":
            left.add("match")
    return tuple(name for name in stage.after if _exists(name, config) and name not in left)


def differing(stage: str, config: Config, other: Mapping[str, object]) -> list[str]:
    """Return the keys behind a stage's dataset that another config, as data, differs in.

    Keys are those that the stage depends on under `config`; a varied one is ``grid.<key>``.
    """
    keys = keys_behind(stage, config)
    asked, made = parts_of(config.to_dict(), *keys), parts_of(other, *keys)
    return [key for key in dict.fromkeys((*asked, *made)) if made.get(key) != asked.get(key)]
