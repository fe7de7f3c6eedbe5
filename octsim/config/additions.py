"""What a config's scene has beside the thesis's: more takes more time."""

from itertools import pairwise

from octsim.base.remembered import remembered
from octsim.config.scene import CylinderConfig, Layer, RefractiveIndex, SceneConfig, host_of
from octsim.schemes.cost import Additions


def additions_to(scene: SceneConfig) -> Additions:
    """Return what a scene has beside one cylinder over one plane."""
    return _additions(scene.layers, scene.cylinders, scene.refractive_index)


@remembered
def _additions(
    layers: tuple[Layer, ...], cylinders: tuple[CylinderConfig, ...], indices: RefractiveIndex
) -> Additions:
    if not cylinders:
        return Additions()
    positions = [one.x for one in cylinders]
    host = layers[host_of(layers)]
    bodies = [inwards(host.medium, one) for one in cylinders]
    return Additions(
        surfaces=_more_surfaces([layer.medium for layer in layers], bodies, indices),
        neighbours=len(cylinders) - 1,
        apart=max(positions) - min(positions),
        cover=host.thickness if isinstance(host.thickness, float) else 0.0,
        aside=any(positions),
        tilted=any(one.elevation for one in cylinders),
    )


def inwards(host: str, cylinder: CylinderConfig) -> list[str]:
    """Return the media from around a cylinder, the host's, to within it."""
    return [host, *(shell.medium for shell in cylinder.shells), cylinder.medium]


def _more_surfaces(layers: list[str], bodies: list[list[str]], indices: RefractiveIndex) -> int:
    """Return how many planes and walls there are on a way that the thesis's scene does not have.

    Without contrast they split nothing.
    """

    def contrasts(media: list[str]) -> int:
        index = indices.of
        return sum(index[one] != index[other] for one, other in pairwise(media))

    return max(0, contrasts(layers) - 1 + max(map(contrasts, bodies)) - 1)
