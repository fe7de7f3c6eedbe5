"""What two weak reflections a distance d apart would give: the thesis's ideal (its §2.2)."""

import math
from typing import TYPE_CHECKING

from octsim.optics.materials import Material

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def indices(material: Material, wavenumber: "NDArray[np.float64]") -> "float | NDArray[np.float64]":
    """Return n at wavenumbers (K,), 1/µm in vacuum: one number where it is the same at all."""
    import numpy as np  # here, as reading a config needs the step alone

    if not material.dispersive:
        return material.index(float(wavenumber[0])).real
    return np.array([material.index(k).real for k in wavenumber.tolist()])


def ideal_spectra(
    neuron: Material | float, diameter: "NDArray[np.float64]", wavenumber: "NDArray[np.float64]"
) -> "NDArray[np.float64]":
    """Return the spectra cos(2ndk), each k with its n, shape (D, K).

    Parameters
    ----------
    neuron : Material or float
        What is between the reflections, or its index at all wavenumbers.
    diameter : ndarray, shape (D,)
        µm.
    wavenumber : ndarray, shape (K,)
        1/µm in vacuum.
    """
    import numpy as np

    n = neuron if isinstance(neuron, float | int) else indices(neuron, wavenumber)
    return np.cos(2 * n * np.outer(diameter, wavenumber))


def predicted_phase_slope(neuron: Material | float, k_min: float, k_max: float) -> float:
    """Return the phase slope n(k_min) k_min + n(k_max) k_max, in rad/µm = mrad/nm.

    Of an index that is the same at all wavenumbers it is the thesis's eq. (2), n (k_min + k_max).

    Parameters
    ----------
    neuron : Material or float
        What is between the reflections, or its index at all wavenumbers.
    k_min, k_max : float
        Ends of the band, 1/µm in vacuum.
    """
    if isinstance(neuron, float | int):
        return neuron * (k_min + k_max)
    lowest, highest = (neuron.index(float(k)).real for k in (k_min, k_max))
    if not neuron.dispersive:
        return lowest * (k_min + k_max)
    return lowest * k_min + highest * k_max


def aliasing_step(neuron: Material | float, k_min: float, k_max: float) -> float:
    """Return the largest diameter step (µm) over which the phase moves by no more than π.

    See `predicted_phase_slope`, whose parameters it takes.
    """
    return math.pi / predicted_phase_slope(neuron, k_min, k_max)
