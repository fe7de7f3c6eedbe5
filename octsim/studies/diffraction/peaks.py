"""The three peaks of figure 6: where each is, how wide and how high."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
WINDOWS = {"glass": (-0.25, 0.25), "middle": (0.3, 0.88), "far side": (0.88, 1.8)}
"""Where each is looked for, as a fraction of the diameter."""


class PeakStatus(IntEnum):
    """Whether a peak is found, and has a width."""

    KNOWN = 0
    NO_PEAK = 1
    """The intensity has no maximum where it is looked for."""
    NO_WIDTH = 2
    """It does not fall to half of its height on both sides before it rises above it."""


class Peak(NamedTuple):
    """A peak of the intensity over the focus; NaN where there is none."""

    focus: float
    """µm."""
    width: float
    """Full width at half of its height, µm; NaN where it has none."""
    height: float

    @property
    def status(self) -> PeakStatus:
        """Whether it is there, and has a width."""
        if np.isnan(self.height):
            return PeakStatus.NO_PEAK
        return PeakStatus.NO_WIDTH if np.isnan(self.width) else PeakStatus.KNOWN


def peak_within(focus: Array, intensity: Array, first: float, last: float) -> Peak:
    """Return the highest local maximum between two foci (µm), of a scan over foci (F,)."""
    inner = np.arange(1, focus.size - 1)
    rises = intensity[inner] > intensity[inner - 1]
    falls = intensity[inner] >= intensity[inner + 1]
    within = (focus[inner] >= first) & (focus[inner] <= last)
    found = inner[rises & falls & within]
    if not found.size:
        return Peak(np.nan, np.nan, np.nan)
    top = int(found[intensity[found].argmax()])
    height = float(intensity[top])
    ends = [_half(focus, intensity, top, step) for step in (-1, 1)]
    return Peak(float(focus[top]), ends[1] - ends[0], height)


def _half(focus: Array, intensity: Array, top: int, step: int) -> float:
    """Return where the intensity falls to half on one side, by straight lines."""
    half, place = intensity[top] / 2, top + step
    while 0 <= place < focus.size and half < intensity[place] <= intensity[top]:
        place += step
    if not 0 <= place < focus.size or intensity[place] > intensity[top]:
        return np.nan
    before = place - step
    part = (intensity[before] - half) / (intensity[before] - intensity[place])
    return float(focus[before] + part * (focus[place] - focus[before]))
