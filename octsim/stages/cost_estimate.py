"""What a run takes: points, processor time, memory and disk, known before it begins."""

import functools
import math
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

from octsim.base.errors import ConfigError
from octsim.config.grid import axes, combinations
from octsim.config.models import Config
from octsim.datasets.catalog import keys_behind
from octsim.instrument.point_store import opened

_RAY_BYTES = 32  # of the four numbers that are kept of a detected ray
_PATHS = {"vogel": 40, "paths": 12}  # that a sweep has, about
_SUMMING = 1e-7  # s a sample, of summing, transforming and differentiating a spectrum
_JOB_BYTES = 3e8  # of a process with its libraries, compiled code and blocks
_RAY_MEMORY = 600.0  # bytes, of each ray of a spiral that two threads trace
_SAMPLE_MEMORY = 1000.0  # bytes, of each sample of the spectra in a block
_ENOUGH = 50  # points, to know what one takes
_SHORT = 60.0  # s; of what takes less nothing needs to be said
_BLOCK_BYTES = 16e6
_BLOCK_SECONDS = 2.0
_MOST_POINTS = 512


def points_per_block(bytes_per_point: float, seconds_per_point: float = 0.0) -> int:
    """Give how many points are worked on between two writes: by memory and by time, at least one.

    It follows from the config alone, so that the same run gives the same file.
    """
    seconds = max(seconds_per_point, _BLOCK_SECONDS / _MOST_POINTS)
    most = min(_BLOCK_BYTES / bytes_per_point, _BLOCK_SECONDS / seconds, _MOST_POINTS)
    return max(1, int(most))


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


class Cost(NamedTuple):
    """What a stage takes at most, before anything is found in the cache."""

    points: int = 0
    """Points to trace."""
    cpu_seconds: float = 0.0
    """Processor time."""
    disk_bytes: float = 0.0
    """Of its datasets."""
    memory_bytes: float = _JOB_BYTES
    """Of its process."""

    def and_also(self, other: "Cost") -> "Cost":
        """Give what two take, one after the other."""
        return Cost(
            self.points + other.points,
            self.cpu_seconds + other.cpu_seconds,
            self.disk_bytes + other.disk_bytes,
            max(self.memory_bytes, other.memory_bytes),
        )


