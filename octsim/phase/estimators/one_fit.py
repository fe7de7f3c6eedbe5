r"""Phases of a long series of spectra by one least-squares fit, made once.

The spectra of a neuron are all but the same, so that the columns of the fit (depth, source,
dispersion) and its weights are those of their mean, and the parameters of each spectrum are one
matrix product,

.. math:: \theta_t = (C^T W C)^{-1} C^T W I_t = P I_t, \quad \mathrm{cov}\,\theta = P V P^T,

with the model of `octsim.phase.estimators.sinusoid` and the variance V of a sample's counts.
Samples are taken where the spectrometer has them, at no other wavenumber: W has the width of each
in k, so that a sum over them is the integral that evenly spaced ones have.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.processing import Sinusoid
from octsim.phase.derivatives import wrapped
from octsim.phase.estimators.estimate import oscillation
from octsim.phase.estimators.sinusoid import WEIGHTS, Envelope, columns_of, polynomials, waves_of

Array = NDArray[np.float64]
_ROUNDS = 4


class Model(NamedTuple):
    """What every spectrum of a series is fitted with."""

    wavenumber: Array
    """(K,), 1/µm, rising in any steps."""
    depth: float
    """Held, µm."""
    options: Sinusoid
    source: Array | None = None
    """Power of the source, (K,); None of a flat one."""
    turned: Array | None = None
    """Phase that dispersion adds to the fringe, (K,), rad."""
    reference_depth: float | None = None
    """Of a reflector that does not move, µm."""


class Design(NamedTuple):
    """The fit of a series."""

    columns: Array
    """C, (K, N)."""
    solver: Array
    """P, (N, K)."""
    cosine: int
    """Place of the fringe's cosine among the parameters; its sine stands `step` behind."""
    step: int
    reference: int | None
    """Place of the cosine of what does not move; its sine stands next."""


class Fitted(NamedTuple):
    """What a fit says of T spectra, each (T,)."""

    phase: Array
    """At the middle of the band, rad, wrapped; less that of the reference where there is one."""
    phase_error: Array
    """Standard error by the noise of counts, rad."""
    visibility: Array
    """Amplitude of the fringe over its offset, at the middle of the band."""
    snr: Array
    """Power of the fringe over that of noise, as `octsim.phase.noise.signal_to_noise`, dB."""
    residual: Array
    """Root mean square of what the fit leaves, counts."""


def design_of(model: Model, mean: Array, variance: float) -> Design:
    """Return the fit of a series whose mean spectrum is known.

    Parameters
    ----------
    model : Model
    mean : ndarray, shape (K,)
        Counts without the dark.
    variance : float
        Of the read noise, in counts that are photoelectrons, for weights of shot noise.
    """
    k, options = model.wavenumber, model.options
    envelope = polynomials(k, options, model.source)
    if model.turned is not None:
        turn = np.exp(1j * model.turned)[:, np.newaxis]
        envelope = Envelope(envelope.offset, envelope.amplitude * turn)
    width = np.sqrt(np.gradient(k) / np.gradient(k).mean())
    design = _with_weights(model, envelope, mean, variance, width)
    if options.envelope == "common":
        parameters = design.solver @ mean
        own = slice(design.cosine, design.cosine + design.step)
        beside = slice(design.cosine + design.step, design.cosine + 2 * design.step)
        amplitude = parameters[own] - 1j * parameters[beside]
        shape = envelope.amplitude @ (amplitude / amplitude[0])
        offset = envelope.offset @ parameters[: design.cosine]
        common = Envelope(offset[:, np.newaxis], shape[:, np.newaxis])
        design = _with_weights(model, common, mean, variance, width)
    return design


def _with_weights(
    model: Model, envelope: Envelope, mean: Array, variance: float, width: Array
) -> Design:
    """Return the fit of an envelope, with the weights that it asks for."""
    k, depth = model.wavenumber, np.array([model.depth])
    columns, reference = columns_of(waves_of(k, depth, envelope), envelope)[0], None
    if model.reference_depth is not None:
        wave = oscillation(k, np.array([model.reference_depth]))[0] * envelope.amplitude[:, 0]
        reference = columns.shape[1]
        columns = np.column_stack([columns, wave.real, wave.imag])
    root = width
    for _ in range(_ROUNDS):
        parameters = np.linalg.lstsq(columns * root[:, np.newaxis], mean * root, rcond=None)[0]
        expected = (columns @ parameters)[np.newaxis]
        root = width * WEIGHTS[model.options.weights](expected, mean[np.newaxis], variance)[0]
    solver = np.linalg.pinv(columns * root[:, np.newaxis]) * root
    offsets, amplitudes = envelope.offset.shape[1], envelope.amplitude.shape[1]
    return Design(columns, solver, offsets, amplitudes, reference)


