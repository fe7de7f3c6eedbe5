"""Keys that a user gives and a run does not read, as other keys choose something else."""

from collections.abc import Iterator, Mapping
from typing import Any, get_args

from octsim.config.derive import merge
from octsim.config.effects import DetectorConfig
from octsim.config.fields import number
from octsim.config.grid import as_text, combinations, value_at
from octsim.config.immersion import aberration_terms
from octsim.config.known_keys import known_keys
from octsim.config.models import Config
from octsim.config.processing import OPTIONS, Processing, Sinusoid, options_read
from octsim.schemes.table import COUNTED_RAYS, PRESETS, SCHEMES

_CHOICES: Mapping[str, tuple[str, ...]] = {
    "tracing.scheme": tuple(SCHEMES),
    "processing.estimator": get_args(Processing.model_fields["estimator"].annotation),
    "processing.centre": get_args(Processing.model_fields["centre"].annotation),
    "detector.falloff": get_args(DetectorConfig.model_fields["falloff"].annotation),
    "processing.sinusoid.weights": get_args(Sinusoid.model_fields["weights"].annotation),
}
"""Keys that choose which others are read, and their values."""
_PRESET = "tracing.preset"
_OF_FALLOFFS = {"gaussian": "mode_field_diameter", "fibre": "fibre_na"}
"""What falloffs are of, by their names."""
_OPTIONAL = {
    _PRESET,
    *(f"tracing.{name}" for scheme in SCHEMES.values() for name in scheme.options),
    *(f"processing.{name}" for names in OPTIONS.values() for name in names),
    "processing.centre_degree",
    *(f"detector.{name}" for name in _OF_FALLOFFS.values()),
}
"""Keys that some choices read, and others do not."""
_CALIBRATION = ("calibration", "measured", "expansion", "action_potential", "responses")
"""Sections of who asks for a calibration, which has an estimator of its own."""
_WHOLE = (
    "scene", "objective", "detector", "tracing", "spectrum", "focus_scan", "focus_law", "sweep",
    "processing",
)  # fmt: skip
"""Sections of a whole config: config/default.yaml has them, and all that was ever recorded."""


def asked_for(overlay: Mapping[str, Any], before: Mapping[str, Any]) -> dict[str, Any]:
    """Return what an overlay itself asks for: dotted keys and their values.

    Of a whole config that is what differs from what was laid before it and the defaults. What was
    recorded of a run asks for nothing: every key is there, whoever gave it.

    Parameters
    ----------
    overlay, before : mapping
        Plain data, and what was laid before it.
    """
    given = dict(_leaves(overlay))
    if not all(isinstance(overlay.get(section), Mapping) for section in _WHOLE):
        return given
    name, scheme = (overlay["tracing"].get(key) for key in ("preset", "scheme"))
    agree = name is None or PRESETS.get(str(name), {}).get("scheme") == scheme
    if "preset" in overlay["tracing"] and agree and not before:
        return {}
    base = dict(_leaves(merge(Config().to_dict(), before)))
    return {key: value for key, value in given.items() if number(base.get(key)) != number(value)}


