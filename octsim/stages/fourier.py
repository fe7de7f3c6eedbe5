"""Spectra to the components of their Fourier transform (figures 9 to 11)."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from octsim.config.models import Config
from octsim.datasets.layout import Coordinate, Layout
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream, Streamed
from octsim.phase.by_config import estimator_of
from octsim.phase.transform import fourier_components, optical_depths
from octsim.stages.workload import points_per_block


@Streamed
def fourier(config: Config, spectra: xr.Dataset) -> Stream:
    """Take the Fourier transform of each spectrum.

    Returns
    -------
    Dataset
        magnitude and phase (diameter, component), depth(component); and, of another estimator than
        fft, estimated_phase and estimated_depth (diameter).
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
        components = fourier_components(intensity, at.config.processing)
        variables: dict[str, Any] = {
            "magnitude": (dimensions, np.abs(components)),
            "phase": (dimensions, np.angle(components)),
        }
        if estimates:
            if span.start == 0:
                foci = stored.part(at, names=("focus",))["focus"].values
                estimate = estimator_of(at.config, foci)
            found = estimate(intensity, part["diameter"].values)
            variables["estimated_phase"] = "diameter", found.phase
            variables["estimated_depth"] = "diameter", found.depth
        yield Part(at, span.start, len(intensity), variables)
