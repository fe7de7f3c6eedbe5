"""How large the trees of counted rays are in a config's scene, by estimate."""

import functools
from collections.abc import Iterator
from itertools import pairwise

from octsim.config.additions import additions_to, inwards
from octsim.config.models import Config
from octsim.config.scene import SceneConfig
from octsim.schemes.cost import MOST_PIECES, tree_pieces
from octsim.schemes.table import SCHEMES

_THESIS = 11  # intersections
MOST_PATHS = 2**62
"""Light paths that a code has room for, as `octsim.tracing.path_counts` has it."""


def pieces_of_tree(config: Config) -> float | None:
    """Return about how many pieces the tree of a ray has; None where it is the thesis's."""
    tracing, scene = config.tracing, config.scene
    if not SCHEMES[tracing.scheme].counts_rays or not scene.cylinders:
        return None
    surfaces = additions_to(scene).surfaces
    if not surfaces and tracing.max_intersections == _THESIS and not tracing.min_amplitude:
        return None
    return tree_pieces(surfaces, tracing.max_intersections, tracing.min_amplitude)


def paths_by_digits(scene: SceneConfig) -> int:
    """Return the number of surfaces where each meeting is a digit of a path's number; else 0."""
    planes = _changes([layer.medium for layer in scene.layers])
    if not scene.cylinders:
        return planes
    walls = [_changes(inwards(scene.host_medium, one)) for one in scene.cylinders]
    lone = planes == 1 and walls == [1] and not scene.cylinders[0].elevation
    return 2 if lone else 0


def _changes(media: list[str]) -> int:
    return sum(one != other for one, other in pairwise(media))


@functools.cache
def _most_meetings(surfaces: int) -> int:
    return next(n for n in range(64) if (2 * surfaces) ** (n + 1) >= MOST_PATHS)


def impossible_tree(config: Config) -> Iterator[str]:
    """Say if the trees of a point go beyond what can be kept, or their paths beyond numbers."""
    surfaces, given = paths_by_digits(config.scene), config.tracing.max_intersections
    if surfaces and SCHEMES[config.tracing.scheme].light == "rays":
        most = _most_meetings(surfaces)
        if given > most:
            yield (
                f"tracing.max_intersections: {given} given, but the light paths of so many "
                f"meetings with {surfaces} surfaces can't be numbered; give {most} or less"
            )
    pieces, rays = pieces_of_tree(config), config.tracing.rays
    if pieces and pieces * rays > MOST_PIECES:
        yield (
            f"tracing.max_intersections: {config.tracing.max_intersections} given, for which the "
            f"trees of {rays} rays in this scene have about {pieces * rays:.1g} pieces a point, "
            f"beyond {MOST_PIECES:.0g}; give tracing.min_amplitude, as 1e-6, or fewer "
            "intersections or rays"
        )
