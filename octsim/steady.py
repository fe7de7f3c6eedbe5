"""Phases of one neuron's spectra, by estimators whose settings are held while it changes."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from octsim.config import Config
from octsim.phase import fourier_components

Array = NDArray[np.float64]
PhaseOf = Callable[[Array, Array, float], Array]
"""From spectra (T, K) of one neuron, wavenumbers (K,), 1/µm, and its optical depth nd, µm, as it is
believed to be, to their phases (T,), rad. An estimator may use the depth or not; what it takes from
the spectra themselves, such as a component, it takes from all of them together."""


def sinusoid_phase(spectra: Array, wavenumber: Array, depth: float) -> Array:
    r"""Fit a sinusoid of a held frequency by least squares; its phase at the middle of the band.

    .. math::
        I(k) \approx a_0 + a_1 u
            + \mathrm{Re}\left[(c_0 + c_1 u) e^{2 i n d (k - k_m)}\right],
        \quad \varphi = \arg c_0

    with real :math:`a`, complex :math:`c`, :math:`k_m` the middle of the band and
    :math:`u = k - k_m`. The linear terms take up what a source, or reflections that change over the
    band, do to the offset and the amplitude. It is linear in all that it fits: one solution serves
    all spectra.

    Parameters
    ----------
    spectra : ndarray, shape (T, K)
    wavenumber : ndarray, shape (K,)
        1/µm; not necessarily evenly spaced.
    depth : float
        Optical depth nd, µm.

    Returns
    -------
    ndarray, shape (T,)
        Phases in (−π, π]; that of cos(2ndk) grows by n (k_min + k_max) for each µm of diameter.
    """
    middle = (wavenumber[0] + wavenumber[-1]) / 2
    u = (wavenumber - middle) / (wavenumber[-1] - middle)
    cos, sin = (turn(2 * depth * (wavenumber - middle)) for turn in (np.cos, np.sin))
    terms = np.stack((cos, -sin, u * cos, u * sin, np.ones_like(u), u), axis=1)
    real, imaginary = np.linalg.pinv(terms)[:2] @ spectra.T
    phases: Array = np.arctan2(imaginary, real)
    return phases


def fourier_phase(config: Config) -> PhaseOf:
    """Make the thesis's estimator: the phase of the component that is strongest in all together."""

    def phase_of(spectra: Array, wavenumber: Array, depth: float) -> Array:  # noqa: ARG001
        components = fourier_components(spectra, config.processing)
        strongest = 1 + int(np.abs(components[:, 1:]).sum(axis=0).argmax())
        return np.angle(components[:, strongest])

    return phase_of


ESTIMATORS: Mapping[str, Callable[[Config], PhaseOf]] = {
    "sinusoid": lambda _: sinusoid_phase,
    "fft": fourier_phase,
}
"""What makes each estimator for a config, by the name of ``calibration.estimator``."""


def phase_change(after: Array, before: Array) -> Array:
    """Give how far phases have moved, rad, whatever turns are in them: in (−π, π]."""
    moved: Array = np.angle(np.exp(1j * (after - before)))
    return moved
