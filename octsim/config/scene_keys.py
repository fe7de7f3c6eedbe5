"""The numbers that a scene is made of: their dotted keys, their units, and what they are."""

import difflib
import re
from collections.abc import Iterator, Mapping

from octsim.config.dispersion import material_of
from octsim.config.models import Config
from octsim.config.units import ANGLE, ATTENUATION, LENGTH, Quantity

_KINDS: Mapping[str, Quantity] = {
    "gap": LENGTH, "x": LENGTH, "diameter": LENGTH, "thickness": LENGTH,
    "azimuth": ANGLE, "elevation": ANGLE,
}  # fmt: skip
"""By the last part of a key."""
_INDICES, _ATTENUATIONS = "scene.refractive_index.", "scene.attenuation."


def quantity_of(key: str) -> Quantity | None:
    """Return what a numeric key of a scene is; None of a plain number, an index."""
    if key.startswith(_INDICES):
        return None
    return ATTENUATION if key.startswith(_ATTENUATIONS) else _KINDS[key.rpartition(".")[2]]


def scene_values(config: Config) -> Mapping[str, float]:
    """Return every number of a plain config's scene by its dotted key: µm, rad, 1/µm or an index.

    Of a dispersive medium that is its index in the middle of the band. A cylinder that gives no gap
    has the scene's, and what is swept has no size.
    """
    return dict(_values(config))


def _values(config: Config) -> Iterator[tuple[str, float]]:
    scene = config.scene
    if any(cylinder.gap is None for cylinder in scene.cylinders):
        yield "scene.gap", scene.gap
    for place, layer in enumerate(scene.layers):
        if isinstance(layer.thickness, float):
            yield f"scene.layers.{place}.thickness", layer.thickness
    for place, cylinder in enumerate(scene.cylinders):
        key = f"scene.cylinders.{place}"
        if cylinder.diameter is not None:
            yield f"{key}.diameter", cylinder.diameter
        yield f"{key}.gap", scene.gap_of(cylinder)
        for name in ("x", "azimuth", "elevation"):
            yield f"{key}.{name}", getattr(cylinder, name)
        for depth, shell in enumerate(cylinder.shells):
            yield f"{key}.shells.{depth}.thickness", shell.thickness
    for medium in dict.fromkeys(config.media.values()):
        index = scene.refractive_index.given[medium]
        yield f"{_INDICES}{medium}", material_of(index).index(config.spectrum.middle).real
    for medium, attenuation in scene.attenuation.of.items():
        yield f"{_ATTENUATIONS}{medium}", attenuation


def named_tolerances(config: Config) -> Mapping[str, str]:
    """Return the tolerances of `Tolerances` that are of the scene, by the dotted keys they are of.

    A key that stands for two of them is of the first.
    """
    scene = config.scene
    if not scene.swept:
        return {}
    swept = scene.swept[0]
    cylinder = swept.startswith("scene.cylinders")
    found = {f"{swept}.{'diameter' if cylinder else 'thickness'}": "diameter"}
    if cylinder:
        found |= {scene.swept_gap_key: "gap", f"{swept}.gap": "gap", f"{swept}.x": "offset"}
    for name, medium in (
        ("glass", scene.objective_medium), ("water", scene.host_medium),
        ("neuron", scene.swept_medium),
    ):  # fmt: skip
        found.setdefault(f"{_INDICES}{medium}", name)
    return found


def wrong_tolerances(config: Config) -> Iterator[str]:
    """Say, a line each, which of ``calibration.tolerances`` are of no number of the scene.

    And which have another's unit, or are of what a named tolerance stands for already.
    """
    known, named = scene_values(config), named_tolerances(config)
    for key, given in config.calibration.tolerances.of_scene.items():
        place = f"calibration.tolerances.{key}"
        if key in named:
            yield (
                f"{place}: {given} given, but that is what calibration.tolerances.{named[key]} is "
                "of; give that one instead"
            )
        elif key not in known:
            nearest = difflib.get_close_matches(key, [*known, *named], n=1, cutoff=0)[0]
            yield (
                f"{place}: {given} given, but {key} is no number of this scene; the nearest that "
                f"is one is {nearest}"
                + (f", of which {named[nearest]} is the tolerance" if nearest in named else "")
            )
        elif (wanted := quantity_of(key)) is None and isinstance(given, str):
            yield f"{place}: {given} given, which is no index; write a number, such as 0.005"
        elif wanted and not (isinstance(given, str) and given.endswith(f" {wanted.unit}")):
            yield f"{place}: {given} given, which is not {wanted.noun}; {wanted.remedy}"


def variable_name(key: str) -> str:
    """Return the name of variables of a dotted key: letters, digits and underscores.

    Examples
    --------
    >>> variable_name("scene.cylinders.0.shells.0.thickness")
    'scene_cylinders_0_shells_0_thickness'
    """
    return re.sub(r"\W", "_", key)
