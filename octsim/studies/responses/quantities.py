"""What of a neuron may change: by name, and a config in which it has."""

import contextlib
from collections.abc import Mapping
from typing import NamedTuple

from octsim.base.errors import ConfigError
from octsim.config.calibration import DIAMETER
from octsim.config.derive import changed, merge, nested
from octsim.config.models import Config
from octsim.config.study_checks import shells_of
from octsim.config.units import format_length
from octsim.studies.calibration.parameter import Parameter
from octsim.studies.calibration.parameters import PARAMETERS
from octsim.studies.calibration.scene_parameters import scene_parameter

CONFIGURED, WITH_MEMBRANE = "configured", "with_membrane"
"""The scene as it is, and with a thin shell where its swept cylinder has none."""
_STEPS: Mapping[str, float] = {"gap": 2e-4, "index": 2e-4, "thickness": 2e-4}
"""Changes to each side for a derivative, µm or of the index: over them the phase moves as much as
over the step of the diameter, some mrad."""


class Quantity(NamedTuple):
    """Something of the neuron that may change."""

    name: str
    unit: str
    """nm, or 1e-3 of an index: a thousandth of what the config has it in."""
    step: float
    """For a derivative, µm or of the index."""
    parameter: Parameter | None
    """How a config is changed to have it so; None of the diameter, which is a spectrum's own."""


def quantities_of(config: Config) -> tuple[Quantity, ...]:
    """Return what may change of the swept cylinder of a config.

    - ``diameter``: of its outermost surface, the gap and its shells held;
    - ``gap``: below it, the diameter held, so the whole neuron rises;
    - ``index``: of what is inside its shells;
    - ``thickness``, ``thickness_2``, …: of each shell from outside in, the outermost diameter held,
      so what is inside shrinks.

    Small changes add: a membrane that grows outwards by 1 nm, its inside held, is a thickness of
    1 nm and a diameter of 2 nm more.
    """
    swept = config.scene.swept[0]
    found = [
        Quantity(DIAMETER, "nm", config.calibration.step, None),
        Quantity("gap", "nm", _STEPS["gap"], PARAMETERS["gap"]),
        Quantity("index", "1e-3", _STEPS["index"], PARAMETERS["neuron"]),
    ]
    for shell in range(shells_of(config)):
        name = "thickness" if shell == 0 else f"thickness_{shell + 1}"
        parameter = scene_parameter(f"{swept}.shells.{shell}.thickness")
        found.append(Quantity(name, "nm", _STEPS["thickness"], parameter))
    return tuple(found)


class Changed(NamedTuple):
    """A config, and how much its neuron's diameter is beyond what it was, µm."""

    config: Config
    diameter: float = 0.0


def with_change(config: Config, quantity: Quantity, by: float) -> Changed:
    """Return a config in which a quantity has changed, by µm or of the index."""
    if quantity.parameter is None:
        return Changed(config, by)
    if not by:
        return Changed(config)
    value = quantity.parameter.believed(config) + by
    return Changed(changed(config, quantity.parameter.overlay(config, value)))


def room_of(config: Config, quantity: Quantity) -> tuple[float, float]:
    """Return what a quantity is, and the least that it may be."""
    if quantity.parameter is None:
        return 0.0, -1.0
    return quantity.parameter.believed(config), quantity.parameter.limits(config)[0]


def variants_of(config: Config) -> dict[str, Config]:
    """Return the scenes that responses are of, by name.

    A neuron without a shell is given a membrane too, by ``responses.membrane``, if the scheme can.
    """
    found = {CONFIGURED: config}
    if shells_of(config):
        return found
    membrane, indices = config.responses.membrane, config.scene.refractive_index.given
    name = "membrane"
    while name in indices:
        name += "_"
    shell = {"medium": name, "thickness": format_length(membrane.thickness)}
    overlay = merge(
        nested(f"{config.scene.swept[0]}.shells", [shell]),
        nested(f"scene.refractive_index.{name}", membrane.index),
    )
    with contextlib.suppress(ConfigError):  # of a scheme without shells, or of no room for one
        found[WITH_MEMBRANE] = changed(config, overlay)
    return found
