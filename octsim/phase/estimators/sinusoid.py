"""The phase of a least-squares sinusoid, by variable projection."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import OctsimError
from octsim.config.processing import Processing
from octsim.config.processing import Sinusoid as Options
from octsim.phase.estimators.estimate import Array, Estimate, middle, oscillation, place, product

DARKEST = 0.02
"""Least intensity that a weight is made of, over the mean: noise may fit less than none."""
ROUNDS = 4
"""How often weights are made of the last fit; each gains a digit or two."""
STEPS = 10
"""Most Gauss–Newton steps of the depth."""
_REACH = 0.1  # of the depth, that one step may move it
_ONE_SERIES = 0.02  # spread of depths, over their mean, of a series at one diameter
_CHUNK = 256  # spectra at a time: beyond that the columns leave the cache


Weigh = Callable[[Array, Array, float], Array]
"""From fitted and measured spectra and the read noise's variance to square roots of weights."""


class Envelope(NamedTuple):
    """What the linear parameters multiply in every spectrum; the first amplitude is 1 at k_mid."""

    offset: Array
    """Below the oscillation, (K, P)."""
    amplitude: NDArray[np.complex128]
    """Of the oscillation e^{2iz(k − k_mid)}, (K, Q)."""


def sinusoid(intensity: Array, wavenumber: Array, depth: Array, processing: Processing) -> Estimate:
    r"""Fit a sinusoid on polynomials by weighted least squares.

    .. math:: I(k) = \sum_{j \le p} o_j x^j
        + \mathrm{Re}\Big[\sum_{j \le q} c_j x^j e^{2iz(k - k_{mid})}\Big],
        \quad x \in [-1, 1], \quad \phi = \arg c_0

    All but z is linear and eliminated; a fitted z moves by Kaufman's variable projection (Golub and
    Pereyra 2003, doi:10.1088/0266-5611/19/2/201). With the weights of shot noise,
    1/(intensity + read noise²) of the last fit, it is the maximum likelihood of counts.

    Parameters
    ----------
    intensity : ndarray, shape (D, K)
        Spectra.
    wavenumber : ndarray, shape (K,)
        Wavenumbers, 1/µm.
    depth : ndarray, shape (D,)
        Optical depths z, held or to begin with, µm.
    processing : Processing
        Its ``sinusoid`` section, and the read noise.

    Raises
    ------
    OctsimError
        If the envelope is common, and the spectra are not of one depth.
    """
    options, variance = processing.sinusoid, processing.read_noise**2
    envelope = _polynomials(wavenumber, options)
    if options.envelope == "common":
        envelope = _common(intensity, wavenumber, depth, processing)
    begins = range(0, depth.size, _CHUNK)
    parts = [slice(begin, begin + _CHUNK) for begin in begins]
    found = [_fit(intensity[p], wavenumber, depth[p], options, variance, envelope) for p in parts]
    return Estimate(
        np.concatenate([np.angle(amplitude[:, 0]) for amplitude, _, _ in found]),
        np.concatenate([depths for _, _, depths in found]),
    )


def _polynomials(wavenumber: Array, options: Options) -> Envelope:
    """Return the powers of the place in the band, from −1 to 1."""
    x = place(wavenumber)[:, np.newaxis]
    amplitude = x ** np.arange(options.amplitude_degree + 1)
    return Envelope(x ** np.arange(options.offset_degree + 1), amplitude.astype(complex))


def _common(intensity: Array, wavenumber: Array, depth: Array, processing: Processing) -> Envelope:
    """Fit polynomials to the mean of a series, and keep their shape."""
    options, mean_depth = processing.sinusoid, depth.mean(keepdims=True)
    if np.abs(depth - mean_depth).max() > _ONE_SERIES * mean_depth[0]:
        raise OctsimError(
            "processing.sinusoid.envelope: common given, but the spectra's depths are from "
            f"{depth.min():.4g} to {depth.max():.4g} um; that is for a series at one diameter, so "
            "give each"
        )
    powers, mean = _polynomials(wavenumber, options), intensity.mean(axis=0, keepdims=True)
    # the noise of a mean is less, but in the same proportion from sample to sample
    amplitude, offset, _ = _fit(
        mean, wavenumber, mean_depth, options, processing.read_noise**2, powers
    )
    shape = powers.amplitude @ (amplitude[0] / amplitude[0, 0])
    return Envelope((powers.offset @ offset[0])[:, np.newaxis], shape[:, np.newaxis])


def _shot(fitted: Array, intensity: Array, variance: float) -> Array:
    """Return the square roots of the weights of counts that fitted spectra ask for, (D, K)."""
    least = DARKEST * np.abs(intensity).mean(axis=1, keepdims=True) + np.finfo(float).tiny
    roots: Array = 1 / np.sqrt(np.maximum(fitted, least) + variance)
    return roots


def _equal(fitted: Array, _: Array, __: float) -> Array:
    """Return the same weight to every sample."""
    return np.ones_like(fitted)


