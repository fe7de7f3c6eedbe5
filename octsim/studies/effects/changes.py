"""How spectra with an effect differ from those without it, and how sure that is."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.optics.two_beams import aliasing_step
from octsim.phase.by_config import estimator_of
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.by_name import phases
from octsim.phase.estimators.visible import fringe_at
from octsim.phase.fringe_status import WITH_PHASE
from octsim.phase.slopes import gradient, phase_slopes, phase_steps, slope_of
from octsim.phase.transform import fourier_components, without_source

Array = NDArray[np.float64]
SINUSOID = Processing.model_validate({"estimator": "sinusoid"})
"""The sinusoid of least squares: its depth held, its offset and amplitude straight lines in k."""
FEWEST = 3
"""Diameters with a fringe that a line is laid through."""


class Seen(NamedTuple):
    """Spectra of D diameters, and what is read from them."""

    intensity: Array
    """(D, K)."""
    phase: Array
    """Of the sinusoid, (D,), rad; NaN without a fringe."""
    slope: Array
    """By the configured estimator, (D,), mrad/nm."""


class Change(NamedTuple):
    """By how much D diameters differ, of two `Seen`."""

    intensity: Array
    """ΔI over the largest I without the effect, (D, K)."""
    shape: Array
    """Change of I over its mean, (D, K)."""
    signal: Array
    """Mean of I, over that without the effect, (D,)."""
    phase: Array
    """(D,), rad."""
    slope: Array
    """By the configured estimator, (D,), mrad/nm."""

    def at(self, some: slice) -> "Change":
        """Return that of some of the diameters."""
        return Change(*(values[some] for values in self))

    def less(self, *others: "Change") -> "Change":
        """Return what is left of it beyond others."""
        return Change(*(own - sum(theirs) for own, *theirs in zip(self, *others, strict=True)))


class Measures(NamedTuple):
    """What a change comes to."""

    spectrum_change: float
    """Median over the diameters of max |ΔI| / max I."""
    shape_change: float
    """Median over the diameters of the largest change of I over its mean."""
    signal_ratio: float
    """Median over the diameters of the mean of I over that without the effect."""
    mean_slope_change: float
    """Slope of the line through the change of the phase, mrad/nm."""
    slope_change_scatter: float
    """Scatter of the change of the local slope over the diameters, mrad/nm."""
    worst_slope_change: float
    """Largest change of the local slope, mrad/nm."""
    configured_slope_change: float
    """Mean change of the slope by the configured estimator, mrad/nm."""
    configured_local_change: float
    """Scatter of that change over the diameters, mrad/nm."""


def seen(config: Config, diameter: Array, foci: Array, intensity: Array, error: Array) -> Seen:
    """Return what is read from spectra, at the optical depths of a config.

    Parameters
    ----------
    config : Config
        The baseline: who leaves an effect out reads spectra so.
    diameter, foci : ndarray, shape (D,)
        µm.
    intensity : ndarray, shape (D, K)
    error : ndarray, shape (D,)
        Its estimated errors; NaN or zero where there are none.
    """
    k, depth = config.spectrum.wavenumbers(), config.swept_group_index * diameter
    power = config.spectrum.power()
    status = fringe_at(intensity, k, depth, np.nan_to_num(error), power).status
    has = np.isin(status, WITH_PHASE)
    phase = np.full(diameter.size, np.nan)
    if has.any():
        phase[has] = phases(intensity[has], k, depth[has], SINUSOID, power).phase
    return Seen(intensity, phase, _configured(config, diameter, foci, intensity))


def _configured(config: Config, diameter: Array, foci: Array, intensity: Array) -> Array:
    """Return the slopes (D,) by the configured estimator, mrad/nm.

    They are NaN where its phases are not unwrapped.
    """
    if not unwraps(config, diameter):
        return np.full(diameter.size, np.nan)
    if config.processing.estimator == "fft":
        bare = without_source(intensity, config.spectrum.power())
        components = fourier_components(bare, config.processing)
        return phase_slopes(diameter, np.abs(components), np.angle(components)).strongest
    return slope_of(diameter, estimator_of(config, foci)(intensity, diameter).phase)


def unwraps(config: Config, diameter: Array) -> bool:
    """Return whether a phase turns by less than half between diameters (D,), µm."""
    k = config.spectrum.wavenumbers()
    step = np.diff(diameter).max(initial=0.0)
    return bool(0 < step < aliasing_step(config.swept_material, k[0], k[-1]))


def change(one: Seen, other: Seen) -> Change:
    """Return by how much one, with an effect, differs from the other, without it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        means = [spectra.intensity.mean(axis=1, keepdims=True) for spectra in (one, other)]
        shapes = [
            spectra.intensity / mean for spectra, mean in zip((one, other), means, strict=True)
        ]
        largest = other.intensity.max(axis=1, keepdims=True)
        return Change(
            (one.intensity - other.intensity) / largest,
            shapes[0] - shapes[1],
            (means[0] / means[1])[:, 0],
            unwrapped(one.phase - other.phase),
            one.slope - other.slope,
        )


