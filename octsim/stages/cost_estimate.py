"""What a run takes: points, processor time, memory and disk, known before it begins."""

import functools
import math
import shutil
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

from octsim.base.errors import ConfigError
from octsim.base.files import standing
from octsim.base.remembered import remembered
from octsim.config.alike import alike
from octsim.config.derive import by_light_paths, counting_rays
from octsim.config.grid import axes
from octsim.config.models import Config
from octsim.config.scheme import point_cost, rate_name, scheme_of
from octsim.config.tree import paths_by_digits
from octsim.datasets.catalog import CATALOG
from octsim.datasets.keys import keys_behind, stages_of, with_the_same_axes
from octsim.datasets.stage import RAYS, SUMMING, Stage
from octsim.instrument.point_store import open_store
from octsim.schemes.cost import PointCost

_SUMMING = 1e-7  # s a sample, of summing a spectrum
_RAY_SUMMING = 1.6e-9  # s a sample, of each ray that is summed
_LIGHT_MEMORY = 4.0  # times the bytes of a point's light, where that is read to be summed
_PATH_BYTES = 40  # of what is kept of each path of a point
_JOB_BYTES = 3e8  # of a process with its libraries, compiled code and blocks
_SAMPLE_MEMORY = 1000.0  # bytes, of each sample of the spectra in a block
_ENOUGH = 50  # points, to know what one takes
_SHORT = 60.0  # s; of what takes less nothing needs to be said


class Cost(NamedTuple):
    """What a stage takes at most, before anything is found in the cache."""

    points: int = 0
    """Points to trace."""
    cpu_seconds: float = 0.0
    """Processor time."""
    disk_bytes: float = 0.0
    """Of its datasets."""
    memory_bytes: float = _JOB_BYTES
    """Of its process, with one thread."""
    thread_bytes: float = 0.0
    """Of each thread more."""

    def and_also(self, other: "Cost") -> "Cost":
        """Return what two take, one after the other."""
        return Cost(
            self.points + other.points,
            self.cpu_seconds + other.cpu_seconds,
            self.disk_bytes + other.disk_bytes,
            max(self.memory_bytes, other.memory_bytes),
            max(self.thread_bytes, other.thread_bytes),
        )

    def times(self, count: int) -> "Cost":
        """Return what as many alike take, one after the other."""
        return Cost(
            count * self.points, count * self.cpu_seconds, count * self.disk_bytes,
            self.memory_bytes, self.thread_bytes,
        )  # fmt: skip

    def memory(self, threads: int) -> float:
        """Return the bytes of its process with some threads."""
        return self.memory_bytes + (threads - 1) * self.thread_bytes


class RunEstimate(NamedTuple):
    """What a run takes."""

    combinations: int
    """Of the grid; 1 without."""
    stages: Mapping[str, Cost]
    """By stage: those that trace, and those that take processor time or disk."""

    def of(self, *stages: str) -> Cost:
        """Return what some stages take together."""
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


def estimate(config: Config, measured: Callable[[str, PointCost], PointCost]) -> RunEstimate:
    """Estimate what a run takes.

    Parameters
    ----------
    config : Config
        The run.
    measured : callable
        Returns the measured cost of a point of a `rate_name`, where there is one, else the
        scheme's own, which it is given too.
    """

    @remembered
    def rate(of: Config) -> PointCost:
        return measured(rate_name(of), point_cost(of))

    def traced(of: Config, row: Stage, *, sums: bool) -> Cost:
        count, cost = math.prod(row.points(of) if row.points else (0,)), rate(of)
        summing = (_SUMMING + _RAY_SUMMING * cost.summed) * of.spectrum.samples if sums else 0.0
        disk = 0.0 if row.sums else count * (cost.size + _PATH_BYTES * cost.paths)
        seconds, memory = count * (cost.seconds + summing), _JOB_BYTES + cost.memory
        return Cost(count, seconds, disk, memory, cost.memory)

    def cost_of(row: Stage, of: Config) -> Cost:
        if row.traces:
            cost = traced(by_light_paths(of) if RAYS in row.reads else of, row, sums=row.sums)
            if row.counts_rays and not scheme_of(of).counts_rays:
                cost = cost.and_also(traced(counting_rays(of), row, sums=False))
            return cost
        values = of.sweep.diameters.num * of.spectrum.samples
        seconds, size = row.per_sample
        memory = _SAMPLE_MEMORY * of.spectrum.samples
        if SUMMING in row.reads:
            light = rate(of)
            seconds, memory = (
                seconds + _RAY_SUMMING * light.summed,
                memory + _LIGHT_MEMORY * light.size,
            )
        return Cost(0, seconds * values, size * values, _JOB_BYTES + memory, memory)

    there = stages_of(config)
    made = [
        row for row in CATALOG.values()
        if row.name in there and (row.traces or any(row.per_sample))
    ]  # fmt: skip
    stages = {row.name: Cost() for row in made}
    for names in with_the_same_axes(stages, config):
        for one, count in alike(config, *keys_behind(names[0], config)):
            for name in names:
                cost = cost_of(CATALOG[name], one).times(count)
                stages[name] = stages[name].and_also(cost)
    return RunEstimate(math.prod(len(axis.rows) for axis in axes(config)), stages)


def expected(config: Config) -> RunEstimate:
    """Estimate what a run takes, by the rates that this cache's points were traced at.

    Raises
    ------
    CacheError
        If what the cache's name stands for is none that can be used.
    """
    try:
        store = open_store(config.cache)
    except ConfigError:  # what is set for a cluster's jobs need not be where they are sent from
        store = None

    def measured(name: str, typical: PointCost) -> PointCost:
        rate = store.rates(name) if store else None
        if rate is None or rate.points < _ENOUGH:
            return typical
        size, seconds = rate.bytes / rate.points, rate.cpu_seconds / rate.points
        return typical._replace(size=size, seconds=seconds)

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
    budget, problems = config.budget, [*_uncounted(config)]
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
    held = sum(file.stat().st_size for file in folder.glob("*.nc")) / 1e9
    free = shutil.disk_usage(standing(folder)).free / 1e9 + held
    if disk > free:
        problems.append(
            f"{folder}: {free:.3g} GB are free, but this run's datasets take about {disk:.3g}; "
            "make room, or vary less"
        )
    if problems:
        raise ConfigError(*problems)


def _uncounted(config: Config) -> Iterator[str]:
    """Say where the light paths of a combination's scene can't be numbered."""
    for one, _ in alike(config, "scene", "tracing"):
        # of others the config has been checked, without a compiler
        if not scheme_of(one).counts_rays or paths_by_digits(one.scene):
            continue
        given = one.tracing.max_intersections
        most = import_module("octsim.instrument.path_room").most_intersections(one)
        if given > most:
            yield (
                f"tracing.max_intersections: {given} given, but the light paths of so many "
                f"meetings in this scene can't be numbered; give {most} or less"
            )
            return


def _time(seconds: float) -> str:
    for unit, length in (("h", 3600.0), ("min", 60.0)):
        if seconds >= length:
            return f"{seconds / length:.2g} {unit}"
    return f"{seconds:.2g} s"
