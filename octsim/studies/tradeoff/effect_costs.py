"""What each kind of effect costs by each scheme, and what it changes, for `tradeoff.nc`."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.config.derive import by_accuracy, by_waves, counting_rays
from octsim.config.maxwell import beyond_maxwell
from octsim.config.models import Config, FocusLine
from octsim.config.scheme import scheme_of, way_varies
from octsim.datasets.files import flags
from octsim.schemes.light import AccuracyStatus
from octsim.studies.effects.sweeps import Swept, swept
from octsim.studies.effects.variants import EffectStatus, Variant, variants

EFFECTS = (
    "dispersion of glass, water and neuron", "attenuation of neuron 100 /cm", "unpolarised",
    "aplanatic apodisation", "Gaussian pupil, fill 1", "falloff top hat", "falloff cosine",
    "falloff Gaussian", "Zernike spherical (11) 10 nm rms",
    "Zernike spherical (11) 10 nm rms, phase only", "chromatic focal shift 100 nm",
    "rulings of one wavelength", "membrane 5 nm", "myelin 100 nm", "cover glass at 5 um",
    "neighbour 50 nm beside",
    "neuron 50 nm off the axis", "azimuth 10°", "elevation 2°",
)  # fmt: skip
"""One of each kind, of those that `octsim.studies.effects.kinds.EFFECTS` has."""
DIAMETERS = 5
"""Of the sweep's range, ends included; of counted rays that are traced many times `_FEW`."""
_FEW = 2
_PATHS = (1e-4, 1e-6)
_WARM = {"rays": 16, "accuracy": 0.1}


def effect_costs(
    config: Config, line: FocusLine, names: Iterable[str] = EFFECTS
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return how many times as long a point takes with an effect, and what it changes.

    Each point is found with the effect and without it, one after the other on this thread.

    Parameters
    ----------
    config : Config
        The run; each scheme honours of it what it can.
    line : FocusLine
        Where it is focused.
    names : iterable of str
        Which effects.

    Returns
    -------
    variables, coords : dict
        effect_cost_ratio and effect_intensity_change, medians over the diameters (NaN where
        effect_status says why), and the statuses (effect, effect_scheme).
    """
    listed, settings = list(names), _settings(config)
    found = [_measured(setting, name, line) for name in listed for setting in settings.values()]
    shape = ("effect", "effect_scheme")

    def column(values: Iterable[float]) -> NDArray[Any]:
        return np.reshape(list(values), (len(listed), len(settings)))

    light = [swept for _, swept in found]
    status = column(variant.status for variant, _ in found)
    accuracy = column(one.status if one else AccuracyStatus.NOT_CONTROLLED for one in light)
    cost, change = (one.cost_ratio if one else np.nan for one in light), map(_change, light)
    variables = {
        "effect_cost_ratio": (shape, column(cost)),
        "effect_intensity_change": (shape, column(change)),
        "effect_status": (shape, *flags(EffectStatus, status)),
        "effect_accuracy_status": (shape, *flags(AccuracyStatus, accuracy)),
    }
    return variables, {"effect": listed, "effect_scheme": list(settings)}


def _settings(config: Config) -> dict[str, Config]:
    """Return the run by each scheme, by what it is."""
    counted = counting_rays(config)
    found = {f"{counted.tracing.scheme}, {counted.tracing.rays} rays": counted}
    for accuracy in _PATHS:
        paths = by_accuracy(config, accuracy)
        found[f"{paths.tracing.scheme}, {accuracy:g}"] = paths
    if not beyond_maxwell(config):
        waves = by_waves(config)
        found[f"{waves.tracing.scheme}, {waves.tracing.accuracy:g}"] = waves
    return found


def _measured(config: Config, name: str, line: FocusLine) -> tuple[Variant, Swept | None]:
    """Return an effect about a config, and the light with it and without it where it has that."""
    variant = next(one for one in variants(config) if one.effect.name == name)
    if not variant.measured:
        return variant, None
    sizes = config.sweep.diameters
    slow = scheme_of(config).counts_rays and way_varies(variant.with_effect)
    diameter = np.linspace(sizes.start, sizes.stop, _FEW if slow else DIAMETERS)
    # compiled code is there before time is taken
    warm = variant._replace(
        with_effect=_least(variant.with_effect), without_effect=_least(variant.without_effect)
    )
    swept(warm, diameter[:1], line.at(diameter[:1]), 1)
    return variant, swept(variant, diameter, line.at(diameter), 1)


def _least(config: Config) -> Config:
    """Return a config, not checked, of as little effort as compiles the same code."""
    return config.model_copy(update={"tracing": config.tracing.model_copy(update=_WARM)})


def _change(found: Swept | None) -> float:
    """Return the change of the intensity over its maximum, median of the diameters."""
    if found is None:
        return np.nan
    off = np.abs(found.with_effect - found.without_effect).max(axis=1)
    return float(np.median(off / found.without_effect.max(axis=1)))
