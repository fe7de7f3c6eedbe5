"""Effects that a config has already, and what switches them off."""

from collections.abc import Mapping

from octsim.config.derive import merge, nested
from octsim.config.models import Config
from octsim.config.units import format_length
from octsim.studies.effects.overlays import Overlay


def is_on(config: Config, kind: str) -> bool:
    """Return whether a config already has an effect of a kind."""
    objective, scene = config.objective, config.scene
    shift = objective.focal_shift
    swept = next((one for one in scene.cylinders if one.diameter is None), None)
    on = {
        "dispersion": config.dispersive,
        "attenuation": any(scene.attenuation.of.values()),
        "polarisation": config.polarisation.given,
        "zernike": bool(objective.zernike.of),
        "immersion": objective.immersion is not None,
        "focal shift": shift is not None and shift.moves,
        "pupil": objective.pupil not in (None, "uniform"),
        "apodisation": objective.apodisation is not None,
        "falloff": config.detector.falloff != "parabolic",
        "rulings": config.beam.waist is not None,
        "scene": len(scene.layers) > 2
        or len(scene.cylinders) > 1
        or (
            swept is not None and bool(swept.x or swept.azimuth or swept.elevation or swept.shells)
        ),
    }
    return on.get(kind, False)


def without(config: Config, kind: str) -> Overlay:
    """Return what switches all effects of a kind off that a config has."""
    scene, k = config.scene, config.spectrum.middle
    of = scene.refractive_index.of
    indices = {name: of[name].index(k).real for name in scene.media.values() if of[name].dispersive}
    layers = config.to_dict()["scene"]["layers"]
    off: Mapping[str, Overlay] = {
        "dispersion": nested("scene.refractive_index", indices),
        "attenuation": nested("scene.attenuation", dict.fromkeys(scene.attenuation.of, "0 /um")),
        "polarisation": nested("polarisation", {"input": None, "analyser": None}),
        "zernike": nested(
            "objective.zernike", {str(one): "0 nm" for one in config.objective.zernike.of}
        ),
        "immersion": merge(
            nested("objective.immersion", None),
            nested("scene.layers", [scene.objective_medium, *layers[1:]]),
        ),
        "focal shift": nested("objective.focal_shift", None),
        "pupil": nested("objective.pupil", None),
        "apodisation": nested("objective.apodisation", None),
        "falloff": nested("detector.falloff", "parabolic"),
        "rulings": nested("beam.waist", None),
        "scene": merge(
            nested("scene.layers", [layers[0], scene.host_medium]),
            _alone(config),
        ),
    }
    return off[kind]


def _alone(config: Config) -> Overlay:
    """Leave of a config's cylinders the one that is swept, level on the axis, without shells."""
    found = [
        {"medium": one.medium, **({} if one.gap is None else {"gap": format_length(one.gap)})}
        for one in config.scene.cylinders
        if one.diameter is None
    ]
    return nested("scene.cylinders", found) if found else {}
