"""The largest field over the band of the paths of a point, each taken for one ray."""

import math

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from octsim.schemes.paths.kept_rays import WeightedRays

_PEAK_SAMPLES = 32


@register_jitable
def mean_of(rays: WeightedRays, first: int, end: int) -> tuple[float, float]:
    """Return the sum of the amplitudes of some rays, and their mean optical path."""
    total, reach = 0.0, 0.0
    for i in range(first, end):
        total += rays.amplitude[i]
        reach += rays.amplitude[i] * rays.optical_path_length[i]
    return total, (reach / total if total != 0 else 0.0)


@register_jitable
def peak(
    size: NDArray[np.float64], reach: NDArray[np.float64], k_mid: float, k_max: float
) -> float:
    """Return the largest magnitude over the band of a sum of paths, each as one ray."""
    largest = 0.0
    for i in range(_PEAK_SAMPLES):
        k = k_mid + (k_max - k_mid) * (2 * i / (_PEAK_SAMPLES - 1) - 1)
        real, imaginary = 0.0, 0.0
        for p in range(size.size):
            real += size[p] * math.cos(k * reach[p])
            imaginary += size[p] * math.sin(k * reach[p])
        largest = max(largest, math.hypot(real, imaginary))
    return largest
