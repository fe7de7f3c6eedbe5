"""Causes of the slope's scatter, each of which can be switched off, and how much each carries.

The spectrum is known in parts (`beat`), so what the processing does to each can be told apart: what
it should do to the beat, and what leaks into the component whose phase it takes.
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.processing import Processing
from octsim.phase.derivatives import phase_advance
from octsim.phase.transform import centred_by, windowed
from octsim.studies.causes.beat import Parts

Array = NDArray[np.float64]
Causes = frozenset[str]

CAUSES: Mapping[str, tuple[str, str]] = {
    # name: (what it is, what stands in its place once it is switched off)
    "rays": ("the run's rays", "a converged sum over light paths"),
    "step": ("the difference over the sweep's step", "a derivative at a point"),
    "centre": ("the level that the processing subtracts", "the level of what does not oscillate"),
    "envelope": ("how what does not oscillate varies with k", "its level"),
    "paths": ("light reflected more than once", "none"),
    "image": ("the beat's image at negative depth", "the complex beat"),
    "bins": ("the strongest component of the FFT", "the transform at the depth nd itself"),
}
"""With none of them the slope is that of the beat's own phase."""
ALL: Causes = frozenset(CAUSES)


class Reading(NamedTuple):
    """How spectra are read, whatever is switched off."""

    processing: Processing
    n_neuron: float | Array
    """Index of the neuron, the same at all wavenumbers, or of each, (K,)."""
    diameter: Array
    """Of each spectrum, (D,), µm."""
    wavenumber: Array
    """(K,), 1/µm."""


class Stencil(NamedTuple):
    """Spectra between which a phase is differentiated, D of each."""

    below: Parts
    at: Parts
    above: Parts
    width: Array
    """From below to above, (D,), µm."""


def neighbours(swept: Parts, diameter: Array) -> Stencil:
    """Return the stencil of a sweep's neighbouring diameters, as `numpy.gradient` does.

    At the sweep's ends, which have one neighbour, the spectrum itself stands for the other.
    """
    row = np.arange(diameter.size)
    low, high = np.maximum(row - 1, 0), np.minimum(row + 1, diameter.size - 1)
    return Stencil(swept.take(low), swept, swept.take(high), diameter[high] - diameter[low])


def weights(processing: Processing, num: int) -> Array:
    """Return the window as weights that sum to one, (K,)."""
    window = windowed(np.ones(num), processing.window)
    relative: Array = window / window.sum()
    return relative


def true_level(parts: Parts, processing: Processing) -> Array:
    """Return the mean over the window of what does not oscillate, (D, 1)."""
    level: Array = (parts.still @ weights(processing, parts.still.shape[1]))[:, np.newaxis]
    return level


def signal(parts: Parts, present: Causes, processing: Processing) -> NDArray[np.complex128]:
    """Return spectra, centred and windowed, with only some of the causes present.

    Returns
    -------
    ndarray, shape (D, K)
        Real but for rounding where the cause ``image`` is present: Re z = (z + z*) / 2.
    """
    level = true_level(parts, processing)
    spectrum = parts.beat.real + (parts.still if "envelope" in present else level)
    if "paths" in present:
        spectrum = spectrum + parts.rest
    prepared = centred_by(spectrum, processing) if "centre" in present else spectrum - level
    complete = prepared.astype(np.complex128)
    if "image" not in present:
        complete -= parts.beat.conj() / 2
    complete *= weights(processing, prepared.shape[1])
    return complete


