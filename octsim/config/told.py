"""What a run is told at its start: the scene, and conventions that a reader may take otherwise."""

import math
from collections.abc import Iterator

from octsim.config.grid import combinations
from octsim.config.models import Config, SceneConfig
from octsim.config.scene import CylinderConfig, Layer
from octsim.schemes.table import SCHEMES

_HANDED = {"left": ("(1, +i)/√2", "positive", "right"), "right": ("(1, −i)/√2", "negative", "left")}


def told(config: Config) -> list[str]:
    """Say, a line each, what a run is of, where it is not the thesis's scene by rays.

    Of a grid that is its first combination.
    """
    first = next(combinations(config)).config
    said = [*_conventions(first)]
    if first.scene != SceneConfig() or SCHEMES[first.tracing.scheme].honours:
        varied = [key for key in config.grid.varied if key.startswith("scene")]
        among = f" (the first of a grid over {', '.join(varied)})" if varied else ""
        said.insert(0, f"scene: {_scene(first.scene)}{among}")
    return said


def _conventions(config: Config) -> Iterator[str]:
    state = config.polarisation.input
    if isinstance(state, str) and state in _HANDED:
        vector, helicity, other = _HANDED[state]
        yield (
            f"polarisation.input: {state} is {vector} with fields e^(−iωt), of {helicity} helicity "
            f"(Hecht); IEEE calls it {other}-handed"
        )


def _scene(scene: SceneConfig) -> str:
    host = f"in {_medium(scene, scene.host_medium)}"
    cylinders = [_cylinder(scene, place) for place in range(len(scene.cylinders))]
    between = [_layer(scene, layer) for layer in scene.layers[1:-1]]
    below, above = (_medium(scene, scene.layers[place].medium) for place in (0, -1))
    if not cylinders:
        return f"{', '.join(between)} between {below} and {above}"
    if not between:
        return f"{' and '.join(cylinders)}, {host}"
    return f"{' and '.join(cylinders)}, {host}; layers: {', '.join([below, *between, above])}"


def _medium(scene: SceneConfig, name: str) -> str:
    return f"{name} (n {scene.refractive_index.of[name]:g})"


def _layer(scene: SceneConfig, layer: Layer) -> str:
    thick = f"{layer.thickness:g} um" if isinstance(layer.thickness, float) else "swept thickness"
    return f"{_medium(scene, layer.medium)} of {thick}"


def _cylinder(scene: SceneConfig, place: int) -> str:
    cylinder = scene.cylinders[place]
    below = scene.layers[scene.host - 1].medium
    size = f"{cylinder.diameter:g} um" if cylinder.diameter else "swept diameter"
    if size.startswith("swept") and len(scene.cylinders) > 1:
        size += f" (scene.cylinders.{place})"
    gap = f"{1000 * scene.gap_of(cylinder):g} nm above {_medium(scene, below)}"
    words = [f"{_medium(scene, cylinder.medium)} of {size}", *_tilts(cylinder), gap]
    words += [
        f"shell of {_medium(scene, shell.medium)}, {1000 * shell.thickness:g} nm thick"
        for shell in cylinder.shells
    ]
    return ", ".join(words)


def _tilts(cylinder: CylinderConfig) -> Iterator[str]:
    if cylinder.x:
        yield f"at x = {cylinder.x:g} um"
    for name, angle in (("azimuth", cylinder.azimuth), ("elevation", cylinder.elevation)):
        if angle:
            yield f"{name} {math.degrees(angle):.6g} deg"
