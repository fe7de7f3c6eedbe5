"""What is said of a cell: an error beside its bound, and what became of the cell."""

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

EPSILON = 2.0**-52
TOLERANCE = 1e-9
"""Error that is allowed whatever the condition: rad of phase, and relative for amplitudes."""
SAFETY = 8
NOTHING = 1e-40
"""Amplitude that 50 digits can't tell from none: a surface between equal indices."""


class Status(IntEnum):
    """What became of a cell."""

    WITHIN = 0
    """Every error is within max(1e-9, 8 ε × condition number)."""
    EDGE = 1
    """So too, but for rays at an edge: 50 digits and a double decide otherwise about them."""
    REFUSED = 2
    """octsim refuses the config, with a reason."""
    BEYOND = 3
    """An error is beyond the bound."""
    NOT_FINITE = 4
    """A result is infinite or not a number."""
    WARNED = 5
    """An error is beyond the bound, and octsim warns of it when it reads the config."""
    NO_SUCH_RAY = 6
    """No ray is at the edge that the cell asks for."""


class NumberStatus(IntEnum):
    """Whether a number of a cell is measured."""

    MEASURED = 0
    NOT_RUN = 1
    """The cell is not run; its status says why."""
    NO_PATH = 2
    """There is no path, ray or light of the kind that it is of."""


class Judgement(NamedTuple):
    """The largest error, the largest fraction of its bound, and the condition number there."""

    error: float
    condition: float
    of_bound: float


UNKNOWN = Judgement(math.nan, math.nan, math.nan)


@dataclass(frozen=True)
class Row:
    """What was measured in a cell; errors are NaN where there is nothing to compare."""

    status: Status
    reason: str = ""
    paths_compared: int = 0
    paths_at_edge: int = 0
    optical_path_length_error: float = math.nan
    phase: Judgement = UNKNOWN
    amplitude: Judgement = UNKNOWN
    phase_slope: Judgement = UNKNOWN
    spectrum: Judgement = UNKNOWN
    launch: Judgement = UNKNOWN
    single_phase_error: float = math.nan
    single_amplitude_error: float = math.nan
    single_lost: float = math.nan


def bound(condition: float) -> float:
    """Return the error that is allowed: max(1e-9, 8 ε × condition number)."""
    return max(TOLERANCE, SAFETY * EPSILON * condition)


def judged(error: float, condition: float) -> Judgement:
    """Return an error beside its bound."""
    return Judgement(error, condition, error / bound(condition))
