"""What was likely meant by a key or a word that is not known."""

import difflib
import re
from collections.abc import Iterable, Mapping

from octsim.config.known_keys import known_keys, of_any_entry
from octsim.config.scene import Layer, Shell

_IN_LISTS = (
    *(f"scene.layers.{name}" for name in Layer.model_fields),
    *(f"scene.cylinders.shells.{name}" for name in Shell.model_fields),
)
"""Keys in lists that may be empty, of any of their entries."""
_ALIASES: Mapping[str, tuple[str, ...]] = {
    "aperture": ("objective.numerical_aperture",),
    "axons": ("scene.cylinders",),
    "band": ("spectrum.wavelength",),
    "bandwidth": ("spectrum.wavelength",),
    "core": ("detector.core_diameter",),
    "count": ("num",),
    "end": ("stop",),
    "estimate": ("processing.estimator",),
    "fft": ("processing.estimator",),
    "fiber": ("detector.core_diameter", "objective.pupil.fibre"),
    "fibre": ("detector.core_diameter", "objective.pupil.fibre"),
    "fibre_core": ("detector.core_diameter",),
    "filling": ("objective.pupil",),
    "from": ("start", "min"),
    "high": ("max", "stop"),
    "immersion": ("objective.immersion",),
    "index": ("scene.refractive_index",),
    "indices": ("scene.refractive_index",),
    "low": ("min", "start"),
    "mag": ("objective.magnification",),
    "max": ("stop",),
    "maximum": ("max", "stop"),
    "method": ("tracing.scheme", "processing.estimator"),
    "mfd": ("detector.mode_field_diameter",),
    "min": ("start",),
    "minimum": ("min", "start"),
    "n": ("num", "scene.refractive_index"),
    "na": ("objective.numerical_aperture",),
    "name": ("run",),
    "neurons": ("scene.cylinders",),
    "number": ("num",),
    "points": ("num", "spectrum.samples"),
    "pupil_fill": ("objective.pupil",),
    "range": ("sweep.diameters",),
    "ray_count": ("tracing.rays",),
    "reflections": ("tracing.max_intersections",),
    "sample": ("scene",),
    "size": ("sweep.diameters",),
    "solver": ("tracing.scheme",),
    "start": ("min",),
    "stop": ("max",),
    "to": ("stop", "max"),
    "wavelengths": ("spectrum.wavelength",),
    "wavenumbers": ("spectrum.samples",),
    "working_distance": ("objective.focus_distance",),
}
"""What keys are called elsewhere: whole paths, or a name in the section where it was tried."""
_LIKE = 0.6
_OF_ANOTHER_SECTION = 0.8
"""Likeness that is asked of a key which is in another section than the one that was tried."""


def nearest_key(key: str) -> str:
    """Return the known key that was most likely meant by another.

    In the section that was tried that is one of another name for it, of its initials, with it for
    a word or its start, or most like it; then the same in all sections; else the most alike.
    """
    section, _, name = key.rpartition(".")
    keys = [*dict.fromkeys(map(of_any_entry, known_keys())), *_IN_LISTS]
    everywhere = {k.rpartition(".")[2]: k for k in reversed(keys)}
    siblings = {k.rpartition(".")[2]: k for k in keys if k.rpartition(".")[0] == section}
    plain = name.lower().replace("-", "_")
    names = _ALIASES.get(plain, ())
    meant = [one for other in names for one in (f"{section}.{other}", other) if one in keys]
    own = [one for one in meant if one.rpartition(".")[0] == section]
    first = own or [siblings[one] for one in _by_words(plain, siblings)]
    first = first or [siblings[one] for one in _alike(plain, siblings, _LIKE)]
    if first:
        return first[0]
    if meant:
        return meant[0]
    least = _OF_ANOTHER_SECTION if siblings and section else _LIKE
    for candidates, likeness in ((everywhere, least), (siblings if section else {}, 0.0)):
        if close := _alike(plain, candidates, likeness):
            return candidates[close[0]]
    return difflib.get_close_matches(key, keys, n=1, cutoff=0)[0]


def _by_words(name: str, known: Iterable[str]) -> list[str]:
    """Return the names whose initials another is, or of which it is a word, or its start."""
    known = list(known)
    if name in known:
        return [name]
    initials = [one for one in known if "".join(word[0] for word in one.split("_")) == name]
    words = [one for one in known if name in one.split("_") or one in name.split("_")]
    starts = [one for one in known if len(name) > 2 and one.startswith(name)]
    return initials or words or starts


def _alike(name: str, known: Iterable[str], likeness: float) -> list[str]:
    return difflib.get_close_matches(name, list(known), n=1, cutoff=likeness)


_VALUES: Mapping[str, str] = {
    "fourier": "fft", "gauss": "gaussian", "hanning": "hann",
    "maxwell": "fullwave", "mie": "fullwave", "mle": "maximum_likelihood",
    "rays": "vogel", "rect": "boxcar", "rectangular": "boxcar", "sunflower": "vogel",
    "tophat": "top_hat", "zero_padding": "zero_padded",
}  # fmt: skip
"""What values of the config are called elsewhere."""


def nearest_value(given: str, known: Iterable[str]) -> str:
    """Return the known word that was most likely meant by another."""
    plain = re.sub(r"[-\s]+", "_", given.strip().lower())
    words = {one.lower(): one for one in known}
    other = _VALUES.get(plain, "")
    if other in words:
        return words[other]
    return words[difflib.get_close_matches(plain, words, n=1, cutoff=0)[0]]
