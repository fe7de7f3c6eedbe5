"""A Michelson interferometer: a reference arm beside a mirror in the focus (thesis §2.1)."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.derive import changed, counting_rays
from octsim.config.models import Config
from octsim.instrument.instrument import Instrument

Array = NDArray[np.float64]
ARM = 9.0
"""Length of the reference arm whose spectrum is shown, one way, µm."""
REACH, STEPS = 3.0, 601
"""Lengths that the mirror is moved through, to both sides of the focus, µm, and how many."""

ALONE: Mapping[str, Any] = {
    "interferometer": {"reference": None}, "objective": {"immersion": None},
}  # fmt: skip
"""Overlay that leaves nothing beside a scene that a closed form is of."""


class Michelson(NamedTuple):
    """What the interferometer shows."""

    intensity: Array
    """Spectrum with the arm of `ARM`, (K,)."""
    closed_form: Array
    """The same by eq. (1), with L one way in the place of ΔL, (K,)."""
    arm: Array
    """Lengths of the moved arm, one way, (M,), µm."""
    one_wavelength: Array
    """Intensity over them at the middle of the band, (M,), over its mean."""
    band: Array
    """Intensity over them of the whole band, (M,), over its mean."""


def michelson(config: Config) -> Michelson:
    """Return what a plane in the focus shows beside an arm that returns as much."""
    glass, water = config.scene.objective_medium, config.scene.host_medium
    # what is swept is of the medium above it, and so no surface
    swept = {"medium": water, "thickness": "swept"}
    scene = {"layers": [glass, swept, water], "cylinders": []}
    # the pupil is even and the focus on the plane: all rays return to it in phase
    alone = changed(counting_rays(config), ALONE, {"scene": scene})
    instrument = Instrument(alone)
    k = instrument.wavenumber
    amplitude = float(np.sqrt(instrument.spectrum(1.0, 0.0).intensity.mean()))

    def seen(length: float) -> Array:
        arm = {"amplitude": amplitude, "length": f"{length!r} um"}
        beside = changed(alone, {"interferometer": {"reference": arm}})
        return Instrument(beside).spectrum(1.0, 0.0).intensity

    arms = np.linspace(-REACH, REACH, STEPS)
    over = np.stack([seen(length) for length in arms.tolist()])
    # from the denser side the plane does not turn the phase
    by_formula = 2 * amplitude**2 * (1 + np.cos(2 * k * ARM))
    bright = 2 * amplitude**2
    return Michelson(
        seen(ARM), by_formula, arms, over[:, k.size // 2] / bright, over.mean(axis=1) / bright
    )