def _leaves(data: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Return the values under all dotted keys; a varied key is ``grid.<key>``."""
    for name, value in data.items():
        if isinstance(value, Mapping) and prefix != "grid.":
            yield from _leaves(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def unread(config: Config, asked: Mapping[str, Any]) -> list[str]:
    """Say, a line each, which keys are not read as others are, and what to do.

    Parameters
    ----------
    config : Config
        A checked config.
    asked : mapping
        Dotted keys that a user asks for, and their values.
    """
    chosen = [at.config for at in combinations(config, *_CHOICES, _PRESET)]
    read = {key for one in chosen for key in _read(one)}
    calibrates = any(key.startswith(_CALIBRATION) for key in asked)
    said = []
    for given, value in asked.items():
        key = given.removeprefix("grid.")
        own = {one for one in known_keys() if f"{one}.".startswith(f"{key}.")}
        optional = own & _OPTIONAL
        # of a section that is given in a grid, any part that is read is enough
        if value is None or not optional or own - _OPTIONAL - {key} or optional & read:
            continue
        elsewhere = _elsewhere(config, optional)
        if calibrates and elsewhere.startswith("calibration"):
            continue
        said.append(_line(given, value, chosen, optional, elsewhere))
    return said


def unread_scene(config: Config, asked: Mapping[str, Any]) -> list[str]:
    """Say, a line each, which keys of scene, objective and beam are given in vain.

    Parameters
    ----------
    config : Config
        A checked config.
    asked : mapping
        Dotted keys that a user asks for, and their values.
    """
    varied = (
        "scene.layers", "scene.cylinders", "objective.immersion", "objective.zernike",
        "beam.waist", *_CHOICES, _PRESET,
    )  # fmt: skip
    every = [at.config for at in combinations(config, *varied)]
    used = {medium for one in every for medium in one.media.values()}
    gaps = any(one.gap is None for at in every for one in at.scene.cylinders)
    aplanatic = all(SCHEMES[one.tracing.scheme].light == "waves" for one in every)
    said = []
    for given, value in asked.items():
        key = given.removeprefix("grid.")
        index = key.removeprefix("scene.refractive_index.").split(".")[0]
        if key.startswith("scene.refractive_index.") and index not in used:
            said.append(
                f"{given}: {as_text(value)} given, but nothing in the scene is of {index}; leave "
                "it out, or name it in scene.layers or scene.cylinders"
            )
        if key == "scene.gap" and not gaps:
            why = (
                "each cylinder has a gap of its own; leave one of them out"
                if any(one.scene.cylinders for one in every)
                else "there is no cylinder, so nothing reads it; leave it out"
            )
            said.append(f"{given}: {as_text(value)} given, but {why}")
        needed, off = _NEEDED.get(key, ("", None))
        if needed and value != off and not any(_has(one, needed) for one in every):
            said.append(
                f"{given}: {as_text(value)} given, but {needed} is not, and nothing else reads it; "
                f"leave it out, or give {needed}"
            )
        if key == "objective.apodisation" and value == "none" and aplanatic:
            said.append(
                f"{given}: none is read as not given, and tracing.scheme: "
                f"{every[0].tracing.scheme} is aplanatic of itself; leave it out"
            )
    return said


_NEEDED = {
    "objective.zernike_rays": ("objective.zernike", "normal"),
    "beam.wavelength": ("beam.waist", "each"),
}
"""Keys that are read where another is given, and what they are by default."""


def _has(config: Config, key: str) -> bool:
    return bool(aberration_terms(config) if key == "objective.zernike" else config.beam.waist)


def _line(given: str, value: Any, chosen: list[Config], keys: set[str], elsewhere: str) -> str:
    chooser, reading = next(
        (chooser, reading)
        for chooser, values in _CHOICES.items()
        if (reading := [one for one in values if keys & _read(_with(chosen[0], chooser, one))])
    )
    now = ", ".join(dict.fromkeys(str(value_at(one, chooser)) for one in chosen))
    alone = f" (only {elsewhere} does)" if elsewhere else ""
    preset = chooser == "tracing.scheme" and _PRESET not in keys and chosen[0].tracing.preset
    instead = f" in the place of {_PRESET}" if preset else ""
    return (
        f"{given}: {as_text(value)} given, but {chooser}: {now} does not read it{alone}; leave it "
        f"out, or give {chooser}: {' or '.join(reading)}{instead}"
    )


def _with(config: Config, chooser: str, value: str) -> Config:
    """Return a config, not checked, with one of the choices made."""
    *sections, name = chooser.split(".")
    part: Any = value_at(config, ".".join(sections)).model_copy(update={name: value})
    for depth in range(len(sections) - 1, 0, -1):
        above = value_at(config, ".".join(sections[:depth]))
        part = above.model_copy(update={sections[depth]: part})
    return config.model_copy(update={sections[0]: part})


def _read(config: Config) -> set[str]:
    """Return the keys of choices, of all that there are, that a plain config reads."""
    tracing = config.tracing
    read = {f"tracing.{name}" for name in SCHEMES[tracing.scheme].options}
    if tracing.preset and PRESETS[tracing.preset]["scheme"] == tracing.scheme:
        read.add(_PRESET)
    if config.detector.falloff in _OF_FALLOFFS:
        read.add(f"detector.{_OF_FALLOFFS[config.detector.falloff]}")
    return read | {f"processing.{name}" for name in options_read(config.processing)}


def _elsewhere(config: Config, keys: set[str]) -> str:
    """Return what else reads keys, if anything does."""
    calibrating = config.processing.model_copy(update={"estimator": config.calibration.estimator})
    if keys & {f"processing.{name}" for name in options_read(calibrating)}:
        return f"calibration, by calibration.estimator: {config.calibration.estimator},"
    if keys & {f"tracing.{name}" for name in COUNTED_RAYS.options}:
        return "the focus scan's count of rays"
    return ""
