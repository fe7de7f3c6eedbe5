"""Pairs of the largest effects: whether they are the sum of their parts."""

import itertools
import math
from typing import Any, NamedTuple

import numpy as np

from octsim.datasets.files import flags
from octsim.studies.effects.bench import Bench, Result, some
from octsim.studies.effects.changes import Measures, measures, stacked
from octsim.studies.effects.missing import ChangeStatus, change_status, change_statuses
from octsim.studies.effects.needed import MEAN_TOLERANCE, ranks
from octsim.studies.effects.variants import EffectStatus, combined

KINDS = 4
"""Effects, each the largest of its kind, of which every pair is measured."""
_FOR_PAIRS = 4
"""Every so many of the diameters are looked at."""


class Pair(NamedTuple):
    """Two effects at once."""

    parts: tuple[int, int]
    """Their places among the results."""
    result: Result
    excess: Measures
    """What they have beyond the sum of each alone."""
    total: float
    """That sum, of the mean slope, mrad/nm."""
    sure: float
    """Noise of what the mean slope has beyond it, mrad/nm."""


def pairs_of(bench: Bench, results: list[Result]) -> list[Pair]:
    """Return the pairs of the largest effects, of different kinds, that the scheme can have."""
    fewer, found = bench.every(_FOR_PAIRS), []
    for parts in itertools.combinations(largest(results), 2):
        both = combined(bench.config, [results[place].variant for place in parts])
        if both is None:
            continue
        spectra = fewer.swept(both)
        whole = fewer.changed(spectra)
        singles = [fewer.changed(some(results[p].spectra, _FOR_PAIRS)) for p in parts]
        alone = [measures(one, fewer.diameter).mean_slope_change for one in singles]
        excess = measures(whole.less(*singles), fewer.diameter)
        said = measures(whole, fewer.diameter)
        result = Result(both, EffectStatus.MEASURED, spectra, whole, said)
        sure = math.hypot(*(results[place].noise.mean_slope_change for place in parts))
        found.append(Pair(parts, result, excess, sum(alone), sure))
    return found


def largest(results: list[Result]) -> list[int]:
    """Return the places of the effects whose pairs are measured, the largest first.

    Each is the largest of its kind, by what it does to the mean slope, and above its noise. What
    the config itself has is not among them: all else is measured in its presence.
    """
    chosen: dict[str, int] = {}
    order = ranks(np.array([one.measures.mean_slope_change for one in results]))
    for place in sorted(np.flatnonzero(order).tolist(), key=lambda place: int(order[place])):
        one = results[place]
        sure = abs(one.measures.mean_slope_change) > one.noise.mean_slope_change
        if sure and not one.variant.configured and one.variant.effect.kind not in chosen:
            chosen[one.variant.effect.kind] = place
    return list(chosen.values())[:KINDS]


def columns_of(
    bench: Bench, results: list[Result], pairs: list[Pair], slope: float
) -> dict[str, Any]:
    """Return what a dataset has of pairs, where the mean slope as configured is known, mrad/nm."""
    measured = stacked([pair.result.measures for pair in pairs])
    excess = np.array([pair.excess.mean_slope_change for pair in pairs])
    total = np.array([pair.total for pair in pairs])
    local = np.array([pair.excess.slope_change_scatter for pair in pairs])
    told = change_statuses(bench.every(_FOR_PAIRS), measured)
    told["excess_status"] = flags(ChangeStatus, change_status(total + excess + local))
    sure = np.array([pair.sure for pair in pairs])
    names = [[results[place].variant.effect.name for place in pair.parts] for pair in pairs]
    columns: dict[str, Any] = {
        **{f"pair_{name}": values for name, values in measured.items()},
        "pair_calibration_change": measured["mean_slope_change"] / slope,
        "pair_sum": total,
        "pair_excess": excess,
        "pair_excess_noise": sure,
        "pair_local_excess": local,
        "pair_adds_up": (
            np.abs(excess) <= np.maximum(sure, MEAN_TOLERANCE * abs(slope))
        ).astype(np.int8),
        "pair_cost_ratio": np.array(
            [pair.result.spectra.cost_ratio for pair in pairs]
        ),
        "pair_first": [first for first, _ in names],
        "pair_second": [second for _, second in names],
    }  # fmt: skip
    return {
        **{name: ("pair", values) for name, values in columns.items()},
        **{f"pair_{name}": ("pair", *status) for name, status in told.items()},
    }
