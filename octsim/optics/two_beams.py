"""What two weak reflections a distance d apart would give: the thesis's ideal (its §2.2)."""

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def ideal_spectra(
    n_neuron: float, diameter: "NDArray[np.float64]", wavenumber: "NDArray[np.float64]"
) -> "NDArray[np.float64]":
    """Return the spectra cos(2ndk) for diameters (D,) and wavenumbers (K,), shape (D, K)."""
    import numpy as np  # here, as reading a config needs the step alone

    return np.cos(2 * n_neuron * np.outer(diameter, wavenumber))


def predicted_phase_slope(n_neuron: float, k_min: float, k_max: float) -> float:
    """Return the phase slope n (k_min + k_max) (thesis eq. (2)), in rad/µm = mrad/nm."""
    return n_neuron * (k_min + k_max)


def aliasing_step(n_neuron: float, k_min: float, k_max: float) -> float:
    """Return the largest diameter step (µm) over which the phase moves by no more than π."""
    return math.pi / predicted_phase_slope(n_neuron, k_min, k_max)
