"""From a user's overlay to a checked config, or to one clear line for each problem."""

import difflib
import re
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from octsim.config import PRESETS, Config, FocusLine
from octsim.errors import ConfigError, OctsimWarning
from octsim.plates import aliasing_step
from octsim.rounding import rounding_remarks
from octsim.sections import Range
from octsim.units import format_length

STEEP = 0.92
"""Numerical aperture over the index of water, above which the scheme paths can miss light."""


def load_config(*overlays: str | Path | Mapping[str, Any]) -> Config:
    """Lay overlays over the thesis's config and check the result.

    Parameters
    ----------
    *overlays : path or mapping
        YAML or JSON files, or what they would hold; a later one wins. Mappings merge deeply,
        everything else replaces.

    Returns
    -------
    Config
        The whole config, frozen; lengths in µm.

    Raises
    ------
    ConfigError
        If a file can't be read, a key is unknown, or a value has the wrong type, lacks its unit or
        is impossible. Its text has one line for each problem: key path, what was given, what to do.

    Warns
    -----
    OctsimWarning
        If the diameter step is so large that the unwrapped phase is ambiguous.

    Examples
    --------
    >>> load_config({"scene": {"gap": "20 nm"}}).scene.gap
    0.02
    """
    given: dict[str, Any] = {}
    for overlay in overlays:
        given = _merge(given, overlay if isinstance(overlay, Mapping) else _read(Path(overlay)))
    try:
        config = Config.model_validate(_merge(_merge(Config().to_dict(), _preset(given)), given))
    except ValidationError as error:
        raise ConfigError("\n".join(dict.fromkeys(map(_explain, error.errors())))) from None
    problems = list(_impossible(config))
    if problems:
        raise ConfigError("\n".join(problems))
    for remark in remarks(config):
        warnings.warn(remark, OctsimWarning, stacklevel=2)
    return config


def _preset(given: Mapping[str, Any]) -> Mapping[str, Any]:
    """Give what a named preset stands for; keys given beside it go above."""
    tracing = given.get("tracing")
    name = tracing.get("preset") if isinstance(tracing, Mapping) else None
    return {"tracing": PRESETS.get(name, {})} if isinstance(name, str) else {}


