"""What a config's scene has beside the thesis's: more takes more time."""

from itertools import pairwise

from octsim.base.remembered import remembered
from octsim.config.scene import CylinderConfig, SceneConfig
from octsim.schemes.cost import Additions


@remembered
def additions_to(scene: SceneConfig) -> Additions:
    """Return what a scene has beside one cylinder over one plane."""
    if not scene.cylinders:
        return Additions()
    positions = [one.x for one in scene.cylinders]
    room = scene.layers[scene.host].thickness
    return Additions(
        surfaces=_more_surfaces(scene),
        neighbours=len(scene.cylinders) - 1,
        apart=max(positions) - min(positions),
        cover=room if isinstance(room, float) else 0.0,
        aside=any(positions),
        tilted=any(one.elevation for one in scene.cylinders),
    )


def inwards(scene: SceneConfig, cylinder: CylinderConfig) -> list[str]:
    """Return the media from around a cylinder to within it."""
    return [scene.host_medium, *(shell.medium for shell in cylinder.shells), cylinder.medium]


def _more_surfaces(scene: SceneConfig) -> int:
    """Return how many planes and walls there are on a way that the thesis's scene does not have.

    Without contrast they split nothing.
    """

    def contrasts(media: list[str]) -> int:
        index = scene.refractive_index.of
        return sum(index[one] != index[other] for one, other in pairwise(media))

    planes = contrasts([layer.medium for layer in scene.layers])
    walls = (contrasts(inwards(scene, one)) for one in scene.cylinders)
    return max(0, planes - 1 + max(walls) - 1)
