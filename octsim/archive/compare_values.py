"""How far the values of one variable are from those of another."""

from collections.abc import Iterable
from enum import Enum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.phase.derivatives import wrapped

MEASURED = frozenset(
    {
        "cpu_seconds", "peak_memory", "estimator_seconds", "phase_slope_frontier",
        "maxwell_frontier", "maxwell_slope_frontier", "baseline_seconds", "cost_ratio",
        "pair_cost_ratio", "effect_cost_ratio",
    }
)  # fmt: skip
"""Variables that a clock or the system gave, or that follow from one: another run has others."""
WRAPPED = frozenset(
    {"phase", "field_phase", "estimated_phase", "fringe_phase", "spike_leaked_phase"}
)
"""Angles that are known but for whole turns."""

UNKNOWN = frozenset({"phase", "component_phase_slope"})
"""Those that are NaN where a component holds nothing but rounding. Files of 0.1.0 have a number
there, and another processor may have: a point that one of the two calls NaN is not compared."""


class ValueKind(Enum):
    """How a variable is judged."""

    NUMBER = "number"
    """By the relative difference."""
    ANGLE = "angle"
    """The same, modulo 2π."""
    EXACT = "exact"
    """Whole numbers, text, flags and coordinates: every value has to be equal."""
    MEASURED = "measured"
    """Not at all."""


class Deviation(NamedTuple):
    """How far a variable is from another of as many values."""

    relative: float = 0.0
    """max |a − b| / max |b| over the values that are finite in both."""
    misplaced: int = 0
    """Number of values that are NaN, or infinite, in one and something else in the other."""
    unequal: int = 0
    """Number of values that are not equal, where they have to be."""
    values: int = 0
    """Number of values compared."""
    unknown: int = 0
    """Number of values left out, as one of the two says that it holds nothing but rounding."""
    scale: float = 0.0
    """max |b|."""


def value_kind(name: str, dtype: np.dtype[Any], is_coordinate: bool) -> ValueKind:
    """Return how a variable is judged."""
    if name in MEASURED:
        return ValueKind.MEASURED
    if is_coordinate or dtype.kind != "f":
        return ValueKind.EXACT
    return ValueKind.ANGLE if name in WRAPPED else ValueKind.NUMBER


def deviation(
    blocks: Iterable[tuple[NDArray[Any], NDArray[Any]]],
    kind: ValueKind,
    may_be_unknown: bool = False,
) -> Deviation:
    """Compare values that come in blocks of the same shape.

    Parameters
    ----------
    blocks : iterable
        Values of the one and of the other.
    kind : Kind
        How they are judged.
    may_be_unknown : bool
        Whether a NaN says of a value that nothing but rounding is known of it.
    """
    largest = scale = 0.0
    misplaced = unequal = values = unknown = 0
    for one, other in blocks:
        values += one.size
        same = one == other
        if one.dtype.kind == "f":
            same |= np.isnan(one) & np.isnan(other)
        if kind is ValueKind.EXACT or one.dtype.kind != "f":
            unequal += int((~same).sum())
            continue
        finite = np.isfinite(one) & np.isfinite(other)
        elsewhere = ~same & ~finite
        if may_be_unknown:
            left_out = elsewhere & (np.isnan(one) | np.isnan(other))
            unknown += int(left_out.sum())
            elsewhere &= ~left_out
        misplaced += int(elsewhere.sum())
        with np.errstate(over="ignore"):  # of damaged values: then it is infinite, and said so
            difference = one[finite] - other[finite]
        if kind is ValueKind.ANGLE:
            difference = wrapped(difference)
        largest = max(largest, float(np.abs(difference).max(initial=0.0)))
        scale = max(scale, float(np.abs(other[finite]).max(initial=0.0)))
    relative = largest / scale if scale else np.inf if largest else 0.0
    return Deviation(relative, misplaced, unequal, values, unknown, scale)
