"""Scenes of any layers and cylinders, as a config asks for them and as the literal tracer does."""

from typing import Any, NamedTuple

import numpy as np
from effect_cases import MORE, SLOTS
from literal_scene import Scene, Tube

from octsim.config.derive import merge


class SceneCase(NamedTuple):
    """A scene: what it lays over a config, the literal one, and what of the set-up it sets."""

    overlay: dict[str, Any]
    scene: Scene
    literal: dict[str, Any]


MEDIA = {"myelin": 1.44, "membrane": 1.46, "film": 1.4}
NEURON = {"medium": "neuron"}
MYELIN = {"medium": "myelin", "thickness": "100 nm"}
MEMBRANE = {"medium": "membrane", "thickness": "5 nm"}
# one diameter, so that cylinders can be near each other and planes above
FEW = {
    "sweep": {
        "diameters": {"start": "1.3 um", "stop": "1.4 um", "num": 2},
        "focus": {"slope": 0.581, "intercept": "69 nm"},
    },
    "focus_scan": {"diameter": "1.4 um"},
    "focus_law": {"diameters": {"start": "1.3 um", "stop": "1.4 um", "num": 2}},
}
FILM = {"medium": "film", "thickness": "100 nm"}


def tube(**given: Any) -> dict[str, Any]:
    """Return a cylinder as a config has it, of a literal tube's lengths in µm and angles."""
    units = {"elevation": "deg", "azimuth": "deg"}
    shells = given.pop("shells", ())
    plain = {name: f"{value!r} {units.get(name, 'um')}" for name, value in given.items()}
    layers = [{"medium": medium, "thickness": f"{thick!r} um"} for medium, thick in shells]
    return {"medium": "neuron", **plain, **({"shells": layers} if layers else {})}


def case(
    *tubes: dict[str, Any], layers: tuple[tuple[str, float], ...] = (), most: int = 11
) -> SceneCase:
    """Return a scene of tubes, the first of which is swept, in layers (medium, thickness)."""
    stack = layers or (("glass", np.inf), ("water", np.inf))
    used = {medium for one in tubes for medium, _ in one.get("shells", ())}
    used |= {medium for medium, _ in stack}
    media = {name: index for name, index in MEDIA.items() if name in used}
    given = [
        {"medium": medium, "thickness": f"{thick!r} um"} if thick < np.inf else medium
        for medium, thick in stack
    ]
    overlay = {
        **FEW,
        "tracing": {"max_intersections": most},
        "scene": {
            "refractive_index": media,
            "layers": given,
            "cylinders": [tube(**one) for one in tubes],
        },
    }
    water = [place for place, (medium, _) in enumerate(stack) if medium == "water"]
    host = max(water, default=len(stack) - 1)
    scene = Scene(stack, host, tuple(Tube(**one) for one in tubes), media)
    return SceneCase(overlay, scene, {"max_intersections": most})


ONE = {"shells": (("myelin", 0.1),)}
TWO = {"shells": (("membrane", 0.005), ("myelin", 0.1))}
COVERED = (("glass", np.inf), ("water", 5.0), ("glass", np.inf))
STACK = (("glass", np.inf), ("film", 0.1), ("water", 1.6), ("film", 0.3), ("water", np.inf))
LOW = (("glass", np.inf), ("film", 0.1), ("water", 1.5), ("glass", np.inf))
SCENES: dict[str, SceneCase] = {
    "off axis": case({"x": 0.1}),
    "azimuth": case({"azimuth": 10.0}),
    "azimuth, off axis": case({"azimuth": -70.0, "x": 0.1}),
    "azimuth across": case({"azimuth": 90.0}),
    "elevation": case({"elevation": 2.0}),
    "elevation downwards": case({"elevation": -0.5}),
    "steep": case({"elevation": 30.0}),
    "elevation, azimuth, off axis": case({"elevation": 5.0, "azimuth": 30.0, "x": -0.1}),
    "touching": case({"gap": 0.0}),
    "membrane": case({"shells": (("membrane", 0.005),)}),
    "myelin": case(ONE),
    "two shells": case(TWO, most=9),
    "two shells, elevation": case({**TWO, "elevation": 3.0}, most=9),
    "a shell, azimuth": case({**ONE, "azimuth": 20.0}, most=9),
    "a shell of water": case({"shells": (("myelin", 0.1), ("water", 0.1))}, most=9),
    "of the glass's medium": case({"shells": (("glass", 0.1),), "elevation": 0.0}, most=9),
    "neighbours": case({}, {"diameter": 1.0, "x": 1.21, "gap": 0.1}, {"diameter": 1.0, "x": -1.25}),
    "in contact": case({"gap": 0.0}, {"diameter": 1.4, "x": 1.4, "gap": 0.0}),
    "neighbours, turned": case(
        {"azimuth": 5.0},
        {"diameter": 1.0, "x": 1.3, "gap": 0.1, "elevation": 3.0, "azimuth": 5.0},
        {"diameter": 1.0, "x": -1.6, "gap": 0.0, "azimuth": 5.0, **ONE},
        most=9,
    ),
    "cover glass": case({}, layers=COVERED),
    "film": case({}, layers=(("glass", np.inf), ("film", 0.1), ("water", np.inf))),
    "under a film": case({}, layers=(*STACK[:3], ("film", np.inf)), most=9),
    "a slide of two": case({}, layers=(("glass", np.inf), ("glass", 1.0), ("water", np.inf))),
    "in one medium": case({}, layers=(("glass", np.inf), ("glass", np.inf))),
    "between two planes, elevation": case({"elevation": 5.0}, layers=LOW, most=8),
    "everything": case(
        {**TWO, "elevation": 4.0, "azimuth": 10.0, "x": 0.02},
        {"diameter": 1.0, "x": 1.35, "gap": 0.1, "elevation": 4.0, "azimuth": 10.0},
        layers=LOW,
        most=8,
    ),
}  # fmt: skip


def with_effect(name: str, *effects: str) -> SceneCase:
    """Return a scene with effects."""
    found = SCENES[name]
    for effect in effects:
        one = {**SLOTS, **MORE}[effect]
        found = SceneCase(
            merge(found.overlay, one.overlay), found.scene, {**found.literal, **one.literal}
        )
    return found


TURNED = "elevation, azimuth, off axis"
CASES: dict[str, SceneCase] = {
    **SCENES,
    **{f"{TURNED}; {name}": with_effect(TURNED, name) for name in {**SLOTS, **MORE}},
    **{f"everything; {name}": with_effect("everything", name) for name in SLOTS},
    "everything at once": with_effect("everything", *SLOTS),
    "two shells; polarisation, attenuation": with_effect(
        "two shells", "polarisation", "all media attenuate"
    ),
    "cover glass; dispersion, rulings": with_effect("cover glass", "dispersion", "rulings"),
}
"""Scenes, with each effect on two of them, and all at once."""
