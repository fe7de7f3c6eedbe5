"""The phase that light through the neuron gathers, from its paths: what estimators should find."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from octsim.phase.slopes import slope_of
from octsim.schemes.light import Light
from octsim.studies.sides import field_of, rays_on

Array = NDArray[np.float64]


def goes_through(light: Light) -> NDArray[np.bool_]:
    """Return which rays (D,) have been inside the cylinder."""
    return rays_on(light, lambda name: "CT" in name)


def path_phase(light: Light, wavenumber: float) -> float:
    r"""Return the phase between the light that has been inside the cylinder and the rest, rad.

    .. math:: \phi = \arg \sum_{\mathrm{inside}} E_j e^{ik\Lambda_j}
        - \arg \sum_{\mathrm{not}} E_j e^{ik\Lambda_j}
    """
    inside = goes_through(light)
    within, outside = (field_of(light, rays, wavenumber) for rays in (inside, ~inside))
    return float(np.angle(within * np.conj(outside)))


def mean_path_difference(light: Light) -> float:
    """Return how much longer the mean path inside the cylinder is than the others', µm.

    Means are weighted with the amplitudes' sizes.
    """
    inside, size = goes_through(light), np.abs(light.amplitude)
    paths = [
        float(np.average(light.optical_path_length[part], weights=size[part]))
        for part in (inside, ~inside)
    ]
    return paths[0] - paths[1]


def path_slopes(lights: Sequence[Light], diameter: Array, wavenumber: float) -> tuple[Array, Array]:
    """Return the slopes over the diameter (D,), mrad/nm, of the path phase and of k · mean path.

    The first is what a perfect estimate of the phase at that wavenumber has. The second is
    geometry alone: it differs as rays of a focused beam, of unlike paths, add to a field whose
    phase is not that of the mean path.
    """
    phase = np.array([path_phase(light, wavenumber) for light in lights])
    mean = np.array([mean_path_difference(light) for light in lights])
    return slope_of(diameter, phase), np.gradient(wavenumber * mean, diameter)
