"""What a run takes: points, processor time, memory and disk, known before it begins."""

import functools
import math
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

from octsim.cache import opened
from octsim.config import Config
from octsim.errors import ConfigError
from octsim.grid import axes, combinations
from octsim.reading import keys_behind

_RAY_BYTES = 32  # of the four numbers that are kept of a detected ray
_PATHS = {"vogel": 40, "paths": 12}  # that a sweep has, about
_SUMMING = 1e-7  # s a sample, of summing, transforming and differentiating a spectrum
_JOB_BYTES = 3e8  # of a process with its libraries, compiled code and blocks
_ENOUGH = 50  # points, to know what one takes
_SHORT = 60.0  # s; of what takes less nothing needs to be said


class PointCost(NamedTuple):
    """What a point takes."""

    size: float
    """Bytes of its light."""
    seconds: float
    """Processor time to trace it."""


def point_cost(config: Config) -> PointCost:
    """Give what a point of a plain config takes to trace.

    These rates were measured on one machine (`snakemake tradeoff`); what they decide, the size of
    blocks, is to be the same on all.
    """
    if config.tracing.scheme == "vogel":
        rays = config.tracing.rays
        return PointCost(_RAY_BYTES * (1 + 0.18 * rays), 1.3e-4 + 8.8e-7 * rays)
    digits = -math.log10(config.tracing.accuracy)
    return PointCost(_RAY_BYTES * 45 * 10 ** (0.18 * digits), 4.7e-4 * 10 ** (0.145 * digits))


def rate_name(config: Config) -> str:
    """Name the tracing of a config: points of a name take about the same."""
    tracing = config.tracing
    paths = tracing.scheme == "paths"
    return f"{tracing.scheme} {tracing.accuracy if paths else tracing.rays}"


class Estimate(NamedTuple):
    """What a run takes at most, before anything is found in the cache."""

    combinations: int
    """Of the grid; 1 without."""
    points: Mapping[str, int]
    """Points to trace, by stage."""
    cpu_seconds: float
    """Processor time."""
    disk_bytes: float
    """Of the datasets."""

    @property
    def is_large(self) -> bool:
        """Whether a user would want to know before it begins."""
        return self.combinations > 1 or self.cpu_seconds > _SHORT

    def __str__(self) -> str:
        told = ", ".join(f"{stage} {count}" for stage, count in self.points.items())
        return (
            f"{self.combinations} combinations, {sum(self.points.values())} points to trace "
            f"({told}; those in the cache take no time); about {_time(self.cpu_seconds)} of "
            f"processor time, {self.disk_bytes / 1e9:.2g} GB of disk, {_JOB_BYTES / 1e9:.1g} GB of "
            "memory a job"
        )


def estimate(config: Config, measured: Callable[[str], PointCost | None]) -> Estimate:
    """Estimate what a run takes.

    Parameters
    ----------
    config : Config
        The run.
    measured : callable
        Gives the measured cost of a point of a `rate_name`, where there is one; else
        `point_cost` is taken.
    """
    points = dict.fromkeys(("focus_scan", "focus_sweep", "detections"), 0)
    seconds = disk = 0.0

    def cost(of: Config) -> PointCost:
        return measured(rate_name(of)) or point_cost(of)

    def spiral(of: Config) -> Config:
        tracing = of.tracing.model_copy(update={"scheme": "vogel"})
        return of.model_copy(update={"tracing": tracing})

    for at in combinations(config, *keys_behind("focus_scan", config)):
        count, counted_too = at.config.focus_scan.focus.num, at.config.tracing.scheme != "vogel"
        points["focus_scan"] += count * (1 + counted_too)
        summed = _SUMMING * at.config.spectrum.samples
        extra = cost(spiral(at.config)).seconds if counted_too else 0.0
        seconds += count * (cost(at.config).seconds + summed + extra)
    for at in combinations(config, *keys_behind("focus_sweep", config)):
        count = at.config.focus_law.diameters.num * at.config.focus_law.fraction.num
        points["focus_sweep"] += count
        seconds += count * (cost(at.config).seconds + _SUMMING * at.config.spectrum.samples)
    for at in combinations(config, *keys_behind("detections", config)):
        count = at.config.sweep.diameters.num
        points["detections"] += count
        seconds += count * cost(at.config).seconds
        disk += count * (cost(at.config).size + 40 * _PATHS[at.config.tracing.scheme])
    for at in combinations(config, *keys_behind("phase_slope", config)):
        count, samples = at.config.sweep.diameters.num, at.config.spectrum.samples
        seconds += 3 * count * _SUMMING * samples
        disk += 20.0 * count * samples  # intensity, magnitude and phase, slopes of half as many
    total = math.prod(len(axis.rows) for axis in axes(config))
    return Estimate(total, points, seconds, disk)


def expected(config: Config) -> Estimate:
    """Estimate what a run takes, by the rates that this cache's points were traced at.

    Raises
    ------
    CacheError
        If the file of the cache is none that can be used.
    """
    file = Path(config.cache.file)
    if not file.exists():
        return estimate(config, lambda _: None)
    with opened(file, config.cache.gigabytes) as cache:

        def measured(name: str) -> PointCost | None:
            rate = cache.rates(name)
            if rate is None or rate.points < _ENOUGH:
                return None
            return PointCost(rate.bytes / rate.points, rate.cpu_seconds / rate.points)

        return estimate(config, functools.cache(measured))


def check_budget(config: Config, found: Estimate, folder: Path) -> None:
    """Refuse a run that takes more than is confirmed, or than there is room for.

    Raises
    ------
    ConfigError
        With the key that confirms it.
    """
    hours, disk = found.cpu_seconds / 3600, found.disk_bytes / 1e9
    budget = config.budget
    if hours > budget.cpu_hours:
        raise ConfigError(
            f"budget.cpu_hours: {budget.cpu_hours:g} given, but this run takes about {hours:.3g} "
            f"(by {sum(found.points.values())} points); raise it to confirm, or vary less"
        )
    if disk > budget.disk_gigabytes:
        raise ConfigError(
            f"budget.disk_gigabytes: {budget.disk_gigabytes:g} given, but this run's datasets take "
            f"about {disk:.3g}; raise it to confirm, or vary less"
        )
    there = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    free = shutil.disk_usage(there).free / 1e9
    if disk > free:
        raise ConfigError(
            f"{folder}: {free:.3g} GB are free, but this run's datasets take about {disk:.3g}; "
            "make room, or vary less"
        )


def _time(seconds: float) -> str:
    for unit, length in (("h", 3600.0), ("min", 60.0)):
        if seconds >= length:
            return f"{seconds / length:.2g} {unit}"
    return f"{seconds:.2g} s"
