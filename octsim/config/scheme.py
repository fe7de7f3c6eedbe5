"""The scheme of a config: its row of the table, its options, and the keys that light depends on."""

from collections.abc import Mapping
from math import log2
from typing import Any

from octsim.config.additions import additions_to
from octsim.config.derive import parts_of
from octsim.config.immersion import immersion_disperses
from octsim.config.light import FibreMode
from octsim.config.models import Config
from octsim.config.tree import pieces_of_tree
from octsim.schemes.cost import SAMPLE_BYTES, SAMPLED, SAMPLED_MEMORY, PointCost, of_tree
from octsim.schemes.table import SCHEMES, Scheme


def scheme_of(config: Config) -> Scheme:
    """Return the scheme that a plain config names."""
    return SCHEMES[config.tracing.scheme]


def options_of(config: Config) -> Mapping[str, Any]:
    """Return the values of the scheme's own options."""
    return scheme_of(config).chosen(config.tracing)


def sampled(config: Config) -> bool:
    """Return whether the light of a plain config is rays with a field at the spectrum's samples.

    Such rays differ from wavenumber to wavenumber, or they have a polarisation.
    """
    weighed = config.detector.falloff == "fibre" or isinstance(config.pupil, FibreMode)
    each = config.polarisation.given or weighed or way_varies(config)
    return scheme_of(config).light == "rays" and each


def way_varies(config: Config) -> bool:
    """Return whether the way of light depends on the wavenumber, in a plain config."""
    beam, shift = config.beam, config.objective.focal_shift
    moves = shift is not None and shift.moves
    return config.dispersive or moves or (beam.waist is not None and beam.wavelength == "each")


def rate_name(config: Config) -> str:
    """Name the points of a plain config: those of a name take about the same."""
    name = scheme_of(config).rate_name(options_of(config))
    if pieces := pieces_of_tree(config):
        name = f"{name} tree {round(log2(pieces))}"
    if (times := scheme_of(config).times(additions_to(config.scene))) != 1:
        name = f"{name} times {2 ** round(log2(times))}"
    if way_varies(config):
        return f"{name} by wavenumber"
    return f"{name} sampled" if sampled(config) else name


def cost_by(
    scheme: Scheme, options: Mapping[str, Any], config: Config, diameter: float
) -> PointCost:
    """Return what a point of a diameter (µm) takes by a scheme in the scene of a config."""
    cost = scheme.cost(options, diameter)
    return cost._replace(seconds=cost.seconds * scheme.times(additions_to(config.scene)))


def point_cost(config: Config) -> PointCost:
    """Return what a point of a plain config takes, by rates measured on one machine."""
    scheme = scheme_of(config)
    cost = cost_by(scheme, options_of(config), config, config.sweep.diameters.stop)
    if pieces := pieces_of_tree(config):
        cost = of_tree(cost, pieces)
    if sampled(config):
        size, memory = SAMPLE_BYTES * config.spectrum.samples, SAMPLED_MEMORY * cost.memory
        cost = cost._replace(size=cost.size + size, memory=memory, summed=0.0)
    times = scheme.by_wavenumber if way_varies(config) else SAMPLED if sampled(config) else 1.0
    return cost._replace(seconds=times * cost.seconds)


def light_keys(config: Config) -> tuple[str, ...]:
    """Return the dotted keys that the light of a point of a plain config depends on."""
    keys = scheme_of(config).keys
    if immersion_disperses(config):
        keys = (*keys, "spectrum.wavelength")
    if not sampled(config):
        return keys
    return tuple(dict.fromkeys((*keys, "polarisation", "spectrum")))


def traced_keys(config: Config) -> Mapping[str, Any]:
    """Return what light depends on as it is traced, by dotted key, as plain data.

    Where rays serve all wavenumbers, what media take is taken from them later: of that it counts
    whether there is any, as the lengths of ways are kept then.
    """
    read = parts_of(config.to_dict(), *light_keys(config))
    scene = read.get("scene")
    if scheme_of(config).light == "waves" or sampled(config) or not isinstance(scene, Mapping):
        return read
    taken = any(config.scene.attenuation.of.values())
    return {**read, "scene": {**scene, "attenuation": taken}}
