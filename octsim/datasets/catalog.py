"""Which keys of a config a stage reads: nothing else makes it run again."""

from collections.abc import Callable, Mapping
from typing import Any

from octsim.config.derive import parts_of
from octsim.config.grid import Axis, axes, combinations
from octsim.config.models import Config

_SPIRAL = ("tracing.rays", "tracing.min_amplitude")

_COMPARED = ("scene", "objective", "detector", "tracing", "spectrum", "sweep", "processing")
# spectra as accurate as small steps need, whatever the run's scheme
_CALIBRATED = ("tracing.min_amplitude",
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


_DECIDING = ("tracing.scheme", "tracing.preset", "sweep.focus")
"""Keys that decide which others are read."""


def keys_read(stage: str, config: Config) -> tuple[str, ...]:
    """Give the keys that a stage reads itself, at any combination, besides others' datasets."""
    return _of_all(_read, stage, config)


def keys_behind(stage: str, config: Config) -> tuple[str, ...]:
    """Give the keys that a stage's dataset depends on: its own and those of stages before it."""
    return _of_all(_behind, stage, config)


def stage_axes(stage: str, config: Config) -> tuple[Axis, ...]:
    """Give the axes of the grid that a stage's dataset has: those of the keys that it depends on.

    A stage that has nothing to do with any varied key has none.
    """
    return axes(config, *keys_behind(stage, config))


def needs_law(config: Config) -> bool:
    """Tell whether the fitted focus law is needed at some combination."""
    return any(at.config.sweep.focus == "law" for at in combinations(config, "sweep.focus"))


def _of_all(
    keys: Callable[[str, Config], tuple[str, ...]], stage: str, config: Config
) -> tuple[str, ...]:
    every = (key for at in combinations(config, *_DECIDING) for key in keys(stage, at.config))
    return tuple(dict.fromkeys(every))


def _read(stage: str, config: Config) -> tuple[str, ...]:
    traced = instrument(config)
    own: Mapping[str, tuple[str, ...]] = {
        # figure 6 counts the rays of the spiral, whatever the scheme
        "focus_scan": (*traced, *_SPIRAL, "spectrum", "focus_scan"),
        "focus_sweep": (*traced, "spectrum", "focus_law"),
        "detections": (*traced, "sweep"),
        "spectra": ("spectrum", *(key for key in traced if key == "tracing.accuracy")),
        "paths": ("spectrum.wavelength",),
        "phase_slope": ("processing", "scene.refractive_index.neuron"),
        "stability": (*traced, *_SPIRAL, "spectrum", "sweep"),
        "causes": (*traced, "spectrum", "sweep", "processing"),
        "calibration": _CALIBRATED,
        "expansion": ("expansion",),
        "action_potential": (*_CALIBRATED, "action_potential"),
        "estimators": _COMPARED,
        "tradeoff": (*_COMPARED, "focus_law"),
    }
    return own.get(stage, ())


def _behind(stage: str, config: Config) -> tuple[str, ...]:
    law = _read("focus_sweep", config)
    fitted = law if config.sweep.focus == "law" else ()
    swept = (*_read("detections", config), *fitted)
    summed = (*swept, *_read("spectra", config))
    calibrated = (*_CALIBRATED, *fitted)
    behind = {
        "detections": swept,
        "spectra": summed,
        "paths": (*swept, *_read("paths", config)),
        "fourier": (*summed, "processing"),
        "phase_slope": (*summed, "processing"),
        "calibration": calibrated,
        "expansion": (*calibrated, "expansion"),
        "action_potential": (*calibrated, "action_potential"),
        "gaussian_fits": law,
        "focus_law": law,
        "causes": (*_read("causes", config), *fitted),
        "estimators": (*_COMPARED, *fitted),
    }
    return behind.get(stage, _read(stage, config))


def differing(stage: str, config: Config, other: Mapping[str, Any]) -> list[str]:
    """Give the keys that a stage's dataset depends on and that another config, as data, differs in.

    Keys are those that the stage depends on under `config`; a varied one is ``grid.<key>``.
    """
    keys = keys_behind(stage, config)
    asked, made = parts_of(config.to_dict(), *keys), parts_of(other, *keys)
    return [key for key in dict.fromkeys((*asked, *made)) if made.get(key) != asked.get(key)]
