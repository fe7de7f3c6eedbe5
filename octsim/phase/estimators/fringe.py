"""The wavenumber of one extremum of the fringe, which says the depth without a phase."""

import numpy as np
from numpy.polynomial import Polynomial

from octsim.config.processing import Processing
from octsim.phase.estimators.estimate import Array, Phases, at_depth, middle
from octsim.phase.transform import prepared

_DEGREE = 4
_REACH = 0.3  # of a period, to each side of the extremum, that the polynomial is fitted over
_CENTRINGS = 2  # the second around what the first found
_REAL = 1e-6


def fringe(intensity: Array, wavenumber: Array, depth: Array, processing: Processing) -> Phases:
    r"""Locate the extremum nearest to the middle of the band; its order gives the depth.

    .. math:: 2 z k_e + \pi = m \pi, \quad z = \frac{(m - 1) \pi}{2 k_e}, \quad \phi = 2 z k_{mid}

    The two reflections have opposite signs, hence the π. The order m is the one nearest to the
    expected depth: even at a maximum, odd at a minimum. The extremum is that of a polynomial fitted
    by least squares around it (as of fringes of equal chromatic order: Israelachvili 1973,
    doi:10.1016/0021-9797(73)90218-X).

    Parameters
    ----------
    intensity : ndarray, shape (D, K)
        Spectra.
    wavenumber : ndarray, shape (K,)
        Evenly spaced wavenumbers, 1/µm.
    depth : ndarray, shape (D,)
        Optical depths that are expected, to within a quarter of a wavelength, µm.
    processing : Processing
        Its centre and window serve to tell which extremum is nearest.
    """
    k_mid = middle(wavenumber)
    phase = np.angle(at_depth(prepared(intensity, processing), wavenumber, depth))
    # cos(2z (k − k_mid) + phase) is extreme where that is a whole number of half turns
    half_turn = np.round(phase / np.pi)
    rough = k_mid + (half_turn * np.pi - phase) / (2 * depth)
    at = np.array(
        [
            _extremum(wavenumber, spectrum, start, reach)
            for spectrum, start, reach in zip(intensity, rough, _REACH * np.pi / depth, strict=True)
        ]
    )
    # a maximum, at an even number of half turns, has an odd order m − 1
    parity = (half_turn + 1) % 2
    order = parity + 2 * np.round((2 * depth * at / np.pi - parity) / 2)
    found = order * np.pi / (2 * at)
    return Phases(2 * found * k_mid + np.pi, found)


def _extremum(wavenumber: Array, spectrum: Array, start: float, reach: float) -> float:
    """Find where a polynomial that is fitted around `start` is extreme, 1/µm; NaN if nowhere."""
    at = start
    for _ in range(_CENTRINGS):
        used = np.abs(wavenumber - at) < reach
        if used.sum() <= _DEGREE:
            return np.nan
        fitted = Polynomial.fit(wavenumber[used], spectrum[used], _DEGREE)
        roots = fitted.deriv().roots()
        real = roots.real[np.abs(roots.imag) < _REAL * reach]
        if real.size == 0:
            return np.nan
        at = float(real[np.abs(real - at).argmin()])
    return at if abs(at - start) < reach else np.nan
