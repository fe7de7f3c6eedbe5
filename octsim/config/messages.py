"""What is wrong with a config, said in one clear line for each problem."""

import difflib
import re
from collections.abc import Mapping
from typing import Any

from pydantic_core import ErrorDetails

from octsim.config.calibration import Tolerances
from octsim.config.dispersion import TAGS
from octsim.config.effects import (
    FOCAL_SHIFT_FORM,
    REFERENCE_FORM,
    zernike_name,
)
from octsim.config.fields import as_text
from octsim.config.known_keys import known_keys, of_any_entry
from octsim.config.light import PUPIL_FORM
from octsim.config.models import FIXED, Config
from octsim.config.nearest import nearest_key, nearest_value
from octsim.config.units import ANGLE, ATTENUATION, LENGTH
from octsim.config.wording import message_of

_FORMS = {"objective.focal_shift": FOCAL_SHIFT_FORM, "interferometer.reference": REFERENCE_FORM}
"""What stands there, where it is no mapping or unknown."""

_OF_DISPERSIONS = (
    "cauchy", "sellmeier", "table", "unit", "B", "C", "wavelength", "n", "kappa",
)  # fmt: skip
_DECIMAL_COMMA = re.compile(r"\s*[-+]?[0-9]+,[0-9]+\s*")
_LONGEST = 300
_OF_TWO_KINDS = (
    ["sweep", "focus"],
    ["processing", "window"],
    ["processing", "depth"],
    ["expansion", "drift"],
    ["objective", "pupil"],
    ["spectrum", "source"],
    ["measured", "axis"],
    ["measured", "dark"],
    ["measured", "reference"],
    ["measured", "dispersion"],
    ["focus_law", "diameters"],
    ["sweep", "diameters"],
    ["calibration", "diameters"],
)
_LISTS = (
    "processing.window", "scene.layers", "scene.cylinders", "scene.cylinders.shells",
    "design.fills", "design.apertures", "design.bands",
    "focus_law.diameters", "sweep.diameters", "calibration.diameters",
)  # fmt: skip


def explain(error: ErrorDetails) -> str:
    """Return in one line which key is wrong, what was given, and what to do."""
    place = [str(part) for part in error["loc"]]
    if place[:2] in _OF_TWO_KINDS:
        del place[2:3]  # which of the two it was read as
    of_index = place[:2] == ["scene", "refractive_index"]
    if of_index and len(place) > 3 and place[3] in TAGS:
        del place[3]
    path = ".".join(place)
    entry = of_any_entry(path)
    listed = isinstance(error["input"], list | tuple) and error["type"] != "model_type"
    varies = listed and place[0] not in FIXED  # of which a run has one
    key = next((name for name in (place[-1], path) if name in set(known_keys())), None)
    if varies and key and entry not in _LISTS:
        return (
            f"{path}: {_shown(error['input'])} given; several values of one key stand in the grid: "
            f"write grid: {{{key}: [...]}}"
        )
    if "." in place[-1] and error["type"] == "extra_forbidden":
        return f"{path}: unknown key; keys nest, so write {place[-1].replace('.', ': {')}: ...}}"
    if error["type"] == "extra_forbidden" and of_index:
        nearest = difflib.get_close_matches(place[-1], _OF_DISPERSIONS, n=1, cutoff=0)[0]
        return f"{path}: unknown key; the nearest that a dispersion has is {nearest}"
    if error["type"] == "extra_forbidden":
        return f"{path}: unknown key; the nearest known one is {nearest_key(entry)}"
    of_tolerance = place[:2] == ["calibration", "tolerances"] and len(place) == 3
    if of_tolerance and not (place[2] in Tolerances.model_fields or place[2].startswith("scene.")):
        # whatever else is wrong with it, its value too
        remedy = f"the nearest known one is {nearest_key(entry)}"
        if path == "calibration.tolerances.scene":
            remedy = "keys of the scene don't nest here, so write scene.cylinders.0.x: 50 nm"
        return f"{path}: unknown key; {remedy}"
    if error["type"] == "missing":
        return f"{path}: missing; it has no default, so give it a value"
    if error["type"] == "invalid_key":
        section = f"{'.'.join(place[:-1])}: " if place[1:] else ""
        return f"{section}{place[-1]} given as a key; keys are names, such as scene"
    message = message_of(error)
    if path == "run":
        message = (
            "it should be a plain name as text: letters, digits, '.', '_' and '-', no path, 100 at "
            "most"
        )
        if not isinstance(error["input"], str | list | dict):
            # snakemake reads the command line's 2024_06_01 as a number, quoted or not
            message += (
                "; put it in quotes in a config file, or write --config 'run=!!str NAME' on the "
                "command line, which takes quotes away"
            )
    elif path.startswith("expansion.drift"):
        message = (
            "it should be 'none', 'linear' or {reference: [[first, last], ...]}, the first and the "
            "last sample of each time at rest, counted from 1"
        )
    elif path.startswith("expansion.fit.") and error["type"] == "string_pattern_mismatch":
        message = "it should be diameter, gap, index, thickness or, of a second shell, thickness_2"
    elif path in _FORMS and error["type"] == "model_type":
        message = _FORMS[path]
    elif error["type"] in {"model_type", "model_attributes_type"} and f"{path}.num" in known_keys():
        listed_too = ", or a list" if entry in _LISTS else ", as it is evenly spaced"
        message = f"it should be {{start, stop, num}} or {{start, stop, step}}{listed_too}"
    elif error["type"] in {"model_type", "model_attributes_type"}:
        message = "it should be a mapping of keys to values"
    elif path == "objective.pupil" and error["type"] != "value_error":
        message = PUPIL_FORM
    elif error["type"] == "string_pattern_mismatch" and path.startswith("scene."):
        message = "it should be a plain name: letters, digits, '_' and '-', a letter first"
    elif path == "sweep.focus":
        message = (
            "it should be 'law', or {slope: 0.581, intercept: 69 nm}; slope 0 is a fixed focus"
        )
    elif error["type"] == "literal_error" and isinstance(error["input"], str):
        known = re.findall(r"'([^']+)'", message)
        nearest = nearest_value(error["input"], known)
        message = f"the nearest that is known is '{nearest}'; {message}"
    elif error["type"] in {"int_type", "float_type"} and isinstance(error["input"], str):
        whole = " whole" if error["type"] == "int_type" else ""
        message = (
            f"it should be a{whole} number, written out as digits and without quotes, in a config "
            "file: in braces on the command line it is text"
        )
        if _DECIMAL_COMMA.fullmatch(error["input"]):
            message = f"write it with a point, as {error['input'].strip().replace(',', '.')}"
    elif error["type"] == "int_type":
        message = "it should be a whole number, written out as digits"
    elif error["type"] in {"greater_than_equal", "less_than_equal"} and unit_of(path) != "1":
        message += f" {unit_of(path).removeprefix('1')}"
    named = ""
    if entry == "objective.zernike" and place[-1].isdecimal():
        named = f" ({name})" if (name := zernike_name(int(place[-1]))) else ""
    return f"{path}: {_shown(error['input'])} given{named}; {message}"


