"""Whether spectra have a fringe at a depth: decided here, for simulated and measured ones."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import OctsimError
from octsim.config.processing import Processing
from octsim.phase.estimators.estimate import Array
from octsim.phase.estimators.sinusoid import Fit, fit_sinusoid
from octsim.phase.fringe_status import WITH_PHASE, FringeStatus
from octsim.phase.transform import centred, optical_depths, rounding_level

FEWEST_OSCILLATIONS = 0.75
"""Over the band: of less a curve that is no oscillation has as much."""
FEWEST_SAMPLES = 8
"""Of a spectrum: the fit has six parameters."""
CURVE = 5
"""Degree of the polynomial that a fringe has to describe a spectrum better than, with as many
parameters as the sinusoid on its offset."""
OTHERS, MIXED = 0.5, 0.1
"""How strong, over the fringe, what oscillates at other depths is where it hides that, and where
it is to be doubted; root mean squares over the band."""
SIGNIFICANT = 5.0
"""Standard errors by which something has to differ from noise."""
_UNCERTAIN = 0.3  # of the noise's power, that its estimate from one spectrum may be off by
_HELD = Processing.model_validate({"estimator": "sinusoid"})
_MEDIAN = 0.4549364  # of the square of a normal deviate
_BEYOND = 16  # half periods more than three times the fringe's that a smooth shape may have


class Leftover(NamedTuple):
    """What fits leave of D spectra, as mean squares over the samples; each (D,)."""

    whole: Array
    """Of the residual."""
    noise: Array
    """Variance of a sample: of what changes from one to the next."""
    shape: Array
    """What the residual has, beyond noise, that changes as slowly as the fringe's harmonics."""
    shape_error: Array
    """Standard error of that, by the noise."""


def unusable(intensity: Array, wavenumber: Array, depth: Array) -> NDArray[np.int8]:
    """Return the status (D,) of spectra (D, K) that can't have a fringe at depths (D,), µm.

    The others are `FringeStatus.VISIBLE` as yet.
    """
    intervals = wavenumber.size - 1
    oscillations = depth * (wavenumber[-1] - wavenumber[0]) / np.pi
    conditions = {
        FringeStatus.NO_SPECTRUM: np.isnan(intensity).any(axis=1),
        FringeStatus.NO_LIGHT: ~(np.abs(intensity) > 0).any(axis=1),
        FringeStatus.NO_FRINGE: np.ptp(intensity, axis=1) <= _rounding(intensity),
        FringeStatus.TOO_FEW_OSCILLATIONS: oscillations < FEWEST_OSCILLATIONS,
        FringeStatus.NOT_RESOLVED: (intervals <= 2 * oscillations)
        | (wavenumber.size < FEWEST_SAMPLES),
    }
    return np.select(list(conditions.values()), list(conditions), FringeStatus.VISIBLE).astype(
        np.int8
    )


def _rounding(intensity: Array) -> Array:
    """Return the amplitude (D,) below which there is nothing but rounding in spectra (D, K)."""
    level: Array = rounding_level(intensity, _HELD)[:, 0] / intensity.shape[1]
    return level