def fitted(design: Design, net: Array, variance: Array) -> Fitted:
    """Return what the fit says of spectra.

    Parameters
    ----------
    design : Design
    net : ndarray, shape (T, K)
        Counts without the dark.
    variance : ndarray, shape (K,)
        Of each sample's counts.
    """
    parameters = net @ design.solver.T
    left = parameters @ design.columns.T
    np.subtract(net, left, out=left)
    covariance = (design.solver * variance) @ design.solver.T
    places = [design.cosine, design.cosine + design.step]
    phase, turn = _phase(parameters, design.cosine, design.cosine + design.step)
    if design.reference is not None:
        places += [design.reference, design.reference + 1]
        still, back = _phase(parameters, design.reference, design.reference + 1)
        phase, turn = wrapped(phase - still), np.concatenate([turn, -back], axis=1)
    own = covariance[np.ix_(places, places)]
    error = np.sqrt(np.maximum(np.einsum("ti,ij,tj->t", turn, own, turn), 0))
    amplitude = np.hypot(parameters[:, places[0]], parameters[:, places[1]])
    waves = slice(design.cosine, design.cosine + 2 * design.step)
    # the power of what oscillates, by the products of the columns alone
    gram = design.columns[:, waves].T @ design.columns[:, waves]
    power = np.einsum("ti,ij,tj->t", parameters[:, waves], gram, parameters[:, waves])
    with np.errstate(divide="ignore", invalid="ignore"):
        snr = 10 * np.log10(power / (2 * variance.mean()))
        visibility = amplitude / np.abs(parameters[:, 0])
    return Fitted(
        phase, error, visibility, snr, np.sqrt(np.einsum("tk,tk->t", left, left) / net.shape[1])
    )


def residuals(design: Design, net: Array) -> Array:
    """Return what the fit leaves of spectra (T, K)."""
    found: Array = net - (net @ design.solver.T) @ design.columns.T
    return found


def left_over_fringe(design: Design, mean: Array) -> float:
    """Return what the fit leaves of a spectrum (K,) over its fringe, root mean squares."""
    waves = slice(design.cosine, design.cosine + 2 * design.step)
    fringe = design.columns[:, waves] @ (design.solver[waves] @ mean)
    left = residuals(design, mean[np.newaxis])[0]
    power = float((fringe**2).mean())
    return float(np.sqrt((left**2).mean() / power)) if power > 0 else np.inf


def still_part(design: Design, mean: Array) -> Array:
    """Return what of a spectrum (K,) is of the reflector that does not move; zeros without one."""
    if design.reference is None:
        return np.zeros_like(mean)
    own = slice(design.reference, design.reference + 2)
    found: Array = design.columns[:, own] @ (design.solver[own] @ mean)
    return found


def unturned(design: Design, turned: Array, mean: Array) -> Array:
    """Return what a spectrum (K,) gains where its fitted fringe is without its dispersion.

    Parameters
    ----------
    design : Design
        Of a model with that dispersion.
    turned : ndarray, shape (K,)
        Its phase, rad.
    mean : ndarray, shape (K,)
    """
    middle = design.cosine + design.step
    cosines, sines = slice(design.cosine, middle), slice(middle, middle + design.step)
    waves = design.columns[:, cosines] + 1j * design.columns[:, sines]
    change = waves * (np.exp(-1j * turned)[:, np.newaxis] - 1)
    found: Array = change.real @ (design.solver[cosines] @ mean)
    found += change.imag @ (design.solver[sines] @ mean)
    return found


def _phase(parameters: Array, cosine: int, sine: int) -> tuple[Array, Array]:
    """Return phases (T,), and how they turn with cosine and sine, (T, 2)."""
    real, imaginary = parameters[:, cosine], parameters[:, sine]
    with np.errstate(divide="ignore", invalid="ignore"):
        square = real**2 + imaginary**2
        turn = np.stack([imaginary / square, -real / square], axis=1)
    # the amplitude is cosine's less i times sine's parameter
    return np.arctan2(-imaginary, real), turn
