"""Phases with what is known of them: residual, visibility, noise, standard errors and status."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from octsim.config.processing import Processing
from octsim.phase.cut_samples import are_cut
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.by_name import expected_depths, phases
from octsim.phase.estimators.estimate import Array, Estimate, Phases
from octsim.phase.estimators.fft import peak_depths
from octsim.phase.estimators.sinusoid import Fit, fit_sinusoid
from octsim.phase.estimators.visible import (
    SIGNIFICANT,
    Leftover,
    fringe_power,
    leftover,
    seen,
    unusable,
)
from octsim.phase.fringe_status import WITH_PHASE, FringeStatus
from octsim.phase.transform import without_source

POOR = 6e-3
"""Shape of the residual, over the fringe, from which the fit is poor; root mean squares. octsim's
own spectra, of gaps to 100 nm, have up to 5.3e-3 (docs/phases.md)."""
FAR = 0.25
"""How far a fringe may be from its nominal depth, in oscillations over the band."""
DRAWS = 32
"""Of noise, by which errors of an estimator that is no fit are found: they are known to 12 %."""
_SEED = 20231115


def estimate(
    intensity: Array,
    wavenumber: Array,
    nominal: Array,
    processing: Processing,
    cut: NDArray[np.bool_] | None = None,
    source: Array | None = None,
) -> Estimate:
    """Estimate the phase of spectra as the processing says, and say how well it is known.

    Residual, visibility, noise and status are those of a sinusoid on polynomials at a fitted depth,
    whatever the estimator. The standard errors are the estimator's own: of the sinusoid they follow
    from the covariance of its fit, of others from `DRAWS` of noise that is added to a sinusoid.

    Parameters
    ----------
    intensity : ndarray, shape (D, K)
        Spectra.
    wavenumber : ndarray, shape (K,)
        Evenly spaced, increasing wavenumbers, 1/µm.
    nominal : ndarray, shape (D,)
        Nominal optical depths n_neuron · diameter, µm, for ``processing.depth: nominal``; NaN where
        they are not known.
    processing : Processing
        Which estimator, at which depth, with which options.
    cut : ndarray, shape (D,), optional
        Which spectra have samples that are cut, where they were interpolated since.
    source : ndarray, shape (K,), optional
        The source's power; None of a flat one.
    """
    intensity = np.ascontiguousarray(intensity)
    cut = are_cut(intensity) if cut is None else cut
    start = _expected(intensity, wavenumber, nominal, processing, source)
    given = processing.depth if isinstance(processing.depth, float) else np.nan
    known = np.where(np.isfinite(nominal), nominal, given)
    status, residual = unusable(intensity, wavenumber, start), intensity.std(axis=1)
    found = np.full((6, len(intensity)), np.nan)
    rows = np.flatnonzero(status == FringeStatus.VISIBLE)
    fits = _fitted(intensity[rows], wavenumber, nominal[rows], start[rows], processing, source)
    for chunk, own, fit in fits:
        part = rows[chunk]
        spectra = intensity[part]
        left = leftover(spectra, wavenumber, fit)
        noise = np.sqrt(left.noise)
        if isinstance(own, Fit):
            errors = own.unit_errors()[1:]
            errors = errors[0] * noise, errors[1] * noise
        else:
            errors = _drawn(wavenumber, nominal[part], processing, fit, noise, source)
        far = _far(wavenumber, known[part], fit, noise)
        seen_as, at_depth = (
            seen(spectra, fit, left, source),
            unusable(spectra, wavenumber, fit.depth),
        )
        # the depth where it is may be too small, where the expected one was not
        short = np.isin(seen_as, WITH_PHASE) & (at_depth != FringeStatus.VISIBLE)
        seen_as = np.where(short, at_depth, seen_as)
        status[part] = _judged(seen_as, cut[part], far, fit, left)
        residual[part] = np.sqrt(((spectra - fit.fitted) ** 2).mean(axis=1))
        visibility = np.abs(fit.amplitude[:, 0]) / np.abs(fit.offset[:, 0])
        values = np.stack([own.phase, own.depth, visibility, _decibels(fit, noise), *errors])
        found[:, part] = np.where(np.isin(status[part], WITH_PHASE), values, np.nan)
    phase, depth, visible, ratio, phase_error, depth_error = found
    return Estimate(phase, depth, residual, visible, ratio, phase_error, depth_error, status)


def reference(processing: Processing) -> Processing:
    """Return the sinusoid that tells how good a fringe is: at a fitted depth, on slopes or more."""
    asked = processing.sinusoid
    sinusoid = asked.model_copy(
        update={
            "depth": "fitted",
            "envelope": "each",
            "offset_degree": max(1, asked.offset_degree),
            "amplitude_degree": max(1, asked.amplitude_degree),
        }
    )
    return processing.model_copy(update={"estimator": "sinusoid", "sinusoid": sinusoid})


def _expected(
    intensity: Array, wavenumber: Array, nominal: Array, processing: Processing,
    source: Array | None,
) -> Array:  # fmt: skip
    """Return where fringes are expected, (D,), µm: of fft, which is told nothing, at the peak."""
    if processing.estimator != "fft":
        return expected_depths(intensity, wavenumber, nominal, processing, source)
    peaks = peak_depths(without_source(intensity, source), wavenumber, processing)
    return np.where(np.isfinite(nominal), nominal, peaks)


def _fitted(
    intensity: Array, wavenumber: Array, nominal: Array, start: Array, processing: Processing,
    source: Array | None,
) -> Iterator[tuple[slice, Fit | Phases, Fit]]:  # fmt: skip
    """Return which spectra, their phases and the reference's fit, some spectra at a time."""
    asked = reference(processing)
    if processing.estimator == "sinusoid":
        for part, own in fit_sinusoid(intensity, wavenumber, start, processing, source):
            if asked == processing:
                yield part, own, own
            else:
                _, fit = next(fit_sinusoid(intensity[part], wavenumber, own.depth, asked, source))
                yield part, own, fit
    elif start.size:
        found = phases(intensity, wavenumber, nominal, processing, source)
        near = start if processing.estimator == "fft" else found.depth
        near = np.where(near > 0, near, start)
        for part, fit in fit_sinusoid(intensity, wavenumber, near, asked, source):
            yield part, Phases(found.phase[part], found.depth[part]), fit


