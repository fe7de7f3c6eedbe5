"""Instruments and neurons that differ from what is believed: moved, or drawn by the tolerances."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.polynomial.hermite_e import hermegauss

from octsim.config.derive import changed
from octsim.config.models import Config
from octsim.phase.derivatives import Array, stencil
from octsim.studies.calibration.parameters import parameter_named, parameters_of

_NODES, _WEIGHTS = (part.round(15) + 0.0 for part in hermegauss(5))
_WEIGHTS = _WEIGHTS / _WEIGHTS.sum()
_ROOM = 0.05
"""Of a tolerance: less between a parameter and its limit is none."""
_SIDES = np.array([-1.0, 1.0])


class Place(NamedTuple):
    """An instrument, and where its neuron and focus are besides where they were."""

    config: Config
    diameter: float
    """Added to the diameter, µm."""
    focus: float
    """Added to the height of the focus, µm."""


class Nodes(NamedTuple):
    """Changes of a parameter that stand for all that it may be."""

    offset: Array
    """Increasing, with 0 among them, (N,)."""
    weight: Array
    """How much of the distribution each stands for, (N,); 1 in all."""
    tolerance: float
    """One standard deviation of it."""


class Changes(NamedTuple):
    """How a slope changes by a parameter that is not known."""

    spread: float
    """Standard deviation."""
    shift: float
    """Mean."""
    error: float
    """Estimated error of the root of the mean square."""


def nodes_of(config: Config, name: str) -> Nodes:
    """Return nodes of a parameter: Gauss and Hermite's for its normal deviates, as far as possible.

    Of a tolerance of 0 they are those of a small one, and all of the weight is on 0.
    """
    one, tolerance = parameter_named(name), config.calibration.tolerances.of[name]
    at, (least, most) = one.believed(config), one.limits(config)
    scale = tolerance or one.step
    below, above = (room if room > _ROOM * scale else 0.0 for room in (at - least, most - at))
    reached = np.clip(scale * _NODES, -below, above)
    offset, place = np.unique(reached, return_inverse=True)
    weight: Array = np.where(offset == 0, 1.0, 0.0)
    if tolerance:
        weight = np.bincount(place, _WEIGHTS).astype(np.float64)
    return Nodes(offset, weight, tolerance)


def offsets_of(config: Config, name: str) -> Array:
    """Return five small changes of a parameter, (5,), that leave it possible."""
    one = parameter_named(name)
    return stencil(one.believed(config), one.step, *one.limits(config))


def changes_by(nodes: Nodes, slopes: Array) -> Changes:
    """Return what a parameter makes of a slope that is known at its nodes, (N,)."""
    from scipy.interpolate import KroghInterpolator

    here = slopes[np.flatnonzero(nodes.offset == 0)[0]]
    change = slopes - here
    shift = float(nodes.weight @ change)
    square = float(nodes.weight @ change**2)
    # by the rule of three, on the polynomial through the nodes
    ends = np.clip(np.sqrt(3) * nodes.tolerance * _SIDES, nodes.offset[0], nodes.offset[-1])
    fewer = ((KroghInterpolator(nodes.offset, change)(ends)) ** 2).sum() / 6
    spread = math.sqrt(max(square - shift**2, 0.0))
    return Changes(spread, shift, abs(math.sqrt(square) - math.sqrt(float(fewer))))


def moved(config: Config, changes: Mapping[str, float], law_slope: float) -> Place:
    """Return a config with parameters moved and the others held.

    The focus follows only the diameter, by the law.
    """
    diameter = changes.get("diameter", 0.0)
    focus = law_slope * diameter + changes.get("focus", 0.0)
    overlays = []
    for name, by in changes.items():
        one = parameter_named(name)
        least, most = one.limits(config)
        value = min(max(least, one.believed(config) + by), most)  # whatever the last digit is
        overlays.append(one.overlay(config, value))
    return Place(changed(config, *overlays), diameter, focus)


def drawn(config: Config, generator: np.random.Generator, law_slope: float) -> Place:
    """Return an instrument and a neuron drawn normally by the tolerances, as far as possible."""
    changes = {}
    for name, one in parameters_of(config).items():
        by = generator.normal(0.0, config.calibration.tolerances.of[name])
        at, (least, most) = one.believed(config), one.limits(config)
        changes[name] = min(max(by, least - at), most - at)
    return moved(config, changes, law_slope)
