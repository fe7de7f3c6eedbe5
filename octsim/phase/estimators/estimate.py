"""What every estimator gives, and the terms in which all are written."""

from collections import Counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.phase.fringe_status import FringeStatus

Array = NDArray[np.float64]


class Phases(NamedTuple):
    """Phase and depth of D spectra.

    The oscillation is cos(2 z (k − k_mid) + phase), with k_mid the middle of the band: the phase
    there hardly depends on the depth, which few oscillations leave uncertain.
    """

    phase: Array
    """Phase at the middle of the band, (D,), rad; wrapped, or not."""
    depth: Array
    """Optical depth z, (D,), µm."""


class Estimate(NamedTuple):
    """Phase and depth of D spectra, and how well they are known.

    Where a spectrum has no fringe all but residual and status are NaN.
    """

    phase: Array
    """Phase at the middle of the band, (D,), rad; wrapped, or not."""
    depth: Array
    """Optical depth z, (D,), µm."""
    residual: Array
    """Root mean square of what a sinusoid leaves of the spectrum, (D,), in its unit."""
    visibility: Array
    """Amplitude of the fringe over its offset, in the middle of the band, (D,)."""
    snr: Array
    """Signal-to-noise ratio, (D,), dB, as `octsim.phase.noise.signal_to_noise`: the noise is what
    the residual has between neighbouring samples, of whatever source."""
    phase_standard_error: Array
    """Standard error of the phase by that noise alone, (D,), rad."""
    depth_standard_error: Array
    """Standard error of the depth by that noise alone, (D,), µm; NaN where the depth is given."""
    status: NDArray[np.int8]
    """`octsim.phase.fringe_status.FringeStatus` of each, (D,)."""

    def __repr__(self) -> str:
        status = np.asarray(self.status)
        words = Counter(FringeStatus(code).name.lower() for code in status.ravel().tolist())
        told = ", ".join(f"{word.replace('_', ' ')} {count}" for word, count in words.most_common())
        parts = [f"{name} {_span(getattr(self, name))}" for name in _TOLD]
        return f"<Estimate of {status.size} spectra ({told}): {', '.join(parts)}>"


_TOLD = ("phase", "depth", "visibility", "snr", "phase_standard_error")


def _span(values: Array) -> str:
    known = np.asarray(values)[np.isfinite(values)]
    if not known.size:
        return "unknown"
    low, high = known.min(), known.max()
    return f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"


def middle(wavenumber: Array) -> float:
    """Wavenumber (1/µm) in the middle of a band (K,)."""
    return float(wavenumber[0] + wavenumber[-1]) / 2


def place(wavenumber: Array) -> Array:
    """Place of each wavenumber (K,) in its band, from −1 to 1."""
    x: Array = (wavenumber - middle(wavenumber)) / ((wavenumber[-1] - wavenumber[0]) / 2)
    return x


def oscillation(wavenumber: Array, depth: Array) -> NDArray[np.complex128]:
    """Oscillations e^{2iz(k − k_mid)} of depths (D,), shape (D, K)."""
    waves: NDArray[np.complex128] = np.exp(
        2j * depth[:, np.newaxis] * (wavenumber - middle(wavenumber))
    )
    return waves


def product(one: NDArray[np.complex128], other: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Multiply complex numbers by real arithmetic, rounded the same wherever in memory they are.

    numpy's own product fuses a multiplication and an addition, or not, depending on the processor
    and on a value's place among its neighbours.
    """
    found = np.empty(np.broadcast_shapes(one.shape, other.shape), complex)
    found.real = one.real * other.real - one.imag * other.imag
    found.imag = one.real * other.imag + one.imag * other.real
    return found


def at_depth(spectra: Array, wavenumber: Array, depth: Array) -> NDArray[np.complex128]:
    r"""Transform spectra (D, K) at a depth each, (D,): :math:`\sum_j I_j e^{-2iz(k_j - k_{mid})}`.

    Each sum is of one spectrum's samples, which stand beside each other; einsum would sum in pieces
    that hang on how many spectra there are.
    """
    waves = oscillation(wavenumber, depth)
    found = np.empty(depth.size, complex)
    found.real = (spectra * waves.real).sum(axis=1)
    found.imag = -(spectra * waves.imag).sum(axis=1)
    return found
