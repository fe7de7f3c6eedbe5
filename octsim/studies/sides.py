"""The neuron's two sides, each by itself: the light from it, and how its phase moves."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from octsim.optics.scene import NEURON_ON_GLASS
from octsim.schemes.field_sum import field_at
from octsim.schemes.fullwave.series import over_band
from octsim.schemes.light import TERMS, Found, Light, Sampled, Waves
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


def side_fields(light: Found, wavenumber: float) -> dict[str, NDArray[np.complex128]]:
    """Return the fields of each side's light at one wavenumber, 1/µm.

    Returns
    -------
    dict
        Of ``near`` and ``far``, (C,): of rays one field, of waves one of each polarisation.
    """
    if isinstance(light, Waves):
        k = np.array([wavenumber])
        terms = dict(zip(TERMS, light.terms, strict=True))
        return {side: over_band(light, terms[f"{side}_side"], k)[:, 0] for side in SIDES}
    rays = light.rays if isinstance(light, Sampled) else light
    return {side: np.array([path_field(rays, name, wavenumber)]) for side, name in SIDES.items()}


def side_slopes(
    light_at: Callable[[float, float], Found],
    diameter: float,
    focus: float,
    wavenumber: float,
    step: float,
) -> dict[str, float]:
    """Return how the phase of each side's light moves with the diameter, the focus held.

    Parameters
    ----------
    light_at : callable
        From diameter and focus, µm, to light.
    diameter, focus, step : float
        µm; the diameter moves by a step to each side.
    wavenumber : float
        1/µm.

    Returns
    -------
    dict
        Of ``near`` and ``far``, mrad/nm; NaN without light. Of two polarisations, the mean by
        their intensities.
    """
    before, after = (
        side_fields(light_at(diameter + by, focus), wavenumber) for by in (-step, step)
    )

    def slope(side: str) -> float:
        advance = complex(np.vdot(before[side], after[side]))
        return float(np.angle(advance)) / (2 * step) if advance else np.nan

    return {side: slope(side) for side in SIDES}