def leftover(intensity: Array, wavenumber: Array, fit: Fit) -> Leftover:
    r"""Tell noise from shape in the residual r of fits to spectra (D, K).

    By its cosine transform, in whose coefficients white noise is the same everywhere,

    .. math:: c_m^2 = \frac{2}{K} \Big(\sum_j r_j \cos\frac{\pi m (j + 1/2)}{K}\Big)^2.

    The noise is the median of those above three times the fringe's own: a few strong ones, of
    fringes at other depths, don't move it. It is looked for below half of the largest m, where
    there are enough, as interpolation smooths what is above.
    """
    residual = (intensity - fit.fitted) * fit.root
    samples = residual.shape[1]
    mirrored = np.concatenate([residual, residual[:, ::-1]], axis=1)
    power = np.abs(np.fft.rfft(mirrored, axis=1)[:, :samples]) ** 2 / (2 * samples)
    half_periods = 2 * fit.depth * (wavenumber[-1] - wavenumber[0]) / np.pi
    slow = np.minimum(3 * half_periods.astype(int) + _BEYOND, samples // 2)
    most = np.where(slow < samples // 4, samples // 2, samples)
    noise, shape = np.empty((2, len(residual)))
    for row, (one, low, high) in enumerate(zip(power, slow, most, strict=True)):
        noise[row] = np.median(one[low:high]) / _MEDIAN
        # the fit has taken as many coefficients' noise away as it has parameters
        shape[row] = one[:low].sum() - (low - fit.triangle.shape[1]) * noise[row]
    error = (np.sqrt(2.0 * slow) + _UNCERTAIN * slow) * noise
    whole = power.sum(axis=1) / samples
    return Leftover(whole, noise, np.maximum(shape, 0) / samples, error / samples)


def fringe_power(fit: Fit) -> Array:
    """Return the mean square (D,) of the fringe in the fits, by their weights."""
    fringe = (fit.fitted - fit.below) * fit.root
    power: Array = (fringe**2).mean(axis=1)
    return power


def seen(
    intensity: Array, fit: Fit, left: Leftover, source: Array | None = None
) -> NDArray[np.int8]:
    """Return whether the fringe of fits is there: the status (D,) of spectra (D, K).

    There is none if its amplitude is within noise or rounding, or if a polynomial of degree
    `CURVE`, times the source, is nearer to the spectrum. What the residual has beyond noise is of
    other depths.
    """
    amplitude, samples = np.abs(fit.amplitude[:, 0]), intensity.shape[1]
    error = fit.unit_errors()[0] * np.sqrt(left.noise)
    curve = (_without_curve(intensity, source) ** 2).mean(axis=1)
    sinusoid = ((intensity - fit.fitted) ** 2).mean(axis=1)
    unweighted = left.noise * np.where(left.whole > 0, sinusoid / left.whole, 1)
    # the chance of noise to be described better is that of as few parameters as they differ in
    nearer = sinusoid - curve > SIGNIFICANT**2 * unweighted / samples
    others = left.whole - (1 + _UNCERTAIN) * left.noise
    conditions = {
        FringeStatus.NO_FRINGE: (amplitude < np.maximum(SIGNIFICANT * error, _rounding(intensity)))
        | nearer,
        FringeStatus.OTHER_DEPTHS: others > OTHERS**2 * fringe_power(fit),
        FringeStatus.MIXED: others > MIXED**2 * fringe_power(fit),
    }
    found = np.select(list(conditions.values()), list(conditions), FringeStatus.VISIBLE)
    # a fit that went astray is none either
    return np.where(np.isfinite(amplitude), found, FringeStatus.NO_FRINGE).astype(np.int8)


def _without_curve(intensity: Array, source: Array | None) -> Array:
    """Return what a polynomial, times the source, leaves of spectra (D, K)."""
    if source is None:
        return centred(intensity, "polynomial", "boxcar", CURVE)
    x = np.linspace(-1, 1, source.size)
    curves = np.polynomial.legendre.legvander(x, CURVE) * source[:, np.newaxis]
    orthogonal, _ = np.linalg.qr(curves)
    left: Array = intensity - (intensity @ orthogonal) @ orthogonal.T
    return left


def is_elsewhere(
    component: NDArray[np.int64], wavenumber: Array, depth: Array
) -> NDArray[np.bool_]:
    """Return whether components (D,) are more than one and a half from depths (D,), µm."""
    at = optical_depths(wavenumber)
    away: NDArray[np.bool_] = np.abs(at[component] - depth) > 1.5 * at[1]
    return away


class Fringe(NamedTuple):
    """The fringe of D spectra at their nominal depth."""

    visibility: Array
    """Its amplitude over its offset in the middle of the band, (D,); NaN where there is none."""
    status: NDArray[np.int8]
    """`FringeStatus` of each, (D,)."""


def fringe_at(
    intensity: Array, wavenumber: Array, depth: Array, error: Array | float = 0.0,
    source: Array | None = None,
) -> Fringe:  # fmt: skip
    """Look for the fringe of spectra (D, K) at nominal optical depths (D,), µm.

    Parameters
    ----------
    intensity : ndarray, shape (D, K)
        Spectra; NaN where there is none.
    wavenumber : ndarray, shape (K,)
        Evenly spaced wavenumbers, 1/µm.
    depth : ndarray, shape (D,)
        Nominal optical depths n_neuron · diameter, µm.
    error : ndarray, shape (D,), or float
        Estimated error of the intensity, over its largest.
    source : ndarray, shape (K,), optional
        The source's power; None of a flat one.
    """
    intensity = np.ascontiguousarray(intensity)
    status, visibility = unusable(intensity, wavenumber, depth), np.full(len(intensity), np.nan)
    rows = np.flatnonzero(status == FringeStatus.VISIBLE)
    for chunk, fit in fit_sinusoid(intensity[rows], wavenumber, depth[rows], _HELD, source):
        part = rows[chunk]
        found = seen(intensity[part], fit, leftover(intensity[part], wavenumber, fit), source)
        amplitude = np.abs(fit.amplitude[:, 0])
        least = np.broadcast_to(error, status.shape)[part] * intensity[part].max(axis=1)
        hidden = (found != FringeStatus.NO_FRINGE) & (amplitude < least)
        status[part] = np.where(hidden, FringeStatus.WITHIN_ERROR, found)
        known = np.isin(status[part], WITH_PHASE)
        visibility[part] = np.where(known, amplitude / np.abs(fit.offset[:, 0]), np.nan)
    return Fringe(visibility, status)


def require_fringe(
    what: str, intensity: Array, wavenumber: Array, depth: Array, error: Array | float = 0.0,
    source: Array | None = None,
) -> None:  # fmt: skip
    """Refuse spectra for a purpose that needs a phase of each; see `fringe_at`.

    Raises
    ------
    OctsimError
        If one has none; with the first such depth, its status and the remedy.
    """
    status = fringe_at(intensity, wavenumber, depth, error, source).status
    without = np.flatnonzero(~np.isin(status, WITH_PHASE))
    if without.size:
        one = FringeStatus(int(status[without[0]]))
        raise OctsimError(
            f"{what}: no phase at an optical depth of {depth[without[0]]:.4g} um "
            f"({one.name.lower()}), and at {without.size - 1} others: {one.remedy}"
        )
