"""Where a camera is full, and which spectra reach it."""

import numpy as np
from numpy.typing import NDArray

from octsim.phase.cut_samples import are_cut

SEVERAL = 4
"""Samples of one spectrum on its largest value, from which that is where the camera is full."""
LEVELS = tuple(2**bits - 1 for bits in (8, 10, 12, 14, 16))
"""Largest counts of converters."""


def full_scale_of(first: NDArray[np.generic], given: float | None) -> float:
    """Return the counts at which a camera is full; infinite where nothing tells.

    As given; else the largest value of a converter that spectra reach and do not pass, or one at
    which samples of a spectrum pile up.

    Parameters
    ----------
    first : ndarray, shape (T, K)
        Spectra as they were recorded.
    given : float or None
        ``measured.full_scale``.
    """
    if given is not None:
        return given
    largest = first.max()
    if first.dtype.kind not in "ui":
        return np.inf
    full = int(largest) in LEVELS or are_cut(first[(first == largest).sum(axis=1) >= SEVERAL]).any()
    return float(largest) if full else np.inf


def saturated(counts: NDArray[np.generic], full_scale: float) -> NDArray[np.int64]:
    """Return how many samples of each spectrum (T, K) are at full scale or beyond, (T,).

    Where that is not known, a spectrum of whole numbers is full that has several samples on the
    largest value of a converter, and none beyond.
    """
    if np.isfinite(full_scale) or counts.dtype.kind not in "ui":
        beyond: NDArray[np.int64] = (np.asarray(counts) >= full_scale).sum(axis=1)
        return beyond
    largest = counts.max(axis=1)
    found = np.zeros(len(counts), np.int64)
    for row in np.flatnonzero(np.isin(largest, LEVELS)).tolist():
        on_it = int((counts[row] == largest[row]).sum())
        found[row] = on_it if on_it >= SEVERAL else 0
    return found
