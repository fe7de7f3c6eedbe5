"""What the trade of cost for accuracy varies: one factor of a run's config at a time."""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from octsim.config.derive import by_accuracy, by_rays, by_waves, changed
from octsim.config.models import Config
from octsim.config.scheme import scheme_of
from octsim.schemes.table import FULL_WAVE, PRESETS

RAYS = (100, 300, 1000, 3000, 10_000, 30_000, 100_000, 300_000, 1_000_000)
ACCURACIES = (
    1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 1e-8,
)  # fmt: skip
EXACT_ACCURACIES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
OF_WAVES = f"tracing.accuracy, {FULL_WAVE.name}"
"""The factor of the accuracy to which Maxwell's equations are solved."""
MAX_INTERSECTIONS = (1, 3, 5, 7, 9, 11, 15)
MIN_AMPLITUDES = (0.0, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
SAMPLES = (50, 100, 200, 500, 1000, 2000, 4000)
CONVERGED_SAMPLES = 16_000
FINER = 4
"""How many times as many diameters give the converged slope."""
_ACCURATE = 1e-6  # where another factor's error is looked for
_MOST_FOR_SWEEP = 100_000  # rays; more are traced at some diameters only
_MOST_FOR_LAW = 10_000  # rays
_SOME = 15  # every so many, where the whole sweep would take minutes


class Setting(NamedTuple):
    """One point of the trade: a config, and what of it is measured."""

    factor: str
    """Key of the config that is varied."""
    value: float
    """What it is."""
    config: Config
    """The whole config."""
    every: int = 1
    """Which of the diameters are traced; without all there is no phase slope."""
    law: bool = True
    """Whether the focus law is fitted."""


def settings(config: Config, waves: bool = True) -> list[Setting]:
    """Return the points of a run's trade, factor after factor, with those of waves or without.

    The factor ``reference`` is the reference itself at other settings: how far it moves bounds
    its own error. The run's own setting is added as the factor ``run``, unless it is one of the
    others.
    """
    solved = _solving(config) if waves else ()
    listed = [*_tracing(config), *solved, *_sampling(config)]
    if not any(is_the_runs(setting, config) for setting in listed):
        listed.append(Setting("run", math.nan, config, law=not is_of_waves(config)))
    return listed


def is_of_waves(config: Config) -> bool:
    """Return whether a config's light is waves, of which no segments are traced."""
    return scheme_of(config).light == "waves"


def is_of_the_trade(setting: Setting) -> bool:
    """Return whether a setting is a way to find light: none of sampling, nor the reference."""
    return setting.factor == "run" or setting.factor.startswith("tracing.")


def is_the_runs(setting: Setting, config: Config) -> bool:
    """Return whether a setting traces and samples just as the run itself."""
    return _relevant(setting.config) == _relevant(config) and setting.every == 1


def preset_of(setting: Setting) -> str:
    """Return the name of the preset that a setting is, or nothing."""
    if setting.factor in ("tracing.accuracy", OF_WAVES):
        for name, preset in PRESETS.items():
            if all(getattr(setting.config.tracing, key) == preset[key] for key in preset):
                return name
    return ""


def _relevant(config: Config) -> dict[str, Any]:
    """Return what of a config the results follow from: without what its scheme does not read."""
    scheme, tracing = scheme_of(config), config.tracing
    return {
        **scheme.chosen(tracing),
        "scheme": scheme.name,
        "max_intersections": tracing.max_intersections,
        "samples": config.spectrum.samples,
        "num": config.sweep.diameters.num,
    }


def _tracing(config: Config) -> Iterator[Setting]:
    for rays in RAYS:
        every = 1 if rays <= _MOST_FOR_SWEEP else _SOME
        yield Setting("tracing.rays", rays, by_rays(config, rays), every, law=rays <= _MOST_FOR_LAW)
    for accuracy in ACCURACIES:
        yield Setting("tracing.accuracy", accuracy, by_accuracy(config, accuracy))
    for most in MAX_INTERSECTIONS:
        limited = by_accuracy(config, _ACCURATE, max_intersections=most)
        yield Setting("tracing.max_intersections", most, limited)
    for least in MIN_AMPLITUDES:
        fainter = changed(
            by_rays(config, config.tracing.rays), {"tracing": {"min_amplitude": least}}
        )
        yield Setting("tracing.min_amplitude", least, fainter)
    other = by_accuracy(config, 1e-8, max_intersections=30)
    yield Setting("reference", 1e-8, other, _SOME, law=False)


def _solving(config: Config) -> Iterator[Setting]:
    exact = by_waves(config)
    for accuracy in EXACT_ACCURACIES:
        solved = changed(exact, {"tracing": {"preset": None, "accuracy": accuracy}})
        # the law is one of rays
        yield Setting(OF_WAVES, accuracy, solved, law=False)


def _sampling(config: Config) -> Iterator[Setting]:
    accurate = by_accuracy(config, _ACCURATE)
    for samples in SAMPLES:
        yield Setting(
            "spectrum.samples", samples, changed(accurate, {"spectrum": {"samples": samples}})
        )
    steps = config.sweep.diameters.num - 1
    # of each, every diameter is one of the converged slope's
    coarser = [steps // n for n in (10, 6, 5, 3, 2, 1) if steps % n == 0 and steps // n >= 2]
    for count in (*coarser, 2 * steps):
        swept = changed(accurate, {"sweep": {"diameters": {"num": count + 1}}})
        yield Setting("sweep.diameters.num", count + 1, swept, law=False)
