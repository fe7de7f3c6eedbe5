"""Random configs whose runs take seconds, and what is asked for of each."""

from random import Random
from typing import Any, NamedTuple

from octsim.base.errors import ConfigError
from octsim.config.load import load_and_tell

_LIGHT: tuple[dict[str, Any], ...] = (
    *({"scheme": "vogel", "rays": rays} for rays in (60, 150, 300)),
    *({"scheme": "paths", "accuracy": accuracy} for accuracy in (1e-2, 1e-3, 1e-4)),
    *({"scheme": "fullwave", "accuracy": accuracy} for accuracy in (1e-2, 1e-3)),
)
_PARTS: tuple[dict[str, Any], ...] = (
    {},
    {"polarisation": {"input": "left"}},
    {"interferometer": {"reference": {"amplitude": 0.004, "length": "9 um"}}},
    {"detector": {"falloff": "gaussian"}},
    {"spectrum": {"source": {"gaussian": {"centre": "770 nm", "fwhm": "60 nm"}}}},
    {"scene": {"attenuation": {"neuron": "100 /cm"}}},
    {"processing": {"estimator": "sinusoid"}},
)
_VARIED: dict[str, list[Any]] = {
    "scene.gap": ["5 nm", "20 nm", "60 nm"],
    "detector.core_diameter": ["3.5 um", "4.4 um"],
    "objective.numerical_aperture": [1.1, 1.2],
    "processing.window": ["hann", "hamming"],
    "spectrum.samples": [64, 96],
    "sweep.diameters.num": [3, 5],
    "sweep.focus": [
        {"slope": 0.58, "intercept": "69 nm"}, {"slope": 0, "intercept": "0.6 um"},
    ],
}  # fmt: skip
_WHOLE = 0.1  # of the runs; the others leave out focus scan, focus law and figures


class Drawn(NamedTuple):
    """A config that was drawn."""

    overlay: dict[str, Any]
    targets: tuple[str, ...]
    """What is asked for; nothing of the whole run."""

    @property
    def scattered(self) -> bool:
        """Whether its stages are cut into as many jobs as can be."""
        return "scatter" in self.overlay


def drawn(draw: Random) -> Drawn:
    """Draw a config that octsim takes: schemes, a grid, scattered stages, and now and then all."""
    while True:
        one = _drawn(draw)
        try:
            load_and_tell(one.overlay)
        except ConfigError:  # not every scheme can do every part
            continue
        return one


def _drawn(draw: Random) -> Drawn:
    whole = draw.random() < _WHOLE
    light = draw.choice(_LIGHT)
    overlay: dict[str, Any] = {
        "run": "soak",
        "tracing": light,
        "focus_scan": {"focus": {"num": draw.randint(3, 6)}},
        "focus_law": {"diameters": {"num": 3}, "fraction": {"num": 9}},
        "sweep": {
            "diameters": {"start": "0.9 um", "stop": "1.3 um", "num": draw.randint(3, 9)},
            "focus": {"slope": 0.58, "intercept": f"{draw.randint(50, 90)} nm"},
        },
    }
    for section, keys in draw.choice(_PARTS).items():
        overlay[section] = overlay.get(section, {}) | keys
    overlay["spectrum"] = {"samples": draw.choice([64, 100]), **overlay.get("spectrum", {})}
    varied = draw.sample(sorted(_VARIED), draw.choice([0, 1, 1, 2]))
    grid: dict[str, Any] = {key: _VARIED[key] for key in varied}
    if draw.random() < 0.2:
        grid["tracing"] = draw.sample(_LIGHT, 2)
    if grid:
        overlay["grid"] = grid
    if draw.random() < 0.4:
        overlay["scatter"] = {"minutes": 1e-4}
    return Drawn(overlay, () if whole else ("phase_slope",))
