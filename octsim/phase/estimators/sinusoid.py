"""The phase of a least-squares sinusoid, by variable projection."""

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import OctsimError
from octsim.config.processing import Processing
from octsim.config.processing import Sinusoid as Options
from octsim.phase.estimators.estimate import Array, Phases, middle, oscillation, place, product

DARKEST = 0.02
"""Least intensity that a weight is made of, over the mean: noise may fit less than none."""
ROUNDS = 4
"""How often weights are made of the last fit; each gains a digit or two."""
STEPS = 10
"""Most Gauss–Newton steps of the depth."""
_REACH = 0.1  # of the depth, that one step may move it
_ONE_SERIES = 0.02  # spread of depths, over their mean, of a series at one diameter
CHUNK = 256
"""Spectra at a time: beyond that the columns leave the cache."""


Weigh = Callable[[Array, Array, float], Array]
"""From fitted and measured spectra and the read noise's variance to square roots of weights."""


class Envelope(NamedTuple):
    """What the linear parameters multiply in every spectrum; the first amplitude is 1 at k_mid."""

    offset: Array
    """Below the oscillation, (K, P)."""
    amplitude: NDArray[np.complex128]
    """Of the oscillation e^{2iz(k − k_mid)}, (K, Q)."""


class Fit(NamedTuple):
    """Sinusoids fitted to D spectra, with P linear parameters of the offset and N in all."""

    amplitude: NDArray[np.complex128]
    """Of the oscillation and its slopes, (D, Q)."""
    offset: Array
    """Below it, (D, P)."""
    depth: Array
    """Optical depths z, (D,), µm."""
    below: Array
    """The fitted offset over the band, (D, K)."""
    fitted: Array
    """The fitted spectra, (D, K)."""
    root: Array
    """Square roots of the weights, (D, K)."""
    triangle: Array
    """R of the weighted columns, (D, N, N): the covariance of the parameters, for a noise of 1 in
    the weighted residual, is R⁻¹ R⁻ᵀ (Golub and Van Loan 2013, §5.3)."""
    columns: tuple[int, int, int]
    """Places of the first cosine, its sine and the depth among the parameters; −1 if it is held."""

    @property
    def phase(self) -> Array:
        """Phases, (D,), rad."""
        return np.angle(self.amplitude[:, 0])

    def unit_errors(self) -> tuple[Array, Array, Array]:
        """Return standard errors of amplitude, phase (rad) and depth (µm), each (D,).

        They are those of a noise of 1 in the weighted residual. A depth that is held has NaN.
        """
        cosine, sine, depth = self.columns
        # the amplitude is cosine's less i times sine's parameter
        turn = self.amplitude[:, 0] / np.abs(self.amplitude[:, 0])
        along, across = np.zeros((2, *self.triangle.shape[:2]))
        along[:, cosine], along[:, sine] = turn.real, -turn.imag
        across[:, cosine], across[:, sine] = -turn.imag, -turn.real
        amplitude = self._spread(along)
        phase = self._spread(across) / np.abs(self.amplitude[:, 0])
        if depth < 0:
            return amplitude, phase, np.full_like(phase, np.nan)
        moved = np.zeros_like(along)
        moved[:, depth] = 1
        return amplitude, phase, self._spread(moved)

    def _spread(self, direction: Array) -> Array:
        """Return the standard errors (D,) of sums of the parameters, (D, N)."""
        transposed = np.swapaxes(self.triangle, 1, 2)
        solved = np.linalg.solve(transposed, direction[..., np.newaxis])[..., 0]
        return np.asarray(np.sqrt((solved**2).sum(axis=1)))


def sinusoid(
    intensity: Array, wavenumber: Array, depth: Array, processing: Processing,
    source: Array | None = None,
) -> Phases:  # fmt: skip
    """Fit a sinusoid on polynomials, and give its phase and depth; see `fit_sinusoid`."""
    fits = fit_sinusoid(intensity, wavenumber, depth, processing, source)
    phases, depths = zip(*((fit.phase, fit.depth) for _, fit in fits), strict=True)
    return Phases(np.concatenate(phases), np.concatenate(depths))


