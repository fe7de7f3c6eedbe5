"""Which effects a scene needs, by how far a calibration is off without them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.datasets.versions import recorded_config
from octsim.schemes.light import AccuracyStatus
from octsim.schemes.table import SCHEMES
from octsim.studies.effects.variants import EffectStatus

Array = NDArray[np.float64]
MEAN_TOLERANCE = 0.0025
"""Of the mean slope, relative: an effect that moves it by more is needed.

Chosen, not derived: no key of the config states an accuracy of a calibration.
"""
LOCAL_TOLERANCE = 0.01
"""Of the slope at any one diameter, relative to the mean slope."""


def verdict(measured: dict[str, Array], slope: float) -> dict[str, NDArray[np.int8]]:
    """Return which effects are resolved, needed, and not told to be either, each (N,).

    Parameters
    ----------
    measured : mapping
        Measures of the effects and their noise by their names in the dataset.
    slope : float
        The mean slope as configured, mrad/nm.
    """
    mean, local = (np.abs(measured[f"{name}_slope_change"]) for name in ("mean", "worst"))
    mean_noise, local_noise = (measured[f"{name}_slope_change_noise"] for name in ("mean", "worst"))
    large = MEAN_TOLERANCE * abs(slope), LOCAL_TOLERANCE * abs(slope)
    needed = ((mean > large[0]) & (mean > mean_noise)) | (
        (local > large[1]) & (local > local_noise)
    )
    unsure = ~needed & ((mean + mean_noise > large[0]) | (local + local_noise > large[1]))
    flags = {"resolved": mean > mean_noise, "needed": needed, "undecided": unsure}
    return {name: flag.astype(np.int8) for name, flag in flags.items()}


def ranks(change: Array) -> NDArray[np.int64]:
    """Return the place of each effect by the size of its change, (N,), from 1; 0 where none is."""
    known = np.isfinite(change)
    place = np.zeros(change.size, np.int64)
    order = np.argsort(-np.abs(change[known]), kind="stable")
    place[np.flatnonzero(known)[order]] = np.arange(1, known.sum() + 1)
    return place


def sentence(table: xr.Dataset) -> str:
    """Say in a line what a scene needs, of the effects that were measured."""
    chosen = _ranked(table, "needed")
    accuracy = (
        f"at your accuracy ({MEAN_TOLERANCE:.2%} of the mean slope, {LOCAL_TOLERANCE:.0%} at any "
        "diameter)"
    )
    unsure = _ranked(table, "undecided")
    rest = f", but for what the noise hides: {', '.join(map(_name, unsure))}" if unsure else ""
    if not chosen:
        return (
            f"this scene needs none of the effects that were tried; {accuracy} all may stay off"
            f"{rest}"
        )
    kinds: dict[str, list[Any]] = {}
    for one in chosen:
        kinds.setdefault(str(one["effect_kind"].item()), []).append(one)
    named = ", ".join(_said(first, len(others)) for first, *others in kinds.values())
    return f"this scene needs {named}; {accuracy} the rest may stay off{rest}"


def _said(one: Any, others: int) -> str:
    """Name an effect with its size, and how many more of its kind are needed."""
    worst = float(one["worst_slope_change"] / abs(one["baseline_slope"]))
    more = f"; {others} more of its kind" if others else ""
    return f"{_name(one)} ({float(one['calibration_change']):+.2%}, up to {worst:.1%}{more})"


def _ranked(table: xr.Dataset, flag: str) -> list[Any]:
    """Return the effects with a flag, the largest first."""
    places = np.flatnonzero(table[flag].values)
    size = np.maximum(
        np.abs(table["calibration_change"].values) / MEAN_TOLERANCE,
        table["worst_slope_change"].values / abs(float(table["baseline_slope"])) / LOCAL_TOLERANCE,
    )
    return [table.isel(effect=i) for i in sorted(places.tolist(), key=lambda i: -size[i])]


def _name(one: Any) -> str:
    return str(one["effect"].item())


def summary(table: xr.Dataset) -> str:
    """Return the sentence on what the scene needs."""
    return str(table.attrs["sentence"])


def doubts(table: xr.Dataset) -> list[str]:
    """Say, a line each, what is not measured, or not surely."""
    config = Config.model_validate(recorded_config(table.attrs))
    scheme = SCHEMES[config.tracing.scheme]
    status, said = table["effect_status"].values, []
    beyond = table.isel(effect=status == EffectStatus.NOT_BY_THIS_SCHEME)
    for able in dict.fromkeys(beyond["able_schemes"].values.tolist()):
        names = beyond["effect"].values[beyond["able_schemes"].values == able].tolist()
        instead = f"give tracing.scheme: {able.replace(', ', ' or ')}" if able else "no scheme does"
        said.append(f"tracing.scheme: {scheme.name} has no {_listed(names)}; {instead}")
    dark = table["effect"].values[status == EffectStatus.NO_FRINGE].tolist()
    if dark:
        said.append(f"too few diameters have a fringe with or without {_listed(dark)}")
    unsure = table["effect"].values[table["undecided"].values == 1].tolist()
    if unsure:
        remedy = "raise tracing.rays" if scheme.counts_rays else "ask for more by tracing.accuracy"
        said.append(f"noise hides whether {_listed(unsure)} can stay off; {remedy}")
    late = table["accuracy_status"].values
    late = ~np.isin(late, (AccuracyStatus.REACHED, AccuracyStatus.NOT_CONTROLLED)) & (
        status != EffectStatus.NOT_BY_THIS_SCHEME
    )
    if late.any():
        said.append(
            f"the accuracy of spectra is not, or not surely, reached with or without "
            f"{_listed(table['effect'].values[late].tolist())} (accuracy_status)"
        )
    return said


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names)
