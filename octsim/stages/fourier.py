"""Spectra to the components of their Fourier transform (figures 9 to 11)."""

from collections.abc import Iterator
from enum import IntEnum
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.datasets.files import flags
from octsim.datasets.layout import Coordinate, Layout, filling
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.phase.by_config import estimator_of
from octsim.phase.estimators.visible import Fringe, fringe_at, is_elsewhere
from octsim.phase.fringe_status import WITH_PHASE, FringeStatus, doubts_of
from octsim.phase.hiding_error import hiding_error
from octsim.phase.transform import (
    fourier_components,
    optical_depths,
    rounding_level,
    without_source,
)
from octsim.stages.workload import points_per_block


class PhaseStatus(IntEnum):
    """Whether a component has a phase."""

    KNOWN = 0
    BELOW_ROUNDING = 1
    """It holds nothing but rounding, as the constant one, whose mean is subtracted."""
    NO_SPECTRUM = 2
    """The spectrum is NaN, as there is no focus."""


class EstimateStatus(IntEnum):
    """Whether there is a phase by an estimator."""

    KNOWN = 0
    NO_FRINGE = 1
    """The spectrum has none; fringe_status says why."""
    NO_ESTIMATE = 2
    """The estimator finds no phase."""
    BY_COMPONENTS = 3
    """The estimator is fft, whose phase is that of the components."""


@Streamed
def fourier(config: Config, spectra: xr.Dataset) -> Stream:
    """Take the Fourier transform of each spectrum.

    Returns
    -------
    Dataset
        magnitude, phase and whether that is known (diameter, component), depth(component);
        visibility and status of the fringe (diameter); and, of another estimator than fft,
        estimated_phase, estimated_depth and estimate_status (diameter), NaN where there is no
        fringe.

    Examples
    --------
    >>> import octsim
    >>> config = octsim.load_config(
    ...     {
    ...         "tracing": {"rays": 200},
    ...         "sweep": {
    ...             "diameters": {"stop": "1.1 um", "num": 3},
    ...             "focus": {"slope": 0.58, "intercept": "66 nm"},
    ...         },
    ...     }
    ... )
    >>> spectra = octsim.spectra(config, octsim.detections(config))
    >>> transformed = octsim.fourier(config, spectra)
    >>> dict(transformed["phase"].sizes)
    {'diameter': 3, 'component': 501}
    """

    def own(config: Config) -> dict[str, Coordinate]:
        depths = optical_depths(config.spectrum.wavenumbers())
        return {
            "diameter": ("diameter", config.sweep.diameters.values()),
            "component": ("component", np.arange(depths.size)),
            "depth": ("component", depths),
        }

    title = "Fourier transform of the spectrum, for each diameter"
    layout = Layout("fourier", config, title, own, "diameter")
    return Stream(layout, _transformed(layout, Stored(spectra, "spectra", config, layout)))


def by_components(config: Config) -> bool:
    """Return whether the phase is that of the components themselves."""
    return config.processing.estimator == "fft"


def block_points(config: Config) -> int:
    """Return how many diameters' components are worked on at a time."""
    return points_per_block(40 * config.spectrum.samples)


def _transformed(layout: Layout, stored: Stored) -> Iterator[Part]:
    dimensions = ("diameter", "component")
    estimates = any(not by_components(at.config) for at in layout.combinations)
    for at, span in layout.blocks(block_points):
        part = stored.part(at, span)
        intensity = part["intensity"].values
        bare = without_source(intensity, at.config.spectrum.power())
        components = fourier_components(bare, at.config.processing)
        magnitude = np.abs(components)
        fringe = _fringe(at.config, part, magnitude)
        visible = np.isin(fringe.status, WITH_PHASE)
        status = _status(magnitude, rounding_level(intensity, at.config.processing))
        phase = np.where(status == PhaseStatus.KNOWN, np.angle(components), np.nan)
        variables: dict[str, Any] = {
            "magnitude": (dimensions, magnitude),
            "phase": (dimensions, phase),
            "phase_status": (dimensions, *flags(PhaseStatus, status)),
            "fringe_visibility": ("diameter", fringe.visibility),
            "fringe_status": ("diameter", *flags(FringeStatus, fringe.status)),
        }
        if estimates:
            if span.start == 0:
                foci = stored.part(at, names=("focus",))["focus"].values
                estimate = estimator_of(at.config, foci)
            found = np.full((2, len(intensity)), np.nan)
            if visible.any():
                found[:, visible] = estimate(intensity[visible], part["diameter"].values[visible])
            variables["estimated_phase"] = "diameter", found[0]
            variables["estimated_depth"] = "diameter", found[1]
            told = _estimated(found[0], visible, by_components(at.config))
            variables["estimate_status"] = "diameter", *flags(EstimateStatus, told)
        yield Part(at, span.start, len(intensity), variables)


def _estimated(
    phase: NDArray[np.float64], visible: NDArray[np.bool_], by_components: bool
) -> NDArray[np.int64]:
    """Return the `EstimateStatus` of phases (D,)."""
    return np.select(
        [~np.isnan(phase), np.full(phase.size, by_components), ~visible],
        [EstimateStatus.KNOWN, EstimateStatus.BY_COMPONENTS, EstimateStatus.NO_FRINGE],
        EstimateStatus.NO_ESTIMATE,
    )


def _fringe(config: Config, part: xr.Dataset, magnitude: NDArray[np.float64]) -> Fringe:
    """Look for the fringe of spectra whose components' magnitudes (D, C) are known."""
    k = config.spectrum.wavenumbers()
    depth = config.swept_group_index * part["diameter"].values
    error = hiding_error(part["intensity_error"].values, part["accuracy_status"].values)
    power = config.spectrum.power()
    found = fringe_at(part["intensity"].values, k, depth, error, power)
    if not by_components(config):
        return found
    strongest = 1 + magnitude[:, 1:].argmax(axis=1)
    elsewhere = np.isin(found.status, WITH_PHASE) & is_elsewhere(strongest, k, depth)
    status = np.where(elsewhere, FringeStatus.OTHER_DEPTHS, found.status)
    return Fringe(np.where(elsewhere, np.nan, found.visibility), status)


def doubts(transformed: xr.Dataset) -> list[str]:
    """Say, a line each, of which spectra the phase is not known, or to be doubted."""
    status = transformed["fringe_status"].values
    status = status[(status != filling(status.dtype)) & (status != FringeStatus.NO_SPECTRUM)]
    return doubts_of(status, "diameters (fringe_status)")


def _status(magnitude: NDArray[np.float64], level: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return which components (D, C) are above the rounding (D, 1) of their spectra."""
    missing = np.where(np.isnan(magnitude), PhaseStatus.NO_SPECTRUM, PhaseStatus.BELOW_ROUNDING)
    return np.where(magnitude > level, PhaseStatus.KNOWN, missing)
