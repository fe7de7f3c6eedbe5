"""How far a run by rays is from Maxwell's equations, at some of its own diameters."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.checks import impossible
from octsim.config.derive import by_waves
from octsim.config.grid import Combination
from octsim.config.models import Config
from octsim.config.scheme import scheme_of
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.instrument.instrument import Instrument
from octsim.instrument.points import Points
from octsim.phase.local_slope import LEAST_SQUARES, local_slope
from octsim.stages.workload import point_cost

COMPARED = 5
"""Diameters of the sweep, evenly chosen; one where a grid has many sweeps."""
_LONG = 0.5  # s, of a point
BY = ("run", "least_squares")
"""Estimators: the run's own, and a sinusoid at the frequency of each diameter."""


@Streamed
def maxwell(config: Config, spectra: xr.Dataset, points: Points | None = None) -> Stream:
    """Compare a run's phase slopes with those of the scheme fullwave at the same foci.

    The pupil that a ray scheme does not weigh is the one of fullwave's own: the fibre's mode.

    Returns
    -------
    Dataset
        ray_phase_slope and exact_phase_slope (diameter, by), fringe visibilities and the largest
        difference of the spectra over their means (diameter), at some of the sweep's diameters; NaN
        where fullwave can't do the scene.
    """

    def own(config: Config) -> dict[str, Coordinate]:
        diameters = config.sweep.diameters.values()
        return {
            "diameter": ("diameter", diameters[_chosen(config, diameters.size)]),
            "by": ("by", np.array(BY)),
        }

    title = "Phase slopes of a run by rays, beside those by Maxwell's equations"
    layout = Layout("maxwell", config, title, own, "diameter")
    stored = Stored(spectra, "spectra", config)
    return Stream(layout, _compared(layout, stored, points or Points()))


def _chosen(config: Config, number: int) -> NDArray[np.int64]:
    """Return which diameters are compared, each with a neighbour on both sides."""
    many = 1 if config.grid.varied else COMPARED
    places = (
        np.linspace(1, number - 2, many + 2)[1:-1]
        if many == 1
        else np.linspace(1, number - 2, many)
    )
    return np.unique(places.round().astype(int))


def _compared(layout: Layout, stored: Stored, points: Points) -> Iterator[Part]:
    for at in layout.combinations:
        count = layout.count(at)
        if scheme_of(at.config).light != "rays":
            continue
        whole = stored.part(at)
        chosen = _chosen(layout.config, whole.sizes["diameter"])
        found = [_at(at, whole.isel(diameter=slice(n - 1, n + 2)), points) for n in chosen]
        variables: dict[str, Any] = {
            name: ("diameter", np.array([one[name] for one in found]))
            for name in ("ray_visibility", "exact_visibility", "spectrum_difference")
        }
        for name in ("ray_phase_slope", "exact_phase_slope"):
            variables[name] = ("diameter", "by"), np.array([one[name] for one in found])
        yield Part(at, 0, count, variables)


def _at(at: Combination, three: xr.Dataset, points: Points) -> dict[str, Any]:
    """Compare at the middle one of three diameters."""
    config, k = at.config, at.config.spectrum.wavenumbers()
    diameter, focus = three["diameter"].values, three["focus"].values
    by_rays = three["intensity"].values
    waves = by_waves(config)
    exact = (
        Instrument(waves, points).spectra(diameter, focus)
        if _is_compared(waves)
        else np.full_like(by_rays, np.nan)
    )
    index = config.scene.swept_index
    found: dict[str, Any] = {}
    for name, intensity in (("ray", by_rays), ("exact", exact)):
        if not np.isfinite(intensity).all() or not intensity.any():
            found |= {f"{name}_phase_slope": [np.nan] * len(BY), f"{name}_visibility": np.nan}
            continue
        slopes = [
            local_slope(intensity, diameter, k, index, processing)
            for processing in (config.processing, LEAST_SQUARES)
        ]
        found[f"{name}_phase_slope"] = [one.slope for one in slopes]
        found[f"{name}_visibility"] = slopes[0].visibility
    shapes = [
        one[1] / one[1].mean() if one[1].any() else one[1] * np.nan for one in (by_rays, exact)
    ]
    found["spectrum_difference"] = float(np.abs(shapes[0] - shapes[1]).max())
    return found


def _is_compared(waves: Config) -> bool:
    """Return whether a config's points are possible by the scheme fullwave, and take no time."""
    return not any(impossible(waves)) and point_cost(waves).seconds < _LONG


def summary(compared: xr.Dataset) -> str:
    """Return in one line how far a run's phase slopes are from Maxwell's equations."""
    rays, exact = compared["ray_phase_slope"], compared["exact_phase_slope"]
    known = np.isfinite(rays.values) & np.isfinite(exact.values)
    if not known[..., 1].any():
        return (
            "how far rays are from Maxwell's equations is not known here: scheme fullwave can't do "
            "this scene, or takes long for it, or there is no fringe"
        )
    off = (rays / exact - 1).values * 100
    told = [
        f"{_percent(off[..., number])} by {name}"
        for number, name in enumerate(("the run's estimator", "least squares"))
        if known[..., number].any()
    ]
    where = compared["diameter"].values
    return (
        f"beside Maxwell's equations with a fibre's pupil, phase slopes by rays are off by "
        f"{' and '.join(told)} ({np.nanmin(where):.4g} to {np.nanmax(where):.4g} um, maxwell.nc); "
        "tracing: {preset: exact} gives Maxwell's own"
    )


def _percent(off: NDArray[np.float64]) -> str:
    known = off[np.isfinite(off)]
    return f"{known.mean():+.1f} % ({known.min():+.1f} to {known.max():+.1f})"
