"""How large the trees of counted rays are in a config's scene, by estimate."""

from collections.abc import Iterator
from itertools import pairwise

from octsim.config.models import Config
from octsim.config.scene import SceneConfig
from octsim.schemes.cost import MOST_PIECES, tree_pieces
from octsim.schemes.table import SCHEMES

_THESIS = 11  # intersections


def pieces_of_tree(config: Config) -> float | None:
    """Return about how many pieces the tree of a ray has; None where it is the thesis's."""
    tracing, scene = config.tracing, config.scene
    if not SCHEMES[tracing.scheme].counts_rays or not scene.cylinders:
        return None
    surfaces = _more_surfaces(scene)
    if not surfaces and tracing.max_intersections == _THESIS and not tracing.min_amplitude:
        return None
    return tree_pieces(surfaces, tracing.max_intersections, tracing.min_amplitude)


def _more_surfaces(scene: SceneConfig) -> int:
    """Return how many planes and walls there are on a way that the thesis's scene does not have.

    Without contrast they split nothing.
    """

    def contrasts(media: list[str]) -> int:
        index = scene.refractive_index.of
        return sum(index[one] != index[other] for one, other in pairwise(media))

    planes = contrasts([layer.medium for layer in scene.layers])
    walls = (
        contrasts([scene.host_medium, *(shell.medium for shell in one.shells), one.medium])
        for one in scene.cylinders
    )
    return max(0, planes - 1 + max(walls) - 1)


def impossible_tree(config: Config) -> Iterator[str]:
    """Say if the trees of a point go beyond what can be kept."""
    pieces, rays = pieces_of_tree(config), config.tracing.rays
    if pieces and pieces * rays > MOST_PIECES:
        yield (
            f"tracing.max_intersections: {config.tracing.max_intersections} given, for which the "
            f"trees of {rays} rays in this scene have about {pieces * rays:.1g} pieces a point, "
            f"beyond {MOST_PIECES:.0g}; give tracing.min_amplitude, as 1e-6, or fewer "
            "intersections or rays"
        )
