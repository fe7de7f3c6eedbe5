"""What the stages that trace have to do, and over how many jobs they are scattered."""

import math
from typing import NamedTuple

from octsim.config.alike import alike
from octsim.config.models import Config
from octsim.config.scheme import point_cost
from octsim.datasets.catalog import CATALOG
from octsim.datasets.keys import keys_behind, stages_of, with_the_same_axes

SCATTERED = tuple(row.name for row in CATALOG.values() if row.traces)
"""Stages that trace, and so may take long."""
_BLOCK_BYTES = 16e6
_BLOCK_SECONDS = 2.0
_MOST_POINTS = 512


def points_per_block(bytes_per_point: float, seconds_per_point: float = 0.0) -> int:
    """Return how many points are worked on between two writes: by memory and by time, at least one.

    It follows from the config alone, so that the same run gives the same file.
    """
    seconds = max(seconds_per_point, _BLOCK_SECONDS / _MOST_POINTS)
    most = min(_BLOCK_BYTES / bytes_per_point, _BLOCK_SECONDS / seconds, _MOST_POINTS)
    return max(1, int(most))


class Work(NamedTuple):
    """What a stage has to do at a plain config."""

    points: int
    """Points along the dimension that its blocks are cut from."""
    seconds: float
    """Processor time of one of them."""
    together: int
    """How many are in a block."""


def work_of(stage: str, config: Config) -> Work:
    """Return what a stage that traces has to do at a plain config."""
    points, cost = CATALOG[stage].points, point_cost(config)
    assert points is not None
    count, each = points(config)
    together = points_per_block(each * cost.size, each * cost.seconds)
    return Work(count, each * cost.seconds, together)


def shares_of(config: Config) -> dict[str, int]:
    """Return how many jobs each stage that traces is scattered over.

    They are of ``scatter.minutes`` of processor time each, or of one block where that takes longer,
    by rates that are the same everywhere: where a run is made does not change its jobs.
    """
    there = stages_of(config)
    traced = [stage for stage in SCATTERED if stage in there]
    seconds, blocks = dict.fromkeys(traced, 0.0), dict.fromkeys(traced, 0)
    for stages in with_the_same_axes(traced, config):
        for one, count in alike(config, *keys_behind(stages[0], config)):
            for stage in stages:
                work = work_of(stage, one)
                seconds[stage] += count * work.points * work.seconds
                blocks[stage] += count * math.ceil(work.points / work.together)
    each = 60 * config.scatter.minutes
    return {stage: max(1, min(round(seconds[stage] / each), blocks[stage])) for stage in traced}
