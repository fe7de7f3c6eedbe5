"""What a wrong scene does to a diameter: spectra of one, read with another one's calibration."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from octsim.config.derive import changed, nested
from octsim.config.dispersion import moved
from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.config.units import format_length
from octsim.instrument.points import Points
from octsim.phase.estimators.estimate import Array
from octsim.phase.estimators.likelihood import Model, maximum_likelihood
from octsim.phase.modelled_spectra import modelled
from octsim.studies.estimators.contenders import Band, sweep_slopes

GAP, INDEX, FOCUS = 0.015, 0.01, 0.1
"""How far another scene's gap (µm), neuron's index and focus (µm) are from the model's."""


class OtherScene(NamedTuple):
    """Spectra of another scene than the one that they are taken for."""

    name: str
    """What is other."""
    intensity: Array
    """Spectra, (D, K)."""


class Misreading(NamedTuple):
    """How changes of diameter are misread, relative to the change, over a sweep."""

    mean: float
    """Mean relative error of a change."""
    scatter: float
    """Standard deviation of the relative error over the diameters."""


def other_scenes(
    config: Config, foci: Array, threads: int, points: Points | None = None
) -> list[OtherScene]:
    """Return the spectra of a sweep (foci (D,) in µm) of the model's own scene and of others."""
    scene = config.scene
    gap, of = scene.swept_gap + GAP, scene.refractive_index.given
    index = moved(of[scene.swept_medium], config.swept_index + INDEX, config.spectrum.middle)
    changes: Mapping[str, tuple[Mapping[str, Any], float]] = {
        "own": ({}, 0.0),
        f"gap {1000 * GAP:+g} nm": (nested(scene.swept_gap_key, format_length(gap)), 0.0),
        f"index {INDEX:+g}": ({"scene": {"refractive_index": {scene.swept_medium: index}}}, 0.0),
        f"focus {1000 * FOCUS:+g} nm": ({}, FOCUS),
    }
    diameters = config.sweep.diameters.values()
    return [
        OtherScene(
            name,
            modelled(changed(config, overlay), diameters, foci + off, threads, points).intensity,
        )
        for name, (overlay, off) in changes.items()
    ]


def misreading(
    processing: Processing, band: Band, diameter: Array, own: Array, other: Array, model: Model
) -> Misreading:
    """Return how another scene's spectra (D, K) are read by the slopes, or model, of one's own."""
    read = sweep_slopes(processing, band, diameter, other, model)
    expected = sweep_slopes(processing, band, diameter, own, model)
    relative = read / expected - 1
    return Misreading(float(relative.mean()), float(relative.std()))


def likelihood_offset(model: Model, diameter: Array, intensity: Array) -> float:
    """Return the mean error of diameters (D,) themselves, µm, by maximum likelihood."""
    return float(np.mean(maximum_likelihood(intensity, model) - diameter))
