"""What a run is told at its start: the scene, and conventions that a reader may take otherwise."""

import math
from collections.abc import Iterator

from octsim.config.grid import combinations
from octsim.config.immersion import of_slide
from octsim.config.models import Config, SceneConfig
from octsim.config.scene import CylinderConfig, Layer
from octsim.optics.shipped_materials import SHIPPED
from octsim.schemes.table import SCHEMES

_HANDED = {"left": ("(1, +i)/√2", "positive", "right"), "right": ("(1, −i)/√2", "negative", "left")}


def told(config: Config) -> list[str]:
    """Say, a line each, what a run is of, where it is not the thesis's scene by rays.

    Of a grid that is its first combination.
    """
    first = next(combinations(config)).config
    said = [*_conventions(first)]
    if first.scene != SceneConfig() or SCHEMES[first.tracing.scheme].light == "waves":
        varied = [key for key in config.grid.varied if key.startswith("scene")]
        among = f" (the first of a grid over {', '.join(varied)})" if varied else ""
        said.insert(0, f"scene: {_scene(first)}{among}")
    return said


def _conventions(config: Config) -> Iterator[str]:
    state = config.polarisation.input
    if isinstance(state, str) and state in _HANDED:
        vector, helicity, other = _HANDED[state]
        yield (
            f"polarisation.input: {state} is {vector} with fields e^(−iωt), of {helicity} helicity "
            f"(Hecht); IEEE calls it {other}-handed"
        )
    given, used = config.scene.refractive_index.given, config.media.values()
    for medium in dict.fromkeys(used):
        if isinstance(name := given[medium], str):
            yield f"scene.refractive_index.{medium}: {name} is by {SHIPPED[name].origin}"
    if slide := of_slide(config):
        yield f"objective.immersion: the slide aberrates by {1e3 * slide.rms:.3g} nm rms, once"


def _scene(config: Config) -> str:
    scene = config.scene
    host = f"in {_medium(config, scene.host_medium)}"
    cylinders = [_cylinder(config, place) for place in range(len(scene.cylinders))]
    between = [_layer(config, layer) for layer in scene.layers[1:-1]]
    below, above = _lowest(config), _medium(config, scene.layers[-1].medium)
    if not cylinders:
        return f"{', '.join(between)} between {below} and {above}"
    if not between and config.objective.immersion is None:
        return f"{' and '.join(cylinders)}, {host}"
    return f"{' and '.join(cylinders)}, {host}; layers: {', '.join([below, *between, above])}"


def _medium(config: Config, name: str) -> str:
    material, k = config.scene.refractive_index.of[name], config.spectrum.middle
    n = material.index(k).real
    if not material.dispersive:
        return f"{name} (n {n:g})"
    return f"{name} (n {n:.3f} at {2e3 * math.pi / k:.0f} nm, dispersive)"


def _lowest(config: Config) -> str:
    slide, immersion = config.scene.layers[0], config.objective.immersion
    if immersion is None:
        return _medium(config, slide.medium)
    return f"{_medium(config, immersion)} below {_layer(config, slide)}"


def _layer(config: Config, layer: Layer) -> str:
    thick = f"{layer.thickness:g} um" if isinstance(layer.thickness, float) else "swept thickness"
    return f"{_medium(config, layer.medium)} of {thick}"


def _cylinder(config: Config, place: int) -> str:
    scene = config.scene
    cylinder = scene.cylinders[place]
    below = scene.layers[scene.host - 1].medium
    size = f"{cylinder.diameter:g} um" if cylinder.diameter else "swept diameter"
    if size.startswith("swept") and len(scene.cylinders) > 1:
        size += f" (scene.cylinders.{place})"
    gap = f"{1000 * scene.gap_of(cylinder):g} nm above {_medium(config, below)}"
    words = [f"{_medium(config, cylinder.medium)} of {size}", *_tilts(cylinder), gap]
    words += [
        f"shell of {_medium(config, shell.medium)}, {1000 * shell.thickness:g} nm thick"
        for shell in cylinder.shells
    ]
    return ", ".join(words)


def _tilts(cylinder: CylinderConfig) -> Iterator[str]:
    if cylinder.x:
        yield f"at x = {cylinder.x:g} um"
    for name, angle in (("azimuth", cylinder.azimuth), ("elevation", cylinder.elevation)):
        if angle:
            yield f"{name} {math.degrees(angle):.6g} deg"
