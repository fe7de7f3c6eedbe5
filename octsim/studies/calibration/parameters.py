"""What of the instrument and the neuron may differ from what is believed: one row for each."""

import math
from collections.abc import Callable, Mapping

from octsim.config.derive import merge, nested
from octsim.config.following import calibration_diameters
from octsim.config.light import FibreMode, GaussianFill
from octsim.config.models import Config
from octsim.config.pixels import PixelTable
from octsim.config.scene_checks import least_index
from octsim.config.scheme import scheme_of
from octsim.config.units import format_angle, format_length
from octsim.instrument.build import detector_of
from octsim.schemes.table import Ability
from octsim.studies.calibration.parameter import (
    Overlay,
    Parameter,
    above_aperture,
    index_of,
    keyed,
)
from octsim.studies.calibration.scene_parameters import scene_parameter

_LEAST_NA = 1e-3


def _glass_limits(config: Config) -> tuple[float, float]:
    return above_aperture(config, config.objective_index)


def _water_limits(config: Config) -> tuple[float, float]:
    return above_aperture(config, config.host_index) if _of_waves(config) else (1.0, 10.0)


def _aperture_limits(config: Config) -> tuple[float, float]:
    aperture = config.objective.numerical_aperture
    above = [config.objective_index, *([config.host_index] if _of_waves(config) else [])]
    if immersion := config.objective.immersion:
        above.append(least_index(config, immersion))
    return _LEAST_NA, aperture + 0.49 * (min(above) - aperture)


def _of_waves(config: Config) -> bool:
    return scheme_of(config).light == "waves"


def _can(ability: Ability) -> Callable[[Config], bool]:
    return lambda config: ability in scheme_of(config).honours


def _nothing(_config: Config, _value: float) -> Overlay:
    return {}


def _core(config: Config, radius: float) -> Overlay:
    diameter = 2 * config.objective.magnification * radius
    return nested("detector.core_diameter", format_length(diameter))


def _filled(config: Config, times: float) -> Overlay:
    match config.pupil:
        case GaussianFill(gaussian=fill):
            return nested("objective.pupil", {"gaussian": times * fill})
        case FibreMode(fibre=diameter):
            # a wider mode fills less of the pupil
            return nested("objective.pupil", {"fibre": format_length(diameter / times)})
        case _:
            return {}


def _is_filled(config: Config) -> bool:
    return config.pupil != "uniform"


def _is_polarised(config: Config) -> bool:
    return _of_waves(config) or config.polarisation.given


def _direction(config: Config) -> float:
    """Return the angle, rad, of linear input, or else of the analyser.

    Without either half of the light is across the neuron and half along it, which to a detector
    of both is the same as linear light at 45° to it.
    """
    given = config.polarisation
    if isinstance(given.input, float):
        return given.input
    if given.analyser is not None:
        return given.analyser
    azimuth = next(one.azimuth for one in config.scene.cylinders if one.diameter is None)
    return azimuth + math.pi / 4


def _directed(config: Config, angle: float) -> Overlay:
    given = config.polarisation
    by_analyser = given.analyser is not None and not isinstance(given.input, float)
    # a direction is the same after half a turn
    turned = format_angle(math.remainder(angle, math.pi))
    return nested(f"polarisation.{'analyser' if by_analyser else 'input'}", turned)


def _offset_key(config: Config) -> str:
    return f"{config.scene.swept[0]}.x"


def _end_of_band(name: str, other: str) -> Parameter:
    """Return the parameter of one end of the band, whose samples stretch with it."""
    key = f"spectrum.wavelength.{name}"

    def overlay(config: Config, value: float) -> Overlay:
        moved = nested(key, format_length(value))
        band, pixels = config.spectrum.wavelength, config.spectrum.pixels
        if not isinstance(pixels, PixelTable):
            return moved
        held = getattr(band, other)
        stretch = (value - held) / (getattr(band, name) - held)
        middles = [format_length(held + stretch * (one - held)) for one in pixels.wavelength]
        return merge(moved, nested("spectrum.pixels", {"wavelength": middles}))

    return keyed(2e-4, lambda _: key)._replace(overlay=overlay)


PARAMETERS: Mapping[str, Parameter] = {
    # of the neuron at rest: its focus goes with it
    "diameter": Parameter(
        2e-3, lambda _: 0.0, _nothing, lambda c: (-0.9 * calibration_diameters(c).start, math.inf)
    ),
    "gap": keyed(1e-3, lambda c: c.scene.swept_gap_key, limits=lambda _: (0.0, math.inf)),
    "glass": index_of(lambda c: c.scene.objective_medium, limits=_glass_limits),
    "water": index_of(lambda c: c.scene.host_medium, limits=_water_limits),
    "neuron": index_of(lambda c: c.scene.swept_medium),
    "focus": Parameter(4e-3, lambda _: 0.0, _nothing),
    "numerical_aperture": keyed(
        3e-3, lambda _: "objective.numerical_aperture", limits=_aperture_limits, unit="1"
    ),
    "detector_radius": Parameter(
        1e-3, lambda config: detector_of(config).radius, _core,
        counts=lambda config: "detector" in scheme_of(config).instrument,
    ),
    "fill": Parameter(
        0.01, lambda _: 1.0, _filled, lambda _: (0.05, 20.0), counts=_is_filled, unit="1"
    ),
    "polarisation": Parameter(
        0.04, _direction, _directed, counts=_is_polarised, unit="rad"
    ),
    "offset": keyed(0.01, _offset_key, counts=_can(Ability.OFF_AXIS)),
    "wavelength_min": _end_of_band("min", "max"),
    "wavelength_max": _end_of_band("max", "min"),
}  # fmt: skip
"""Each by the name of its tolerance."""


def parameter_named(name: str) -> Parameter:
    """Return the parameter of a tolerance: a row of the table, or a number of the scene."""
    return PARAMETERS[name] if name in PARAMETERS else scene_parameter(name)


def parameters_of(config: Config) -> Mapping[str, Parameter]:
    """Return the parameters that the scheme of a config sees, by the names of their tolerances."""
    every = {name: parameter_named(name) for name in config.calibration.tolerances.of}
    return {name: one for name, one in every.items() if one.counts(config)}