def unwrapped(phase: Array) -> Array:
    """Return phases (D,) without turns between those that are known."""
    known = np.isfinite(phase)
    whole = phase.copy()
    whole[known] = np.unwrap(wrapped(phase[known]))
    return whole


def measures(change: Change, diameter: Array) -> Measures:
    """Return what a change comes to; NaN where the spectra have too few fringes."""
    local = local_slopes(change, diameter)
    known = local[np.isfinite(local)]
    scatter, worst = (known.std(), np.abs(known).max()) if known.size else (np.nan, np.nan)
    return Measures(
        _median(np.abs(change.intensity).max(axis=1)),
        _median(np.abs(change.shape).max(axis=1)),
        _median(change.signal),
        mean_slope(change.phase, diameter)[0],
        float(scatter),
        float(worst),
        float(change.slope.mean()),
        float(change.slope.std()),
    )


def local_slopes(change: Change, diameter: Array) -> Array:
    """Return the change of the local slope, (D,), mrad/nm; NaN beside what is not known."""
    return gradient(phase_steps(change.phase), diameter)


def mean_slope(phase: Array, diameter: Array) -> tuple[float, float]:
    """Return the slope of the line through phases, mrad/nm, and its standard error."""
    known = np.isfinite(phase)
    if known.sum() < FEWEST:
        return np.nan, np.nan
    x = diameter[known] - diameter[known].mean()
    line = np.polynomial.polynomial.polyfit(x, phase[known], 1)
    rest = phase[known] - np.polynomial.polynomial.polyval(x, line)
    error = np.sqrt((rest**2).sum() / max(known.sum() - 2, 1) / (x**2).sum())
    return float(line[1]), float(error)


def noise(fine: Change, rough: Change, diameter: Array) -> Measures:
    """Return how sure a change is: what it comes to by which two ways to find light differ.

    Parameters
    ----------
    fine, rough : Change
        Of the same diameters.
    diameter : ndarray, shape (D,)
        µm.
    """
    off = fine.less(rough)
    found = Measures(*np.abs(measures(off, diameter)))
    slope, error = mean_slope(off.phase, diameter)
    # a line may agree by chance where the phases do not
    return found._replace(
        signal_ratio=_median(np.abs(off.signal)), mean_slope_change=float(np.hypot(slope, error))
    )


def mean_phase_slope(seen: Seen, diameter: Array, predicted: float) -> float:
    """Return the slope of the line through the phases of spectra, mrad/nm.

    Parameters
    ----------
    predicted : float
        About what it is, mrad/nm: steps of the diameter may be large.
    """
    return mean_slope(unwrapped(seen.phase - predicted * diameter), diameter)[0] + predicted


def _median(values: Array) -> float:
    return float(np.median(values))


def stacked(found: Sequence[Measures]) -> dict[str, Array]:
    """Return measures by their names, each (N,)."""
    return {name: np.array([getattr(one, name) for one in found]) for name in Measures._fields}