def _drawn(
    wavenumber: Array, nominal: Array, processing: Processing, fit: Fit, noise: Array,
    source: Array | None,
) -> tuple[Array, Array]:  # fmt: skip
    """Return standard errors of phase (rad) and depth (µm) by draws of noise, each (D,).

    Each spectrum has the same draws, so that its errors are its own.
    """
    generator = np.random.default_rng(_SEED)
    deviation = noise[:, np.newaxis] / fit.root
    without = phases(fit.fitted, wavenumber, nominal, processing, source)
    total, square = np.zeros((2, 2, fit.depth.size))
    for _ in range(DRAWS):
        noisy = fit.fitted + deviation * generator.standard_normal(wavenumber.size)
        found = phases(noisy, wavenumber, nominal, processing, source)
        moved = np.stack([wrapped(found.phase - without.phase), found.depth - without.depth])
        total += moved
        square += moved**2
    # about their mean: noise shifts a midpoint as well, by the same in every spectrum of a series
    phase, depth = np.sqrt(np.maximum(square - total**2 / DRAWS, 0) / (DRAWS - 1))
    held = processing.estimator == "zero_padded" and processing.depth != "peak"
    return phase, np.full_like(depth, np.nan) if held else depth


def _decibels(fit: Fit, noise: Array) -> Array:
    """Return the signal-to-noise ratios (D,), dB."""
    variance = noise**2 * (1 / fit.root**2).mean(axis=1)
    power = ((fit.fitted - fit.below) ** 2).sum(axis=1)
    with np.errstate(divide="ignore"):
        ratio: Array = 10 * np.log10(power / (2 * variance))
    return ratio


def _far(wavenumber: Array, known: Array, fit: Fit, noise: Array) -> NDArray[np.bool_]:
    """Return which fringes are not at their nominal depth, (D,)."""
    error = fit.unit_errors()[2] * noise
    apart = FAR * np.pi / (wavenumber[-1] - wavenumber[0])
    # without a nominal depth none is far from it
    far: NDArray[np.bool_] = np.abs(fit.depth - known) > np.maximum(apart, SIGNIFICANT * error)
    return far


def _judged(
    seen_as: NDArray[np.int8],
    cut: NDArray[np.bool_],
    far: NDArray[np.bool_],
    fit: Fit,
    left: Leftover,
) -> NDArray[np.int8]:
    """Return the status (D,): the gravest that a spectrum has."""
    shaped = left.shape > SIGNIFICANT * left.shape_error
    conditions = {
        FringeStatus.SATURATED: cut,
        FringeStatus.FAR_FROM_NOMINAL: far,
        FringeStatus.MIXED: seen_as == FringeStatus.MIXED,
        FringeStatus.POOR_FIT: shaped & (left.shape > POOR**2 * fringe_power(fit)),
    }
    doubted = np.select(list(conditions.values()), list(conditions), FringeStatus.VISIBLE)
    return np.where(np.isin(seen_as, WITH_PHASE), doubted, seen_as).astype(np.int8)