def fit_sinusoid(
    intensity: Array, wavenumber: Array, depth: Array, processing: Processing,
    source: Array | None = None,
) -> Iterator[tuple[slice, Fit]]:  # fmt: skip
    r"""Fit a sinusoid on polynomials by weighted least squares.

    .. math:: I(k) = S(k) \Big( \sum_{j \le p} o_j x^j
        + \mathrm{Re}\Big[\sum_{j \le q} c_j x^j e^{2iz(k - k_{mid})}\Big] \Big),
        \quad x \in [-1, 1], \quad \phi = \arg c_0

    The source S is known, or flat: it multiplies the model, and no sample is divided by it.
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
    source : ndarray, shape (K,), optional
        The source's power; None of a flat one.

    Yields
    ------
    part : slice
        Which spectra: up to `CHUNK` at a time, in their order.
    fit : Fit
        Theirs.

    Raises
    ------
    OctsimError
        If the envelope is common, and the spectra are not of one depth.
    """
    options, variance = processing.sinusoid, processing.read_noise**2
    envelope = polynomials(wavenumber, options, source)
    if options.envelope == "common":
        envelope = _common(intensity, wavenumber, depth, processing, envelope)
    for begin in range(0, depth.size, CHUNK):
        part = slice(begin, begin + CHUNK)
        yield part, _fit(intensity[part], wavenumber, depth[part], options, variance, envelope)


def polynomials(wavenumber: Array, options: Options, source: Array | None) -> Envelope:
    """Return the powers of the place in the band, from −1 to 1, times the source."""
    x = place(wavenumber)[:, np.newaxis]
    amplitude = x ** np.arange(options.amplitude_degree + 1)
    offset = x ** np.arange(options.offset_degree + 1)
    power = 1.0 if source is None else source[:, np.newaxis]
    return Envelope(offset * power, (amplitude * power).astype(complex))


def _common(
    intensity: Array, wavenumber: Array, depth: Array, processing: Processing, powers: Envelope
) -> Envelope:
    """Fit polynomials to the mean of a series, and keep their shape."""
    options, mean_depth = processing.sinusoid, depth.mean(keepdims=True)
    if np.abs(depth - mean_depth).max() > _ONE_SERIES * mean_depth[0]:
        raise OctsimError(
            "processing.sinusoid.envelope: common given, but the spectra's depths are from "
            f"{depth.min():.4g} to {depth.max():.4g} um; that is for a series at one diameter, so "
            "give each"
        )
    mean = intensity.mean(axis=0, keepdims=True)
    # the noise of a mean is less, but in the same proportion from sample to sample
    one = _fit(mean, wavenumber, mean_depth, options, processing.read_noise**2, powers)
    shape = powers.amplitude @ (one.amplitude[0] / one.amplitude[0, 0])
    return Envelope((powers.offset @ one.offset[0])[:, np.newaxis], shape[:, np.newaxis])


def _shot(fitted: Array, intensity: Array, variance: float) -> Array:
    """Return the square roots of the weights of counts that fitted spectra ask for, (D, K)."""
    least = DARKEST * np.abs(intensity).mean(axis=1, keepdims=True) + np.finfo(float).tiny
    roots: Array = 1 / np.sqrt(np.maximum(fitted, least) + variance)
    return roots


def _equal(fitted: Array, _: Array, __: float) -> Array:
    """Return the same weight to every sample."""
    return np.ones_like(fitted)


WEIGHTS: Mapping[str, Weigh] = {"shot": _shot, "equal": _equal}


def _fit(
    intensity: Array,
    wavenumber: Array,
    depth: Array,
    options: Options,
    variance: float,
    envelope: Envelope,
) -> Fit:
    """Fit amplitudes, offsets and, if that is asked for, depths."""
    fit = _FITS[options.depth]
    return fit(intensity, wavenumber, depth, envelope, WEIGHTS[options.weights], variance)


def _held(
    intensity: Array,
    wavenumber: Array,
    depth: Array,
    envelope: Envelope,
    weigh: Weigh,
    variance: float,
) -> Fit:
    """Fit at held depths: complex amplitudes, whose slope makes up for a depth that is off."""
    columns = columns_of(waves_of(wavenumber, depth, envelope), envelope)
    root = np.ones_like(intensity)
    found, triangle = _solve(columns, intensity, root)
    for _ in range(ROUNDS):
        last, root = root, weigh(_sum(columns, found), intensity, variance)
        if np.array_equal(root, last):
            break
        found, triangle = _solve(columns, intensity, root)
    offsets, cosines = envelope.offset.shape[1], envelope.amplitude.shape[1]
    cos, sin = found[:, offsets : offsets + cosines], found[:, offsets + cosines :]
    return Fit(cos - 1j * sin, found[:, :offsets], depth, *_parts(columns, found, offsets), root,
               triangle, (offsets, offsets + cosines, -1))  # fmt: skip