def _shown(value: object) -> str:
    """Write what was given; of a long table its start."""
    text = repr(value) if isinstance(value, str) else as_text(_start(value, [_LONGEST]))
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]} …"


def _start(value: Any, left: list[int]) -> Any:
    """Return as much of lists and mappings as may be shown, as writing all of them takes long."""
    if not isinstance(value, Mapping | list | tuple):
        return value
    parts: list[Any] = []
    for part in value.items() if isinstance(value, Mapping) else value:
        if left[0] < 0:
            break
        left[0] -= 1
        key, inner = part if isinstance(value, Mapping) else (None, part)
        parts.append((key, _start(inner, left)))
    return dict(parts) if isinstance(value, Mapping) else [inner for _, inner in parts]


def unit_of(key: str) -> str:
    """Return the unit of a key of the config: um of a length, rad of an angle, else 1."""
    entry = of_any_entry(key)
    if entry.startswith("scene.attenuation."):
        return ATTENUATION.unit
    if entry in _WITHOUT_DEFAULT:
        return _WITHOUT_DEFAULT[entry]
    value: Any = Config().to_dict()
    for part in entry.split("."):
        value = value[0] if isinstance(value, list) and value else value
        value = value.get(part) if isinstance(value, dict) else None
    unit = value.rpartition(" ")[2] if isinstance(value, str) else ""
    return unit if unit in {LENGTH.unit, ANGLE.unit} else "1"


_WITHOUT_DEFAULT = {
    "sweep.focus.intercept": LENGTH.unit, "objective.pupil.fibre": LENGTH.unit,
    "scene.cylinders.diameter": LENGTH.unit, "scene.cylinders.gap": LENGTH.unit,
    "scene.cylinders.shells.thickness": LENGTH.unit, "scene.layers.thickness": LENGTH.unit,
    "objective.focal_shift.reference": LENGTH.unit, "objective.zernike": LENGTH.unit,
    "interferometer.reference.length": LENGTH.unit, "beam.waist": LENGTH.unit,
    "beam.wavelength": LENGTH.unit, "detector.mode_field_diameter": LENGTH.unit,
    "polarisation.input": ANGLE.unit, "polarisation.analyser": ANGLE.unit,
}  # fmt: skip
