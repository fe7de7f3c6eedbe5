"""Dispersion that the sample's light has and the reference's has not: a phase over the band."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from octsim.base.errors import ConfigError
from octsim.phase.estimators.estimate import place

Array = NDArray[np.float64]
FEWEST_FRINGES = 6.0
"""Oscillations over the band, from which a peak tells how sharp it is."""
_WIDEST = 60.0  # rad, of a2 that is looked for
_FINER = 8  # zeros that are appended, over the samples


def phase_over(wavenumber: Array, a2: float, a3: float) -> Array:
    """Return a2 x² + a3 x³ over the place x in the band, from −1 to 1, (K,), rad."""
    return _phase(place(wavenumber), (a2, a3))


def fitted(fringe: Array, wavenumber: Array) -> tuple[float, float]:
    """Return the a2 and a3 that make the highest peak of a fringe highest: the sharpest.

    Parameters
    ----------
    fringe : ndarray, shape (K,)
        A spectrum without the light that does not oscillate.
    wavenumber : ndarray, shape (K,)
        Evenly spaced, 1/µm.

    Raises
    ------
    ConfigError
        If the fringe has too few oscillations to tell.
    """
    x = place(wavenumber)
    steps = np.linspace(-_WIDEST, _WIDEST, 241)
    heights = [_peak(fringe, x, (a2, 0.0)) for a2 in steps.tolist()]
    best = float(steps[int(np.argmax(heights))])
    at = minimize(
        lambda of: -_peak(fringe, x, of), (best, 0.0), method="Nelder-Mead",
        options={"xatol": 1e-4, "fatol": 1e-10 * max(heights), "initial_simplex": [
            (best, 0.0), (best + 0.5, 0.0), (best, 0.5)]},
    )  # fmt: skip
    turned = np.abs(np.fft.fft(fringe * np.exp(-1j * _phase(x, at.x)), _FINER * fringe.size))
    half = turned[: turned.size // 2]
    oscillations = int(half.argmax()) / _FINER
    if oscillations < FEWEST_FRINGES:
        raise ConfigError(
            f"measured.dispersion: fit given, but the fringe has {oscillations:.3g} oscillations "
            f"over the band, and {FEWEST_FRINGES:g} are needed to tell dispersion from a depth; "
            "give a2 and a3 of the optics"
        )
    return float(at.x[0]), float(at.x[1])


def _phase(x: Array, of: "tuple[float, float] | Array") -> Array:
    found: Array = of[0] * x**2 + of[1] * x**3
    return found


def _peak(fringe: Array, x: Array, of: "tuple[float, float] | Array") -> float:
    turned = np.fft.fft(fringe * np.exp(-1j * _phase(x, of)), _FINER * fringe.size)
    return float(np.abs(turned[: turned.size // 2]).max())
