"""Phases by the Fourier transform: on its components, and at any one depth."""

import numpy as np

from octsim.config.processing import Processing
from octsim.phase.estimators.estimate import Array, Phases, at_depth, middle
from octsim.phase.transform import fourier_components, optical_depths, prepared

_FINER = 32
"""How many times finer zeros make the components, where the highest peak is looked for."""


def fft(intensity: Array, wavenumber: Array, _: Array, processing: Processing) -> Phases:
    r"""Take the phase of the strongest component (thesis §5), brought to the middle of the band.

    .. math:: \phi = \arg \sum_j w_j (I_j - c) e^{-2\pi i j m / K} + 2 z_m (k_{mid} - k_{min}),
        \quad z_m = \frac{\pi m}{K \Delta k}

    Parameters are those of all estimators; the depth is that of the component.
    """
    components = fourier_components(intensity, processing)
    strongest = 1 + np.abs(components[:, 1:]).argmax(axis=1)
    depth = optical_depths(wavenumber)[strongest]
    value = np.take_along_axis(components, strongest[:, np.newaxis], axis=1)[:, 0]
    return Phases(np.angle(value) + 2 * depth * (middle(wavenumber) - wavenumber[0]), depth)


def zero_padded(
    intensity: Array, wavenumber: Array, depth: Array, processing: Processing
) -> Phases:
    r"""Take the phase of the Fourier transform at a given depth.

    .. math:: \phi = \arg \sum_j w_j (I_j - c) e^{-2iz(k_j - k_{mid})}

    which is a component of the transform with so many zeros appended that one falls on the depth
    (the zero-padded transform of optical coherence tomography).

    Parameters
    ----------
    intensity : ndarray, shape (D, K)
        Spectra.
    wavenumber : ndarray, shape (K,)
        Evenly spaced wavenumbers, 1/µm.
    depth : ndarray, shape (D,)
        Optical depths, µm.
    processing : Processing
        Its centre and window.
    """
    value = at_depth(prepared(intensity, processing), wavenumber, depth)
    return Phases(np.angle(value), depth)


def peak_depths(intensity: Array, wavenumber: Array, processing: Processing) -> Array:
    """Find the depth of the highest peak of the zero-padded transform of spectra (D, K), µm.

    Depths below that of three quarters of an oscillation over the band are left out: what an
    offset that is not flat leaves stands there.
    """
    num = _FINER * wavenumber.size
    spectra = prepared(intensity, processing)
    magnitude = np.abs(np.fft.rfft(spectra, num, axis=1))
    depths = optical_depths(wavenumber, num)
    lowest = int(np.ceil(0.75 * _FINER))
    at = lowest + magnitude[:, lowest:-1].argmax(axis=1)
    rows = np.arange(at.size)
    before, here, after = (magnitude[rows, at + step] for step in (-1, 0, 1))
    bend = before - 2 * here + after
    # a parabola through the three: finer than the zeros make it
    shift = np.where(bend < 0, 0.5 * (before - after) / np.where(bend < 0, bend, 1), 0.0)
    found: Array = depths[at] + np.clip(shift, -0.5, 0.5) * depths[1]
    return found
