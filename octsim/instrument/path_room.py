"""How many meetings light paths of a config's scene may have, so that each has a number."""

from octsim.config.following import scan_diameter
from octsim.config.models import Config
from octsim.instrument.build import scene_of
from octsim.tracing.faces import most_meetings


def most_intersections(config: Config) -> int:
    """Return the largest ``max_intersections`` that a plain config's scene can be traced with."""
    scene = scene_of(config, scan_diameter(config))
    return most_meetings(scene) - scene.unseen_meetings
