"""How far numbers may be apart that other libraries, or another processor, have computed."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import xarray as xr

from octsim.config.models import Config
from octsim.stages.gaussian_fits import GAUSSIAN_PARAMETERS

TOLERANCE = 1e-12
"""Relative difference up to which numbers of one environment count as the same."""
LIGHT = 2e-8
"""Of the light, relative, and of phases, rad. Rounding moves a phase by less than 1e-9 rad
(`octsim.config.checks`), twice of which is in an intensity. A fitted focus moves it more: before
0.4.0 least squares ended once a step changed the sum of squares by less than 1e-12 of it, which
left the centre √1e-12 = 1e-6 of its standard error away; that error is some 1e-2 of the focus, in
µm, over which the phase turns by a radian or two."""
ESTIMATED_ERROR = 1e-4
"""Of estimated errors: differences of numbers that agree to the accuracy asked for, 1e-4 and less
of them, so that LIGHT is this much of the difference."""
UNSOLVED = 1e-6
"""Of what least squares leaves, by how much a step moves the fit that is the last: √1e-12."""
WEAK = 1e-3
"""Of the phases of single components and paths, rad. The light's error, LIGHT of the strongest,
turns a component by as much as that is more than the component itself; side lobes of the windows,
43 dB down and 6 dB less with each octave, are down to 1e-5 of it."""
BY_NAME: Mapping[str, float] = {
    "intensity_error": ESTIMATED_ERROR,
    "missing_field": ESTIMATED_ERROR,
    "residual": ESTIMATED_ERROR,
    "predicted_phase_slope": TOLERANCE,
    "phase": WEAK,
    "field_phase": WEAK,
}
"""Those whose condition their unit does not tell; beside them every standard error."""
STEPPED: Mapping[str, int] = {"mrad/nm": 1, "mrad/nm2": 2}
"""How often a phase is differentiated over the diameter, by unit."""


class Condition(NamedTuple):
    """What the numbers of a stage's dataset hang on."""

    step: float
    """Step of the diameter that phases are differentiated over, µm; NaN if none is."""
    fitted: Mapping[str, float]
    """By how much parameters of a fit may be off, where its standard errors are beside them.

    A step p that moves the fit by J p, of norm UNSOLVED times the residual's, is in each parameter
    UNSOLVED · √degrees of freedom · standard error; either side may be as far from the minimum.
    """

    def tolerance(self, name: str, units: str, scale: float) -> float:
        """Return the relative difference that a variable may have in another environment.

        Parameters
        ----------
        name, units : str
            Of the variable.
        scale : float
            Its largest value, which differences are relative to.
        """
        if name in BY_NAME:
            return BY_NAME[name]
        if name.endswith("_standard_error"):
            return ESTIMATED_ERROR
        if name in self.fitted and scale > 0:
            return max(LIGHT, self.fitted[name] / scale)
        if units not in STEPPED or not self.step > 0 or not scale > 0:
            return LIGHT
        # a central difference has both phases' errors, over two steps; a one-sided one over one
        absolute = 2 * (WEAK if name == "component_phase_slope" else LIGHT) / self.step
        if STEPPED[units] > 1:
            absolute *= 2 / (1e3 * self.step)
        return max(LIGHT, absolute / scale)


def condition(dataset: xr.Dataset, stage: str, config: Config) -> Condition:
    """Return what a dataset's numbers hang on."""
    if stage == "gaussian_fits":
        return Condition(np.nan, _unsolved(dataset, config))
    if stage in ("calibration", "responses", "expansion"):
        return Condition(config.calibration.step, {})
    if "diameter" not in dataset.coords or dataset["diameter"].shape[-1:] in ((), (1,)):
        return Condition(np.nan, {})
    steps = np.diff(dataset["diameter"].values, axis=-1)
    steps = steps[steps > 0]
    return Condition(float(steps.min()) if steps.size else np.nan, {})


def _unsolved(fits: xr.Dataset, config: Config) -> dict[str, float]:
    freedom = max(1, config.focus_law.fraction.num - len(GAUSSIAN_PARAMETERS))
    errors = {name: fits.get(f"{name}_standard_error") for name in GAUSSIAN_PARAMETERS}
    return {
        name: float(2 * UNSOLVED * np.sqrt(freedom) * error.max())
        for name, error in errors.items()
        if error is not None and error.notnull().any()
    }


def same_environment(first: xr.Dataset, second: xr.Dataset) -> bool:
    """Return whether two datasets say that the same libraries and kind of processor made them."""
    one, other = (dataset.attrs.get("environment") for dataset in (first, second))
    return one is not None and one == other
