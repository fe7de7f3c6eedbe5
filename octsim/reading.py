"""Which keys of a config a stage reads: nothing else makes it run again."""

from collections.abc import Mapping
from typing import Any

from octsim.config import Config

_SPIRAL = ("tracing.rays", "tracing.min_amplitude")

# spectra as accurate as small steps need, whatever the run's scheme
_CALIBRATED = (
    "scene", "objective", "detector", "tracing.max_intersections", "spectrum", "processing",
    "calibration", "sweep.focus",
)  # fmt: skip


def instrument(config: Config) -> tuple[str, ...]:
    """Give the keys that every stage reads that traces."""
    # an accuracy is one in a band; rays that are counted serve any
    paths = config.tracing.scheme == "paths"
    own = ("tracing.accuracy", "spectrum.wavelength") if paths else _SPIRAL
    return (
        "scene", "objective", "detector", "tracing.scheme", "tracing.max_intersections", *own,
    )  # fmt: skip


def keys_read(stage: str, config: Config) -> tuple[str, ...]:
    """Give the keys that a stage reads itself, besides the datasets of others."""
    traced = instrument(config)
    own: Mapping[str, tuple[str, ...]] = {
        # figure 6 counts the rays of the spiral, whatever the scheme
        "focus_scan": (*traced, *_SPIRAL, "spectrum", "focus_scan"),
        "focus_sweep": (*traced, "spectrum", "focus_law"),
        "focus_law": (),
        "detections": (*traced, "sweep"),
        "spectra": ("spectrum", *(key for key in traced if key == "tracing.accuracy")),
        "phase_slope": ("processing", "scene.refractive_index.neuron"),
        "stability": (*traced, *_SPIRAL, "spectrum", "sweep"),
        "calibration": _CALIBRATED,
        "expansion": ("expansion",),
        "action_potential": (*_CALIBRATED, "action_potential"),
        "tradeoff": (
            "scene",
            "objective",
            "detector",
            "tracing",
            "spectrum",
            "focus_law",
            "sweep",
            "processing",
        ),
    }
    return tuple(dict.fromkeys(own[stage]))


def keys_behind(stage: str, config: Config) -> tuple[str, ...]:
    """Give the keys that a stage's dataset depends on: its own and those of stages before it."""
    law = keys_read("focus_sweep", config)
    lawful = law if config.sweep.focus == "law" else ()
    swept = (*keys_read("detections", config), *lawful)
    summed = (*swept, *keys_read("spectra", config))
    calibrated = (*_CALIBRATED, *lawful)
    behind = {
        "detections": swept,
        "spectra": summed,
        "paths": summed,
        "fourier": (*summed, "processing"),
        "phase_slope": (*summed, "processing"),
        "calibration": calibrated,
        "expansion": (*calibrated, "expansion"),
        "action_potential": (*calibrated, "action_potential"),
        "gaussian_fits": law,
        "focus_law": law,
    }
    return tuple(dict.fromkeys(behind[stage] if stage in behind else keys_read(stage, config)))


def part_of(config: Mapping[str, Any], key: str) -> Any:
    """Give what stands under a dotted key of a config's plain data, or None."""
    part: Any = config
    for name in key.split("."):
        part = part.get(name) if isinstance(part, Mapping) else None
    return part


def parts_of(config: Config, *keys: str) -> dict[str, object]:
    """Give what stands under some dotted keys of a config, as plain data."""
    data = config.to_dict()
    return {key: part_of(data, key) for key in keys}
