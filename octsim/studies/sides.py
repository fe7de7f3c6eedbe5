"""The neuron's two sides, each by itself: the light from it, and how its phase moves."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from octsim.optics.scene import NEURON_ON_GLASS
from octsim.phase.derivatives import wrapped
from octsim.schemes.field_sum import field_at
from octsim.schemes.light import Light
from octsim.tracing.light_paths import path_name

GLASS = "PR"
"""The light path off the glass, which meets no neuron."""
SIDES: Mapping[str, str] = {"near": "PT CR PT", "far": "PT CT CR CT PT"}
"""The light path that meets a side of the neuron and nothing else on its way back."""


def rays_on(light: Light, chosen: Callable[[str], bool]) -> NDArray[np.bool_]:
    """Return which rays (R,) are on light paths that are chosen by name."""
    codes, path = np.unique(light.path, return_inverse=True)
    kept = np.array([chosen(path_name(code, NEURON_ON_GLASS)) for code in codes.tolist()], bool)
    return kept[path]


def field_of(light: Light, rays: NDArray[np.bool_], wavenumber: float) -> complex:
    """Return the sum of some of the rays, (R,), at one wavenumber (1/µm); 0 if there are none."""
    return field_at(light.amplitude[rays], light.optical_path_length[rays], wavenumber)


def path_field(light: Light, name: str, wavenumber: float) -> complex:
    """Return the field of one light path at one wavenumber, 1/µm; 0 without any of its rays."""
    return field_of(light, rays_on(light, name.__eq__), wavenumber)


def side_slopes(
    trace_at: Callable[[float, float], Light],
    diameter: float,
    focus: float,
    wavenumber: float,
    step: float,
) -> dict[str, float]:
    """Return how the phase of each side's light moves with the diameter, the focus held.

    Parameters
    ----------
    trace_at : callable
        From diameter and focus, µm, to light.
    diameter, focus, step : float
        µm; the diameter moves by a step to each side.
    wavenumber : float
        1/µm.

    Returns
    -------
    dict
        Of ``near`` and ``far``, mrad/nm; NaN without light.
    """
    before, after = trace_at(diameter - step, focus), trace_at(diameter + step, focus)

    def slope(name: str) -> float:
        fields = np.array([path_field(light, name, wavenumber) for light in (after, before)])
        if not fields.all():
            return np.nan
        ends: NDArray[np.float64] = np.angle(fields)
        return float(wrapped(ends[0] - ends[1]) / (2 * step))

    return {side: slope(name) for side, name in SIDES.items()}