class Estimate(NamedTuple):
    """What a run takes."""

    combinations: int
    """Of the grid; 1 without."""
    stages: Mapping[str, Cost]
    """By stage: those that trace, and those that take processor time or disk."""

    def of(self, *stages: str) -> Cost:
        """Give what some stages take together."""
        return functools.reduce(
            Cost.and_also, (self.stages[s] for s in stages if s in self.stages), Cost()
        )

    @property
    def is_large(self) -> bool:
        """Whether a user would want to know before it begins."""
        return self.combinations > 1 or self.of(*self.stages).cpu_seconds > _SHORT

    def __str__(self) -> str:
        whole = self.of(*self.stages)
        told = ", ".join(f"{name} {one.points}" for name, one in self.stages.items() if one.points)
        return (
            f"{self.combinations} combinations, at most {whole.points} points to trace ({told}; "
            f"those in the cache are not traced); about {_time(whole.cpu_seconds)} of processor "
            f"time, {whole.disk_bytes / 1e9:.2g} GB of disk, {whole.memory_bytes / 1e9:.1g} GB of "
            "memory a job; compiling, once, comes on top"
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

    def over(stage: str, cost: Callable[[Config], Cost]) -> Cost:
        every = (cost(at.config) for at in combinations(config, *keys_behind(stage, config)))
        return functools.reduce(Cost.and_also, every, Cost())

    def rate(of: Config) -> PointCost:
        return measured(rate_name(of)) or point_cost(of)

    def traced(of: Config, count: int, *, summed: bool) -> Cost:
        seconds = rate(of).seconds
        sums = _SUMMING * of.spectrum.samples if summed else 0.0
        rays = of.tracing.rays if of.tracing.scheme == "vogel" else 0
        return Cost(count, count * (seconds + sums), 0.0, _JOB_BYTES + _RAY_MEMORY * rays)

    def scan(of: Config) -> Cost:
        count = of.focus_scan.focus.num
        cost = traced(of, count, summed=True)
        if of.tracing.scheme == "vogel":
            return cost
        tracing = of.tracing.model_copy(update={"scheme": "vogel"})
        spiral = of.model_copy(update={"tracing": tracing})
        return cost.and_also(traced(spiral, count, summed=False))

    def sweep(of: Config) -> Cost:
        count = of.focus_law.diameters.num * of.focus_law.fraction.num
        return traced(of, count, summed=True)

    def detected(of: Config) -> Cost:
        count = of.sweep.diameters.num
        disk = count * (rate(of).size + 40 * _PATHS[of.tracing.scheme])
        return traced(of, count, summed=False)._replace(disk_bytes=disk)

    def processed(each: float, bytes_each: float) -> Callable[[Config], Cost]:
        def cost(of: Config) -> Cost:
            values = of.sweep.diameters.num * of.spectrum.samples
            memory = _JOB_BYTES + _SAMPLE_MEMORY * of.spectrum.samples
            return Cost(0, each * values, bytes_each * values, memory)

        return cost

    stages = {
        "focus_scan": over("focus_scan", scan),
        "focus_sweep": over("focus_sweep", sweep),
        "detections": over("detections", detected),
        "spectra": over("spectra", processed(2 * _SUMMING, 8.0)),
        # magnitude and phase, and slopes, of half as many components
        "phase_slope": over("phase_slope", processed(_SUMMING, 12.0)),
    }
    return Estimate(math.prod(len(axis.rows) for axis in axes(config)), stages)


def expected(config: Config) -> Estimate:
    """Estimate what a run takes, by the rates that this cache's points were traced at.

    Raises
    ------
    CacheError
        If what the cache's name stands for is none that can be used.
    """
    try:
        store = opened(config.cache)
    except ConfigError:  # what is set for a cluster's jobs need not be where they are sent from
        store = None

    def measured(name: str) -> PointCost | None:
        rate = store.rates(name) if store else None
        if rate is None or rate.points < _ENOUGH:
            return None
        return PointCost(rate.bytes / rate.points, rate.cpu_seconds / rate.points)

    return estimate(config, functools.cache(measured))


def check_budget(config: Config, cost: Cost, folder: Path) -> None:
    """Refuse what takes more than is confirmed, or than there is room for.

    Parameters
    ----------
    config : Config
        The run.
    cost : Cost
        Of the stages that are to be made.
    folder : Path
        Where their datasets go; those that are there will be replaced.

    Raises
    ------
    ConfigError
        With the key that confirms it.
    """
    hours, disk = cost.cpu_seconds / 3600, cost.disk_bytes / 1e9
    budget, problems = config.budget, []
    if hours > budget.cpu_hours:
        problems.append(
            f"budget.cpu_hours: {budget.cpu_hours:g} given, but this run takes about {hours:.3g} "
            f"({cost.points} points); raise it to confirm, vary less, or ask for single datasets"
        )
    if disk > budget.disk_gigabytes:
        problems.append(
            f"budget.disk_gigabytes: {budget.disk_gigabytes:g} given, but this run's datasets take "
            f"about {disk:.3g}; raise it to confirm, or vary less"
        )
    there = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    held = sum(file.stat().st_size for file in folder.glob("*.nc")) / 1e9
    free = shutil.disk_usage(there).free / 1e9 + held
    if disk > free:
        problems.append(
            f"{folder}: {free:.3g} GB are free, but this run's datasets take about {disk:.3g}; "
            "make room, or vary less"
        )
    if problems:
        raise ConfigError("\n".join(problems))


def _time(seconds: float) -> str:
    for unit, length in (("h", 3600.0), ("min", 60.0)):
        if seconds >= length:
            return f"{seconds / length:.2g} {unit}"
    return f"{seconds:.2g} s"
