"""What of the instrument and the neuron may differ from what is believed, and how it is moved."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from octsim.config.derive import changed, nested, part_of
from octsim.config.grid import value_at
from octsim.config.models import Config
from octsim.config.units import format_length
from octsim.instrument.build import detector_of
from octsim.phase.derivatives import Array, stencil


class Place(NamedTuple):
    """An instrument, and where its neuron and focus are besides where they were."""

    config: Config
    diameter: float
    """Added to the diameter, µm."""
    focus: float
    """Added to the height of the focus, µm."""


class Parameter(NamedTuple):
    """What is moved."""

    step: float
    """Largest change, for a derivative; µm where it is a length."""
    key: str = ""
    """Its key of the config; none for what is no part of one."""
    least: float = -np.inf
    most: float = np.inf


_LEAST_NA = 1e-3
PARAMETERS: Mapping[str, Parameter] = {
    # of the neuron at rest: the focus is looked for by the greatest intensity, so it goes with it
    "diameter": Parameter(2e-3),
    "gap": Parameter(1e-3, "scene.gap", least=0.0),
    "glass": Parameter(1e-3, "scene.refractive_index", least=1.0, most=10.0),
    "water": Parameter(1e-3, "scene.refractive_index", least=1.0, most=10.0),
    "neuron": Parameter(1e-3, "scene.refractive_index", least=1.0, most=10.0),
    "focus": Parameter(4e-3),
    "numerical_aperture": Parameter(3e-3, "objective.numerical_aperture", least=_LEAST_NA),
    "detector_radius": Parameter(1e-3, "detector.core_diameter"),
    "wavelength_min": Parameter(2e-4, "spectrum.wavelength.min"),
    "wavelength_max": Parameter(2e-4, "spectrum.wavelength.max"),
}
"""Each by the name of its tolerance."""
INDICES = ("glass", "water", "neuron", "numerical_aperture")
"""Parameters without a unit; the others are lengths."""


def value_of(config: Config, name: str) -> float:
    """Return what a parameter is in a config; 0 for what is no part of one."""
    if name == "detector_radius":
        return detector_of(config).radius
    key = _key(config, name)
    return float(value_at(config, key)) if key else 0.0


def _key(config: Config, name: str) -> str:
    """Return the key of a parameter: of an index and of a gap what the config's scene calls it."""
    scene = config.scene
    media = {
        "glass": scene.objective_medium, "water": scene.host_medium, "neuron": scene.swept_medium,
    }  # fmt: skip
    if name in media:
        return f"scene.refractive_index.{media[name]}"
    return scene.swept_gap_key if name == "gap" else PARAMETERS[name].key


def offsets_of(config: Config, name: str) -> Array:
    """Return five changes of a parameter, (5,), that leave it possible."""
    return stencil(value_of(config, name), PARAMETERS[name].step, *limits(config, name))


def limits(config: Config, name: str) -> tuple[float, float]:
    """Return the least and the most that a parameter may be, with the others within theirs."""
    least, most = PARAMETERS[name].least, PARAMETERS[name].most
    glass, aperture = config.scene.objective_index, config.objective.numerical_aperture
    if name == "glass":
        least = max(least, (glass + aperture) / 2)
    if name == "numerical_aperture":
        most = aperture + 0.49 * (glass - aperture)
    return least, most


def moved(config: Config, changes: Mapping[str, float], law_slope: float) -> Place:
    """Return a config with parameters moved and the others held.

    The focus follows only the diameter, by the law.
    """
    diameter = changes.get("diameter", 0.0)
    focus = law_slope * diameter + changes.get("focus", 0.0)
    data, overlay = config.to_dict(), {}
    for name, by in changes.items():
        key, least = _key(config, name), PARAMETERS[name].least
        value = max(least, value_of(config, name) + by)  # whatever the last digit is rounded to
        if name == "detector_radius":
            value *= 2 * config.objective.magnification
        if key:
            overlay[key] = format_length(value) if isinstance(part_of(data, key), str) else value
    return Place(
        changed(config, *(nested(key, value) for key, value in overlay.items())), diameter, focus
    )


def drawn(config: Config, generator: np.random.Generator, law_slope: float) -> Place:
    """Return an instrument and a neuron drawn normally by the tolerances, as far as possible."""
    changes = {}
    for name in PARAMETERS:
        by = generator.normal(0.0, getattr(config.calibration.tolerances, name))
        at, (least, most) = value_of(config, name), limits(config, name)
        changes[name] = min(max(by, least - at), most - at)
    return moved(config, changes, law_slope)