_WEIGHTS: Mapping[str, Weigh] = {"shot": _shot, "equal": _equal}


def _fit(
    intensity: Array,
    wavenumber: Array,
    depth: Array,
    options: Options,
    variance: float,
    envelope: Envelope,
) -> tuple[NDArray[np.complex128], Array, Array]:
    """Fit amplitudes (D, Q), offsets (D, P) and, if that is asked for, depths (D,)."""
    fit = _FITS[options.depth]
    return fit(intensity, wavenumber, depth, envelope, _WEIGHTS[options.weights], variance)


def _held(
    intensity: Array,
    wavenumber: Array,
    depth: Array,
    envelope: Envelope,
    weigh: Weigh,
    variance: float,
) -> tuple[NDArray[np.complex128], Array, Array]:
    """Fit at held depths: complex amplitudes, whose slope makes up for a depth that is off."""
    columns = _columns(_waves(wavenumber, depth, envelope), envelope)
    found = _solve(columns, intensity, np.ones_like(intensity))
    root = np.ones_like(intensity)
    for _ in range(ROUNDS):
        last, root = root, weigh(_sum(columns, found), intensity, variance)
        if np.array_equal(root, last):
            break
        found = _solve(columns, intensity, root)
    offsets, cosines = envelope.offset.shape[1], envelope.amplitude.shape[1]
    cos, sin = found[:, offsets : offsets + cosines], found[:, offsets + cosines :]
    return cos - 1j * sin, found[:, :offsets], depth


def _fitted(
    intensity: Array,
    wavenumber: Array,
    depth: Array,
    envelope: Envelope,
    weigh: Weigh,
    variance: float,
) -> tuple[NDArray[np.complex128], Array, Array]:
    """Fit depths too: amplitudes of one phase, as a slope of the phase is the depth's.

    The step of a depth is the part of one more column, the derivative to it, in a fit of all: all
    else is projected out.
    """
    x = 2 * (wavenumber - middle(wavenumber))
    offsets = envelope.offset.shape[1]
    root = np.ones_like(intensity)
    amplitude, offset, _ = _held(intensity, wavenumber, depth, envelope, weigh, variance)
    for _ in range(STEPS):
        turn = amplitude[:, :1] / np.abs(amplitude[:, :1])
        waves = _waves(wavenumber, depth, envelope)
        cos, sin = waves.real, waves.imag  # by their parts, as in `product`
        along = turn.real[:, np.newaxis] * cos[..., 1:] - turn.imag[:, np.newaxis] * sin[..., 1:]
        # amplitudes along the first one's phase
        sloped = turn * product(amplitude, turn.conj()).real
        moved = np.zeros_like(intensity)
        for q in range(sloped.shape[1]):
            real, imaginary = sloped.real[:, q, np.newaxis], sloped.imag[:, q, np.newaxis]
            moved -= x * (cos[..., q] * imaginary + sin[..., q] * real)
        columns = np.concatenate(
            [_columns(waves[..., :1], envelope), along, moved[..., np.newaxis]], axis=2
        )
        found = _solve(columns, intensity, root)
        first = found[:, offsets, np.newaxis] - 1j * found[:, offsets + 1, np.newaxis]
        amplitude = np.concatenate([first, turn * found[:, offsets + 2 : -1]], axis=1)
        offset, step = found[:, :offsets], found[:, -1]
        root = weigh(_sum(columns, found), intensity, variance)
        depth = depth + np.clip(step, -_REACH * depth, _REACH * depth)
    return amplitude, offset, depth


_FITS = {"held": _held, "fitted": _fitted}


def _waves(wavenumber: Array, depth: Array, envelope: Envelope) -> NDArray[np.complex128]:
    """Return the oscillations with their amplitudes' shapes, (D, K, Q)."""
    return product(oscillation(wavenumber, depth)[..., np.newaxis], envelope.amplitude)


def _columns(waves: NDArray[np.complex128], envelope: Envelope) -> Array:
    """Return what the real linear parameters multiply, (D, K, P + 2Q)."""
    offset = np.broadcast_to(envelope.offset, (waves.shape[0], *envelope.offset.shape))
    return np.concatenate([offset, waves.real, waves.imag], axis=2)


def _sum(columns: Array, found: Array) -> Array:
    """Return the spectra (D, K) that parameters (D, N) of the columns stand for."""
    fitted: Array = (columns @ found[..., np.newaxis])[..., 0]
    return fitted


def _solve(columns: Array, intensity: Array, root: Array) -> Array:
    """Solve weighted least squares for spectra (D, K) and columns (D, K, N): (D, N)."""
    orthogonal, triangle = np.linalg.qr(columns * root[..., np.newaxis])
    projected = np.swapaxes(orthogonal, 1, 2) @ (intensity * root)[..., np.newaxis]
    found: Array = np.linalg.solve(triangle, projected)[..., 0]
    return found