def _fitted(
    intensity: Array,
    wavenumber: Array,
    depth: Array,
    envelope: Envelope,
    weigh: Weigh,
    variance: float,
) -> Fit:
    """Fit depths too: amplitudes of one phase, as a slope of the phase is the depth's.

    The step of a depth is the part of one more column, the derivative to it, in a fit of all: all
    else is projected out.
    """
    x = 2 * (wavenumber - middle(wavenumber))
    offsets = envelope.offset.shape[1]
    weights = np.ones_like(intensity)
    amplitude = _held(intensity, wavenumber, depth, envelope, weigh, variance).amplitude
    for _ in range(STEPS):
        root = weights
        turn = amplitude[:, :1] / np.abs(amplitude[:, :1])
        waves = waves_of(wavenumber, depth, envelope)
        cos, sin = waves.real, waves.imag  # by their parts, as in `product`
        along = turn.real[:, np.newaxis] * cos[..., 1:] - turn.imag[:, np.newaxis] * sin[..., 1:]
        # amplitudes along the first one's phase
        sloped = turn * product(amplitude, turn.conj()).real
        moved = np.zeros_like(intensity)
        for q in range(sloped.shape[1]):
            real, imaginary = sloped.real[:, q, np.newaxis], sloped.imag[:, q, np.newaxis]
            moved -= x * (cos[..., q] * imaginary + sin[..., q] * real)
        columns = np.concatenate(
            [columns_of(waves[..., :1], envelope), along, moved[..., np.newaxis]], axis=2
        )
        found, triangle = _solve(columns, intensity, root)
        first = found[:, offsets, np.newaxis] - 1j * found[:, offsets + 1, np.newaxis]
        amplitude = np.concatenate([first, turn * found[:, offsets + 2 : -1]], axis=1)
        step = found[:, -1]
        weights = weigh(_sum(columns, found), intensity, variance)
        depth = depth + np.clip(step, -_REACH * depth, _REACH * depth)
    places = offsets, offsets + 1, columns.shape[2] - 1
    return Fit(amplitude, found[:, :offsets], depth, *_parts(columns, found, offsets), root,
               triangle, places)  # fmt: skip


_FITS = {"held": _held, "fitted": _fitted}


def waves_of(wavenumber: Array, depth: Array, envelope: Envelope) -> NDArray[np.complex128]:
    """Return the oscillations with their amplitudes' shapes, (D, K, Q)."""
    return product(oscillation(wavenumber, depth)[..., np.newaxis], envelope.amplitude)


def columns_of(waves: NDArray[np.complex128], envelope: Envelope) -> Array:
    """Return what the real linear parameters multiply, (D, K, P + 2Q)."""
    offset = np.broadcast_to(envelope.offset, (waves.shape[0], *envelope.offset.shape))
    return np.concatenate([offset, waves.real, waves.imag], axis=2)


def _sum(columns: Array, found: Array) -> Array:
    """Return the spectra (D, K) that parameters (D, N) of the columns stand for."""
    fitted: Array = (columns @ found[..., np.newaxis])[..., 0]
    return fitted


def _parts(columns: Array, found: Array, offsets: int) -> tuple[Array, Array]:
    """Return the offsets (D, K) and the whole spectra (D, K) that parameters stand for."""
    return _sum(columns[..., :offsets], found[:, :offsets]), _sum(columns, found)


def _solve(columns: Array, intensity: Array, root: Array) -> tuple[Array, Array]:
    """Solve weighted least squares for spectra (D, K) and columns (D, K, N): (D, N), and R."""
    orthogonal, triangle = np.linalg.qr(columns * root[..., np.newaxis])
    projected = np.swapaxes(orthogonal, 1, 2) @ (intensity * root)[..., np.newaxis]
    return np.linalg.solve(triangle, projected)[..., 0], triangle
