"""The page of what each effect changes, written from `effects.nc`; `generate.py` calls it."""

import json
from collections.abc import Callable

import numpy as np
import xarray as xr
from markdown import table

from octsim.studies.effects.pairs import KINDS
from octsim.studies.effects.variants import EffectStatus

_WORDS = {
    EffectStatus.NOT_BY_THIS_SCHEME: "not by this scheme",
    EffectStatus.AS_CONFIGURED: "as configured, or in the place of what is",
    EffectStatus.NOT_IN_THIS_SCENE: "not in this scene",
    EffectStatus.NO_FRINGE: "too few fringes",
}
_HEAD = [
    "", "effect", "max ΔI / max I", "shape", "signal", "mean slope (mrad/nm)", "noise", "%",
    "local scatter", "worst", "noise", "run's estimator", "scatter", "CPU ×", "",
]  # fmt: skip


def effects_page(found: xr.Dataset) -> str:
    """Write the page."""
    config = json.loads(found.attrs["config"])
    tracing = config["tracing"]
    rays = f"{tracing['rays']} rays" if tracing["scheme"] == "vogel" else f"{tracing['accuracy']:g}"
    return TEMPLATE.format(
        sentence=found.attrs["sentence"],
        scheme=f"`{tracing['scheme']}`, {rays}",
        estimator=f"`{config['processing']['estimator']}`",
        number=found.sizes["diameter"],
        first=f"{float(found['diameter'][0]):g}",
        last=f"{float(found['diameter'][-1]):g}",
        kinds=KINDS,
        slope=f"{float(found['baseline_slope']):.4f}",
        scatter=f"{float(found['baseline_local_scatter']):.4f}",
        own=f"{float(found['baseline_configured_slope']):.4f} ± "
        f"{float(found['baseline_configured_scatter']):.4f}",
        seconds=f"{1e3 * float(found['baseline_seconds']):.2g}",
        mean=f"{100 * found.attrs['mean_tolerance']:g}",
        local=f"{100 * found.attrs['local_tolerance']:g}",
        effects=table(_HEAD, _ranked(found)),
        pairs=table(
            ["pair", "mean slope (mrad/nm)", "sum of the parts", "beyond it", "noise",
             "local, beyond it", "the sum of its parts?", "CPU ×"],
            [_pair(found.isel(pair=number)) for number in range(found.sizes["pair"])],
        ),
        others=table(["effect", "", "scheme that has it"], _others(found)),
        what=table(
            ["effect", "what it is"],
            [[str(one), str(what)] for one, what in zip(
                found["effect"].values, found["effect_meaning"].values, strict=True)],
        ),
    )  # fmt: skip


def _ranked(found: xr.Dataset) -> list[list[str]]:
    measured = found.isel(effect=np.flatnonzero(found["rank"].values > 0))
    order = np.argsort(measured["rank"].values).tolist()
    return [_row(measured.isel(effect=place)) for place in order]


def _row(one: xr.Dataset) -> list[str]:
    said = _writer(one)
    if one["needed"]:
        verdict = "**needed**"
    elif one["undecided"]:
        verdict = "hidden by noise"
    else:
        verdict = "" if one["resolved"] else "mean not resolved"
    return [
        str(int(one["rank"])), str(one["effect"].item()), said("spectrum_change", ".1e"),
        said("shape_change", ".1e"), said("signal_ratio", ".2f"),
        said("mean_slope_change", "+.4f"), said("mean_slope_change_noise", ".4f"),
        said("calibration_change", "+.2f", 100), said("slope_change_scatter", ".3f"),
        said("worst_slope_change", ".2f"), said("worst_slope_change_noise", ".2f"),
        said("configured_slope_change", "+.3f"), said("configured_local_change", ".3f"),
        said("cost_ratio", ".1f"), verdict,
    ]  # fmt: skip


def _pair(one: xr.Dataset) -> list[str]:
    said = _writer(one)
    return [
        f"{one['pair_first'].item()} and {one['pair_second'].item()}",
        said("pair_mean_slope_change", "+.4f"), said("pair_sum", "+.4f"),
        said("pair_excess", "+.4f"), said("pair_excess_noise", ".4f"),
        said("pair_local_excess", ".3f"), "yes" if one["pair_adds_up"] else "no",
        said("pair_cost_ratio", ".1f"),
    ]  # fmt: skip


def _others(found: xr.Dataset) -> list[list[str]]:
    status = found["effect_status"].values
    return [
        [
            str(found["effect"].values[place]),
            _WORDS[EffectStatus(int(status[place]))],
            str(found["able_schemes"].values[place]) or "–",
        ]
        for place in np.flatnonzero(status != EffectStatus.MEASURED).tolist()
    ]


def _writer(one: xr.Dataset) -> Callable[..., str]:
    def said(name: str, form: str, scale: float = 1.0) -> str:
        value = scale * float(one[name])
        return f"{value:{form}}".replace("-", "−").replace("e−0", "e−") if value == value else "–"

    return said


TEMPLATE = """# What each effect changes

Written by `make docs` from `results/thesis/effects.nc`; do not edit. `octsim run effects` makes it,
for the configured scene and scheme (here {scheme}), at {number} diameters from {first} to {last}
µm.

> {sentence}

Each effect is put into the run as configured, alone, at a size that is tried; what the config
already has is switched off instead, and its row is "… as configured". The foci stay where the
configured line has them: the focus law is not fitted anew. With counted rays the same rays are
traced with the effect and without it.

![Effects, ranked](figures/effects.png)

## Alone

As configured, the line through the phase has a slope of {slope} mrad/nm, the local slope scatters
by {scatter} about its mean, the run's own estimator ({estimator}) gives {own}, and a point takes
{seconds} ms of processor time.

{effects}
ΔI and shape are medians over the diameters of the largest change over the band: of I over its
maximum, and of I over its mean. *Signal* is the mean of I over that without the effect, a median
too. *Mean slope* is that of the line through the change of the phase of a least-squares sinusoid
(depth held at the configured scene's, linear offset and amplitude), % the same over the slope: the
change of a calibration. *Local scatter* is the standard deviation of the change of the local slope
over the diameters, *worst* its largest. CPU is the median over the diameters of the processor time
of a point over that of the same point without the effect, found just before.

*Noise* is how far the change itself differs with half of the rays (of schemes with an accuracy:
with ten times it), at every second diameter; of the mean slope with the standard error of that
line. Weights move no ray, and are quieter by far than what moves rays. An effect is **needed** if
it moves the mean slope by more than {mean} %, or the slope anywhere by more than {local} %, and
that is above its noise.

## In pairs

Of the {kinds} largest, each of another kind, every pair that the scheme can have at once, at every
fourth diameter. A pair is the sum of its parts if what it has beyond is within {mean} % of the
slope, or within the noise.

{pairs}
## Not measured

{others}
## What was tried

{what}"""