def strongest(prepared: NDArray[np.complex128]) -> NDArray[np.int64]:
    """Return the strongest component (D,) of the FFT of prepared spectra (D, K), not the 0th."""
    transformed = np.fft.fft(prepared)[:, : prepared.shape[1] // 2 + 1]
    component: NDArray[np.int64] = 1 + np.abs(transformed[:, 1:]).argmax(axis=1)
    return component


def _components(
    spectra: Sequence[NDArray[np.complex128]], present: Causes, reading: Reading
) -> list[NDArray[np.complex128]]:
    """Return the component (D,) whose phase is read of the spectra below, at and above."""
    if "bins" in present:
        transformed = [np.fft.fft(s)[:, : s.shape[1] // 2 + 1] for s in spectra]
        row, component = np.arange(reading.diameter.size), strongest(spectra[1])
        return [t[row, component] for t in transformed]
    k, n = reading.wavenumber, reading.n_neuron
    # the same reference for all three: it does not move with the diameter
    n, over = (1.0, n * k - n[0] * k[0]) if isinstance(n, np.ndarray) else (n, k - k[0])
    reference = np.exp(-2j * n * np.outer(reading.diameter, over))
    return [(s * reference).sum(axis=1) for s in spectra]


def slopes(stencil: Stencil, present: Causes, reading: Reading) -> Array:
    """Return the slope of the phase that is read with only some of the causes present.

    The causes ``rays`` and ``step`` are switched by the stencil.

    Returns
    -------
    ndarray, shape (D,)
        Phase slopes, rad/µm = mrad/nm.
    """
    spectra = [signal(p, present, reading.processing) for p in stencil[:3]]
    below, at, above = _components(spectra, present, reading)
    return (phase_advance(below, at) + phase_advance(at, above)) / stencil.width


def every_slope(choose: Callable[[Causes], Stencil], reading: Reading) -> dict[Causes, Array]:
    """Return the slopes (D,) with each of the subsets of the causes present.

    Parameters
    ----------
    choose : callable
        The stencil whose rays and step are those of a subset.
    reading : Reading
        How spectra are read.
    """
    subsets = [
        frozenset(some)
        for num in range(len(CAUSES) + 1)
        for some in itertools.combinations(CAUSES, num)
    ]
    return {present: slopes(choose(present), present, reading) for present in subsets}


def marginals(values: Mapping[Causes, Array], cause: str) -> dict[Causes, Array]:
    """Return what a cause adds to each subset of the others: value with it less value without."""
    return {
        others: values[others | {cause}] - value
        for others, value in values.items()
        if cause not in others
    }


def shapley(values: Mapping[Causes, Array]) -> dict[str, Array]:
    r"""Return each cause's part of the whole: the mean over all orders of switching them off.

    .. math:: \phi_c = \sum_{S \not\ni c} \frac{|S|!\,(m - |S| - 1)!}{m!}
       \left(v(S \cup c) - v(S)\right)

    (Shapley 1953). Parts sum to the value with all causes less that with none, at each diameter.

    Parameters
    ----------
    values : mapping
        Values (D,) with each subset of m causes present.
    """
    causes = max(values, key=len)
    num = len(causes)
    return {
        cause: np.sum(
            [
                added
                * (math.factorial(len(s)) * math.factorial(num - len(s) - 1) / math.factorial(num))
                for s, added in marginals(values, cause).items()
            ],
            axis=0,
        )
        for cause in causes
    }


class ShareStatus(IntEnum):
    """Whether the phase slope's variance is shared out."""

    KNOWN = 0
    NO_SCATTER = 1
    """The slope is the same at all diameters."""


def share_status(whole: Array) -> ShareStatus:
    """Return whether a whole varies, and so has shares of its variance."""
    off = whole - whole.mean()
    return ShareStatus.KNOWN if float(off @ off) > 0 else ShareStatus.NO_SCATTER


def variance_share(part: Array, whole: Array) -> float:
    """Return a part's share of a whole's variance: cov(part, whole) / var(whole).

    Shares of parts that sum to the whole, or to it less a constant, sum to one. That of a part
    which goes against the rest is negative. A whole that does not vary has NaN.
    """
    off = whole - whole.mean()
    variance = float(off @ off)
    return float(part @ off) / variance if variance > 0 else math.nan
