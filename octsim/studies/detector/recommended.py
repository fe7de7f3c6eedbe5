"""Which falloff and radius to take, from the numbers of detector.nc."""

import json
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr

from octsim.config.models import Config
from octsim.phase.fringe_status import WITH_PHASE
from octsim.schemes.light import AccuracyStatus
from octsim.stages.by_maxwell import ExactStatus
from octsim.studies.detector.cases import LimitStatus, own_radius
from octsim.studies.detector.over_diameter import mean_of_known, root_mean_square

BLOCKS = 8
"""Of neighbouring diameters, whose differences from Maxwell's are taken as independent."""
TOLD_APART = 2.0
"""Standard errors above the least from which a mean square difference is told from it."""


class Chosen(NamedTuple):
    """A detector of the table."""

    falloff: str
    radius: float
    """R_det, µm."""

    @property
    def at(self) -> dict[str, object]:
        """The selection of it."""
        return {"falloff": self.falloff, "detector_radius": self.radius}

    def __str__(self) -> str:
        return f"{self.falloff.replace('_', ' ')} at {self.radius:.3g} um"


def least(values: xr.DataArray) -> Chosen | None:
    """Return the detector of the least value; None if all are NaN."""
    if bool(values.isnull().all()):
        return None
    places = values.argmin(("falloff", "detector_radius"))
    one = values.isel({str(name): int(place) for name, place in places.items()})
    return Chosen(str(one["falloff"].item()), float(one["detector_radius"]))


def own(table: xr.Dataset) -> Chosen:
    """Return the run's own detector."""
    config = Config.model_validate(json.loads(table.attrs["config"]))
    radius = table["detector_radius"].sel(detector_radius=own_radius(config), method="nearest")
    return Chosen(config.detector.falloff, float(radius))


def closest(table: xr.Dataset, name: str) -> Chosen | None:
    """Return the detector of counted rays that is closest to Maxwell's equations by a variable."""
    return least(table[name].sel(ray_scheme="vogel"))


def as_close(table: xr.Dataset) -> xr.DataArray:
    """Return which detectors are not told from the one that is closest to Maxwell's slope.

    The mean square differences of two detectors are told apart by their scatter over `BLOCKS` of
    the diameters; their own are alike, as they are mostly Maxwell's swings. All are as close where
    nothing is compared, or at too few diameters to tell.
    """
    best = closest(table, "slope_difference")
    slope = table["ray_phase_slope"].sel(ray_scheme="vogel")
    if best is None or slope.sizes["diameter"] < 2 * BLOCKS:
        return xr.ones_like(slope.isel(diameter=0, drop=True), bool)
    squared = (slope - table["sweep_maxwell_phase_slope"]) ** 2
    more = (squared - squared.sel(best.at)).transpose("falloff", "detector_radius", "diameter")
    blocks = [mean_of_known(part) for part in np.array_split(more.values, BLOCKS, axis=-1)]
    mean, number = mean_of_known(np.stack(blocks, -1)), np.isfinite(blocks).sum(axis=0)
    spread = root_mean_square(np.stack(blocks, -1) - mean[..., np.newaxis])
    error = spread / np.sqrt(np.maximum(number - 1, 1))
    return more.isel(diameter=0, drop=True).copy(data=mean <= TOLD_APART * error)


def chosen(table: xr.Dataset) -> Chosen | None:
    """Return the detector to take: of the least ray noise, of those as close to Maxwell's as any.

    None where no ray noise is known.
    """
    noise = table["ray_noise"]
    return least(noise.where(as_close(table))) or least(noise)


def recommendation(table: xr.Dataset) -> str:
    """Say in a sentence which falloff and radius to take, and what the run's own ones cost."""
    mine, taken, quiet = own(table), chosen(table), least(table["ray_noise"])
    if taken is None or quiet is None:
        return (
            f"no ray noise is known, as scheme paths can't do the instrument; {mine} turns the "
            f"phase by {_edge(table, mine)} as edge rays come and go"
        )
    exact = _beside_maxwell(table)
    core = float(table["fibre_core_diameter"].sel(detector_radius=taken.radius))
    advice = (
        f"the run's own {mine} does as well as any: keep it"
        if taken == mine
        else (
            f"take detector: {{falloff: {taken.falloff}, core_diameter: {core:.4g} um}}, R_det "
            f"{taken.radius:.3g} um ({_costs(table, taken)}), instead of the run's own {mine} "
            f"({_costs(table, mine)})"
        )
    )
    return f"least ray noise: {quiet} ({_noise(table, quiet)}); {exact}{advice}"


def _beside_maxwell(table: xr.Dataset) -> str:
    slope, shape = closest(table, "slope_difference"), closest(table, "shape_difference")
    if slope is None or shape is None:
        return ""
    away, form = (table[name].sel(ray_scheme="vogel") for name in
                  ("slope_difference", "shape_difference"))  # fmt: skip
    return (
        f"closest to Maxwell's equations in slope: {slope} ({float(away.sel(slope.at)):.3g} "
        f"mrad/nm rms, the farthest {float(away.max()):.3g}), in the spectrum's shape: {shape} "
        f"({float(form.sel(shape.at)):.2g} of the mean, the farthest {float(form.max()):.2g}); "
    )


def _noise(table: xr.Dataset, one: Chosen) -> str:
    noise = float(table["ray_noise"].sel(one.at))
    return f"{noise:.2g} mrad/nm" if np.isfinite(noise) else "not known"


def _edge(table: xr.Dataset, one: Chosen) -> str:
    return f"{float(table['edge_phase_jump'].sel(one.at)):.2g} mrad/nm rms"


def _costs(table: xr.Dataset, one: Chosen) -> str:
    away = float(table["slope_difference"].sel(ray_scheme="vogel").sel(one.at))
    beside = f", {away:.3g} from Maxwell's" if np.isfinite(away) else ""
    return f"ray noise {_noise(table, one)}{beside}"


def summary(table: xr.Dataset) -> str:
    """Return the recommendation."""
    return f"detector: {table.attrs['recommendation']}"


def doubts(table: xr.Dataset) -> Iterator[str]:
    """Say, a line each, where the comparison does not tell what it is to tell."""
    fringe = table["fringe_status"].sel(ray_scheme="vogel").isin(WITH_PHASE)
    for falloff in table["falloff"].values:
        lost = int((~fringe.sel(falloff=falloff)).sum())
        if lost:
            yield (
                f"detector: {lost} spectra of the falloff {falloff} have no fringe (fringe_status) "
                "and count in no slope"
            )
    known = table["limit_status"] == LimitStatus.KNOWN
    if not known.any():
        yield "detector: no ray noise is known (limit_status); give an instrument that paths can do"
    late = int(((table["accuracy_status"] != AccuracyStatus.REACHED) & known).sum())
    if late:
        yield f"detector: {late} spectra by light paths are not as accurate as asked"
    if int(table["exact_status"]) != ExactStatus.COMPARED:
        yield "detector: nothing is compared with Maxwell's equations (exact_status)"
    elif (table["maxwell_accuracy_status"] != AccuracyStatus.REACHED).any():
        yield "detector: spectra by Maxwell's equations are not as accurate as asked"
    taken, radii = chosen(table), table["detector_radius"].values
    if taken and taken.radius in radii[[0, -1]]:
        yield (
            f"detector: the radius to take, {taken.radius:.3g} um, is at an end of those compared"
        )