class _Loader(yaml.SafeLoader):
    """YAML in which a key may stand only once."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        merge = "tag:yaml.org,2002:merge"  # `<<`, which may well stand beside what it brings
        keys = [self.construct_object(key, True) for key, _ in node.value if key.tag != merge]
        for key in keys:
            if keys.count(key) > 1:
                raise yaml.constructor.ConstructorError(
                    None, None, f"the key '{key}' stands twice", node.start_mark
                )
        return super().construct_mapping(node, deep)


def _read(path: Path) -> Mapping[str, Any]:
    try:
        content = yaml.load(path.read_text(encoding="utf-8"), _Loader)
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise ConfigError(f"{path}: can't be read ({reason}); give a YAML file") from None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        problem = " ".join((error.problem or "not YAML").split())
        raise ConfigError(f"{path}{place}: not as YAML should be: {problem}") from None
    except yaml.YAMLError as error:
        raise ConfigError(f"{path}: not YAML: {' '.join(str(error).split())}") from None
    if content is None:
        return {}
    if not isinstance(content, Mapping):
        raise ConfigError(
            f"{path}: holds a {type(content).__name__}, not keys with values; "
            "write it as in config/default.yaml"
        )
    return content


def _merge(base: Mapping[str, Any], overlay: Mapping[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in overlay.items():
        below = merged.get(key)
        if isinstance(below, Mapping) and isinstance(value, Mapping):
            value = _merge(below, value)
        merged[key] = value
    return merged


def known_keys(model: type[BaseModel] | BaseModel = Config, prefix: str = "") -> Iterator[str]:
    """Give the dotted path of every key of the config, sections before what they hold."""
    model = model() if isinstance(model, type) else model
    for name in type(model).model_fields:
        yield prefix + name
        value = getattr(model, name)
        if isinstance(value, BaseModel):
            yield from known_keys(value, f"{prefix}{name}.")
    if isinstance(model, Config):
        yield from (f"sweep.focus.{name}" for name in FocusLine.model_fields)


def nearest_key(key: str) -> str:
    """Give the known key that is most like `key`: in its own section, else by its last part."""
    section, _, name = key.rpartition(".")
    keys = list(known_keys())
    siblings = {k.rpartition(".")[2]: k for k in keys if k.rpartition(".")[0] == section}
    everywhere = {k.rpartition(".")[2]: k for k in reversed(keys)}
    initials = {"".join(word[0] for word in k.split("_")): path for k, path in siblings.items()}
    for candidates, likeness in ((initials, 1), (siblings, 0.6), (everywhere, 0.6), (siblings, 0)):
        close = difflib.get_close_matches(name, candidates, n=1, cutoff=likeness)
        if close:
            return candidates[close[0]]
    return difflib.get_close_matches(key, keys, n=1, cutoff=0)[0]


def _explain(error: ErrorDetails) -> str:
    place = [str(part) for part in error["loc"]]
    if place[:2] == ["sweep", "focus"]:
        del place[2:3]  # which of the two kinds it was read as
    path = ".".join(place)
    if "." in place[-1] and error["type"] == "extra_forbidden":
        return f"{path}: unknown key; keys nest, so write {place[-1].replace('.', ': {')}: ...}}"
    if error["type"] == "extra_forbidden":
        return f"{path}: unknown key; the nearest known one is {nearest_key(path)}"
    if error["type"] == "missing":
        return f"{path}: missing; it has no default, so give it a value"
    message = error["msg"].removeprefix("Value error, ").replace("Input should", "it should")
    if path == "run":
        message = "it should be a plain name as text: letters, digits, '.', '_' and '-', no path"
        if not isinstance(error["input"], str):
            message += "; put it in quotes"
    elif error["type"] in {"model_type", "model_attributes_type"}:
        message = "it should be a mapping of keys to values"
    elif path == "sweep.focus":
        message = (
            "it should be 'law', or {slope: 0.581, intercept: 69 nm}; slope 0 is a fixed focus"
        )
    elif error["type"] == "literal_error" and isinstance(error["input"], str):
        known = re.findall(r"'([^']+)'", message)
        nearest = difflib.get_close_matches(error["input"], known, n=1, cutoff=0)[0]
        message = f"the nearest that is known is '{nearest}'; {message}"
    elif error["type"] == "int_type":
        message = "it should be a whole number, written out as digits"
    elif error["type"] in {"greater_than_equal", "less_than_equal"} and _is_length(path):
        message += " um"
    return f"{path}: {error['input']!r} given; {message}"


def _is_length(path: str) -> bool:
    value: Any = Config().to_dict()
    for part in path.split("."):
        value = value.get(part) if isinstance(value, dict) else None
    return isinstance(value, str) and value.endswith(" um")


def _ranges(model: BaseModel, prefix: str = "") -> Iterator[tuple[str, Range]]:
    for name in type(model).model_fields:
        value = getattr(model, name)
        if isinstance(value, Range):
            yield prefix + name, value
        elif isinstance(value, BaseModel):
            yield from _ranges(value, f"{prefix}{name}.")


def highest_focus(config: Config) -> tuple[str, float]:
    """Give the key that asks for the highest focus known before a run, and that focus in µm."""
    law = config.focus_law
    # corners suffice: a product of two ranges is greatest at one
    law_foci = np.outer(
        [law.diameters.start, law.diameters.stop], [law.fraction.start, law.fraction.stop]
    )
    foci = {
        "focus_scan.focus.stop": config.focus_scan.focus.stop,
        "focus_law.fraction.stop": float(law_foci.max()),
    }
    if isinstance(config.sweep.focus, FocusLine):
        ends = np.array([config.sweep.diameters.start, config.sweep.diameters.stop])
        foci["sweep.focus"] = float(config.sweep.focus.at(ends).max())
    return max(foci.items(), key=lambda item: item[1])


def _impossible(config: Config) -> Iterator[str]:
    aperture, glass = config.objective.numerical_aperture, config.scene.refractive_index.glass
    if not aperture < glass:
        yield (
            f"objective.numerical_aperture: {aperture} given; it must be below the index of glass, "
            f"scene.refractive_index.glass = {glass}"
        )
    band = config.spectrum.wavelength
    if not band.min < band.max:
        yield (
            f"spectrum.wavelength.min: {format_length(band.min)} given; it must be below "
            f"spectrum.wavelength.max = {format_length(band.max)}"
        )
    for key, span in _ranges(config):
        if not span.start < span.stop:
            given = span.model_dump(mode="json")
            yield (
                f"{key}.start: {given['start']} given; it must be below {key}.stop = "
                f"{given['stop']}"
            )
    key, focus = highest_focus(config)
    distance = config.objective.focus_distance
    if not distance > focus:
        yield (
            f"objective.focus_distance: {format_length(distance)} given; it must exceed every "
            f"focus, and {key} asks for one at {format_length(focus)} (the objective lies in glass)"
        )


def _steep_remarks(config: Config) -> Iterator[str]:
    aperture, water = config.objective.numerical_aperture, config.scene.refractive_index.water
    if config.tracing.scheme == "paths" and STEEP * water < aperture:
        yield (
            f"tracing.scheme: 'paths' with a numerical aperture of {aperture}, above {STEEP} of "
            f"the index of water, {water}: light near grazing incidence can be missed, and the "
            "error with it; compare with 'vogel'"
        )


def remarks(config: Config) -> list[str]:
    """Say what is possible but likely not meant, a line each."""
    said = list(_steep_remarks(config))
    band, diameters = config.spectrum.wavelength, config.sweep.diameters
    n_neuron = config.scene.refractive_index.neuron
    k_min, k_max = 2 * np.pi / band.max, 2 * np.pi / band.min
    step = (diameters.stop - diameters.start) / (diameters.num - 1)
    largest = aliasing_step(n_neuron, k_min, k_max)
    if step > largest:
        said.append(
            f"sweep.diameters: a step of {step:.6g} um is above π/(n_neuron (k_min + k_max)) = "
            f"{largest:.6g} um, so the unwrapped phase is ambiguous and its slope can be wrong; "
            "raise sweep.diameters.num"
        )
    oscillations = n_neuron * (k_max - k_min) / np.pi  # of cos(2ndk) over the band, per µm
    if oscillations * diameters.start < 1:
        said.append(
            f"sweep.diameters.start: {format_length(diameters.start)} is less than one oscillation "
            f"of the spectrum, {1 / oscillations:.3g} um, so its phase means little; raise it or "
            "widen spectrum.wavelength"
        )
    needed = int(np.ceil(2 * oscillations * diameters.stop)) + 1
    if config.spectrum.samples < needed:
        said.append(
            f"spectrum.samples: {config.spectrum.samples} do not resolve the oscillations of the "
            f"largest diameter; give {needed} or more"
        )
    fitted = config.focus_law.diameters
    beyond = diameters.start < fitted.start or diameters.stop > fitted.stop
    if config.sweep.focus == "law" and beyond:
        said.append(
            f"sweep.diameters: from {format_length(diameters.start)} to "
            f"{format_length(diameters.stop)} is beyond the diameters that the focus law is fitted "
            f"to, {format_length(fitted.start)} to {format_length(fitted.stop)}; widen "
            "focus_law.diameters"
        )
    return said + rounding_remarks(config)
