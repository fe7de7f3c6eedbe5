"""The neuron's two sides, each by itself: how the phase of the light from it moves."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from octsim.light import Light
from octsim.paths import path_name
from octsim.steady import phase_change

SIDES: Mapping[str, str] = {"near": "PT CR PT", "far": "PT CT CR CT PT"}
"""The light path that meets a side of the neuron and nothing else on its way back."""


def path_field(light: Light, name: str, wavenumber: float) -> complex:
    """Sum the rays of one light path at one wavenumber (1/µm); 0 if there are none."""
    codes = [code for code in np.unique(light.path).tolist() if path_name(code) == name]
    rays = np.isin(light.path, codes)
    turns = np.exp(1j * wavenumber * light.optical_path_length[rays])
    return complex((light.amplitude[rays] * turns).sum())


def side_slopes(
    trace_at: Callable[[float, float], Light],
    diameter: float,
    focus: float,
    wavenumber: float,
    step: float,
) -> dict[str, float]:
    """Differentiate the phase of each side's light over the diameter, the focus held.

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
        return float(phase_change(ends[:1], ends[1:])[0] / (2 * step))

    return {side: slope(name) for side, name in SIDES.items()}
