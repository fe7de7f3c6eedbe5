"""In which plane through the optical axis the cylinders of a config are their own mirror image."""

import math

from octsim.config.scene import CylinderConfig, SceneConfig


def mirrored_at(scene: SceneConfig) -> float | None:
    """Return the angle of `octsim.optics.mirror_plane.mirror_azimuth` for a scene, rad."""
    if not any(one.azimuth or one.elevation for one in scene.cylinders):
        return 0.0  # at once, as numpy is not imported to read a config
    from octsim.optics.materials import Constant
    from octsim.optics.mirror_plane import mirror_azimuth
    from octsim.optics.scene import Cylinder, Region, Scene

    host = Region("host", Constant(1.0))
    kinds = list(dict.fromkeys((one.medium, one.shells) for one in scene.cylinders))

    def body(one: CylinderConfig) -> Cylinder:
        # only whether two are of one kind counts; what is swept is like no other
        kind = Region("", Constant(1.0), float(kinds.index((one.medium, one.shells))))
        radius = (one.diameter or 0.0) / 2
        height = scene.gap_of(one) + radius
        return Cylinder("", one.x, height, radius, kind, host, one.azimuth, one.elevation)

    return mirror_azimuth(Scene(host, tuple(map(body, scene.cylinders))))


def directions(scene: SceneConfig) -> str:
    """Return how the cylinders of a scene lie, as a message has it."""

    def direction(one: CylinderConfig) -> str:
        beside = f", x {one.x:g} um" if one.x else ""
        lifted = f", elevation {math.degrees(one.elevation):.6g} deg" if one.elevation else ""
        return f"{one.medium} at azimuth {math.degrees(one.azimuth):.6g} deg{lifted}{beside}"

    return f"[{'; '.join(map(direction, scene.cylinders))}]"
