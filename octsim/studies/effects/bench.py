"""What effects are compared on: the run with fewer diameters and wavenumbers, at given foci."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.derive import changed
from octsim.config.models import Config, FocusLine
from octsim.config.ranges import even
from octsim.studies.effects.changes import Change, Measures, Seen, change, measures, noise, seen
from octsim.studies.effects.sweeps import Swept, made_rougher, swept
from octsim.studies.effects.variants import EffectStatus, Variant

Array = NDArray[np.float64]
SAMPLES = 200
"""Wavenumbers at most, unless the fringe of the largest diameter needs more."""
_OF_A_FRINGE = 8  # samples of one oscillation
_FOR_NOISE = 2
"""Every so many of the diameters are looked at for that."""
_UNKNOWN = Measures(*[np.nan] * len(Measures._fields))


class Bench(NamedTuple):
    """What effects are compared on."""

    config: Config
    """The baseline, of fewer diameters and wavenumbers than the run."""
    diameter: Array
    foci: Array
    threads: int

    def every(self, step: int) -> "Bench":
        """Return that of fewer diameters."""
        return self._replace(diameter=self.diameter[::step], foci=self.foci[::step])

    def swept(self, variant: Variant) -> Swept:
        """Find the light of these diameters with an effect and without it."""
        return swept(variant, self.diameter, self.foci, self.threads)

    def seen(self, intensity: Array, error: Array) -> Seen:
        """Return what is read from spectra of these diameters."""
        return seen(self.config, self.diameter, self.foci, intensity, error)

    def changed(self, found: Swept) -> Change:
        """Return by how much spectra of these diameters differ."""
        return change(
            self.seen(found.with_effect, found.error), self.seen(found.without_effect, found.error)
        )


class Result(NamedTuple):
    """An effect, and what it changes."""

    variant: Variant
    status: EffectStatus
    found: Swept | None = None
    change: Change | None = None
    measures: Measures = _UNKNOWN
    noise: Measures = _UNKNOWN

    @property
    def spectra(self) -> Swept:
        """Those of an effect that is measured."""
        assert self.found is not None
        return self.found


def bench_of(config: Config, line: FocusLine, number: int, threads: int) -> Bench:
    """Return what a run's effects are compared on.

    Parameters
    ----------
    config : Config
        The run.
    line : FocusLine
        Where it is focused.
    number : int
        How many diameters.
    threads : int
    """
    span, k = even(config.sweep.diameters, "effects"), config.spectrum.wavenumbers()
    oscillations = config.swept_group_index * (k[-1] - k[0]) / np.pi * span.stop
    most = max(SAMPLES, math.ceil(_OF_A_FRINGE * oscillations))
    sampled = {
        "sweep": {
            "diameters": {"num": number},
            "focus": {"slope": line.slope, "intercept": f"{line.intercept!r} um"},
        },
        "spectrum": {"samples": min(config.spectrum.samples, most)},
    }
    fewer = changed(config, sampled)
    diameter = fewer.sweep.diameters.values()
    return Bench(fewer, diameter, line.at(diameter), threads)


def measured(bench: Bench, variant: Variant) -> Result:
    """Return what an effect changes, with its noise."""
    if not variant.measured:
        return Result(variant, variant.status)
    found = bench.swept(variant)
    whole = bench.changed(found)
    fewer = for_noise(bench)
    rough = fewer.changed(fewer.swept(made_rougher(variant)))
    off = noise(fewer.changed(some(found, _FOR_NOISE)), rough, fewer.diameter)
    said = measures(whole, bench.diameter)
    known = np.isfinite(said.mean_slope_change)
    status = EffectStatus.MEASURED if known else EffectStatus.NO_FRINGE
    return Result(variant, status, found, whole, said, off)


def for_noise(bench: Bench) -> Bench:
    """Return the bench of the diameters that the noise is looked for at."""
    return bench.every(_FOR_NOISE)


def some(found: Swept, step: int) -> Swept:
    """Return the spectra of every so many of the diameters."""
    return found._replace(
        with_effect=found.with_effect[::step], without_effect=found.without_effect[::step],
        error=found.error[::step], seconds=found.seconds[:, ::step],
    )  # fmt: skip
