"""What responses say of themselves: what moves the phase, and where it is not sure."""

import numpy as np
import xarray as xr

from octsim.config.calibration import DIAMETER
from octsim.config.models import Config
from octsim.datasets.versions import recorded_config
from octsim.schemes.light import AccuracyStatus
from octsim.studies.calibration.scheme import ModelStatus, rays_because
from octsim.studies.responses.observables import WHOLE
from octsim.studies.responses.quantities import WITH_MEMBRANE
from octsim.studies.responses.separability import Separability
from octsim.studies.responses.sources import SPECTRUM

_LEAST_SURE = 0.05
"""Of a derivative of the spectrum: what its two steps differ by at most."""


def neuron_at(table: xr.Dataset) -> xr.Dataset:
    """Return the responses at the diameter of the expansion, in the scene that has most."""
    config = Config.model_validate(recorded_config(table.attrs))
    return table.sel(diameter=config.expansion.diameter, method="nearest").isel(variant=-1)


def summary(table: xr.Dataset) -> str:
    """Return what the phase moves by, and what is told apart, in one line."""
    one = neuron_at(table)
    phase = one["phase_response"].sel(observable=WHOLE)
    moved = ", ".join(
        f"{name} {float(phase.sel(quantity=name)):+.3g} mrad/{unit}"
        for name, unit in zip(one["quantity"].values, one["quantity_unit"].values, strict=True)
    )
    status = one["separability_with_other"].sel(source=SPECTRUM)
    others = [str(name) for name in one["quantity"].values if name != DIAMETER]
    at = {str(name): place for place, name in enumerate(one["quantity"].values)}
    told = [
        name for name in others
        if status.values[at[DIAMETER], at[name]] == Separability.SEPARABLE
    ]  # fmt: skip
    together = one["separability"].sel(source=SPECTRUM) == Separability.SEPARABLE
    every = "all together too" if bool(together.all()) else "not all together"
    scene = ", with a membrane" if one["variant"].item() == WITH_MEMBRANE else ""
    return (
        f"at {float(one['diameter']):.4g} um{scene}, focus held, the phase moves by {moved}; the "
        "shape of "
        f"a spectrum tells the diameter from each of {', '.join(told) or 'no other'}, {every}"
    )


def doubts(table: xr.Dataset) -> list[str]:
    """Say, a line each, where responses are not what one would want."""
    said = []
    late = table["accuracy_status"].values != AccuracyStatus.REACHED
    if late.any():
        said.append(
            f"the accuracy of the spectra is not, or not surely, reached at {late.sum()} of "
            f"{late.size} neurons (accuracy_status; estimated error up to "
            f"{float(table['intensity_error'].values[late].max()):.2g}): give other "
            "responses.diameters, or another calibration.scheme"
        )
    if int(table["model_status"]) == ModelStatus.NOT_COMPARED:
        config = Config.model_validate(recorded_config(table.attrs))
        said.append(
            f"the responses are by rays ({rays_because(config).partition('; ')[0]}) and are not "
            "compared with Maxwell's equations, so their standard errors are not known (NaN)"
        )
    rough = float(np.nanmax(table["intensity_response_error"]))
    if rough > _LEAST_SURE:
        said.append(
            f"derivatives of the spectrum by two steps differ by up to {rough:.1%} of the largest; "
            "give another calibration.step"
        )
    return said
