"""The page of the spike, from causes.nc."""

import json
import re
import textwrap

import numpy as np
import xarray as xr
from markdown import table
from scipy.signal import find_peaks

from octsim.config.processing import Processing
from octsim.studies.causes.study import LEAKAGE
from octsim.studies.causes.switches import weights

_PEAK = 0.2  # mrad/nm: smaller ones are not listed
_LISTED = ("centre", "envelope", "image", "bins", "step", "rays", "paths")


def number(value: float | xr.DataArray, form: str) -> str:
    """Write a number with the sign that a minus is in print."""
    text = f"{float(value):{form}}"
    return (text if float(text) else text.lstrip("+-")).replace("-", "−")


def spike_page(found: xr.Dataset) -> str:
    """Write the page."""
    values = _spike(found) | _causes(found) | _point(found)
    # paragraphs filled again, as numbers are shorter than their names
    blocks = TEMPLATE.format(**values).split("\n\n")
    return "\n\n".join(map(_filled, blocks)) + "\n"


def _filled(block: str) -> str:
    """Fill a paragraph, or the items of a list; leave tables and headings as they are."""
    if block.startswith(("#", "|", "!")):
        return block.strip("\n")
    items = re.split(r"\n(?=- )", block.strip("\n"))
    filled = [
        textwrap.fill(
            " ".join(item.split()), 100, break_long_words=False, break_on_hyphens=False,
            subsequent_indent="  " if item.startswith("- ") else "",
        )
        for item in items
    ]  # fmt: skip
    return "\n".join(filled)


def _spike(found: xr.Dataset) -> dict[str, str]:
    place, k = found["spike_neighbour"].values, found["wavenumber"].values
    at_edge = np.isin(found["spike_maximum"].values, k[[0, -1]])
    first, last = np.flatnonzero(at_edge)[[0, -1]]
    level = 100 * (found["spike_level_error"] / found["spike_amplitude"]).values
    turn = 1e3 * found["spike_leaked_phase"].values
    slope, without = (
        found[name].values for name in ("spike_phase_slope", "spike_phase_slope_without_centre")
    )
    config = json.loads(found.attrs["config"])
    window = np.abs(np.fft.fft(weights(Processing(**config["processing"]), k.size))[1:3])
    component, diameter = found["component"].values, found["diameter"].values
    by_centre = found["phase_slope"] - found["phase_slope_without"].sel(cause="centre")
    second = component > 1
    swept = (found["phase_slope"] - found["trend_phase_slope"]).values
    return {
        "first": f"{place[first]:.4f}",
        "last": f"{place[last]:.4f}",
        "width": f"{1e3 * (place[last] - place[first]):.0f}",
        "edge": f"{found['spike_maximum'].values[last]:.2f}",
        "inside": f"{found['spike_maximum'].values[last + 1]:.2f}",
        "level_first": number(level[first], "+.1f"),
        "level_last": number(level[last + 1], "+.1f"),
        "turn_first": number(turn[first], "+.0f"),
        "turn_last": number(turn[last + 1], "+.0f"),
        "window_1": f"{100 * window[0]:.0f}",
        "window_2": f"{100 * window[1]:.2f}",
        "top": f"{slope.max():.1f}",
        "after": f"{slope[last + 1]:.1f}",
        "swept": number(swept[int(np.abs(swept).argmax())], "+.1f"),
        "least_without": f"{without.min():.2f}",
        "largest_without": f"{without.max():.2f}",
        "switch": f"{diameter[second].min():.2f}",
        "beyond": f"{float(np.abs(by_centre).values[second].max()):.4f}",
    }


def _causes(found: xr.Dataset) -> dict[str, str]:
    rows = [
        [
            f"`{one['cause'].item()}`",
            f"{one['cause_name'].item()}; {one['cause_replacement'].item()}",
            *(
                number(100 * one[name], ".1f")
                for name in ("cause_share", "least_share", "largest_share")
            ),
            *(f"{float(one[name]):.3f}" for name in ("scatter_without", "scatter_with_only")),
        ]
        for one in (found.isel(cause=i) for i in range(found.sizes["cause"]))
    ]
    for name, text in (
        ("trend", "the slope of the beat's own phase: a polynomial of degree 4"),
        ("unexplained", "what is left of it"),
    ):
        rows.append([name, text, number(100 * found[f"{name}_share"], ".2f"), "", "", "", ""])
    total = found["cause_share"].sum() + found["trend_share"] + found["unexplained_share"]
    rows.append(["sum", "", number(100 * total, ".2f"), "", "", "", ""])
    off = (found["phase_slope"] - found["trend_phase_slope"]).values
    peaks = find_peaks(np.abs(off), height=_PEAK, prominence=_PEAK / 2)[0]
    listed = [
        [
            f"{found['diameter'].values[i]:.3f}",
            number(off[i], "+.2f"),
            *(number(found["cause_phase_slope"].sel(cause=c)[i], "+.2f") for c in _LISTED),
        ]
        for i in peaks.tolist()
    ]
    share = found["cause_share"].to_series()
    image = found.sel(cause="image")
    bins = found.sel(cause="bins")
    return {
        "shares": table(
            [
                "cause", "what it is; what stands in its place", "share (%)", "least", "largest",
                "scatter without it", "with it alone",
            ],
            rows,
        ),
        "peaks": table(["at (µm)", "off the trend", *(f"`{c}`" for c in _LISTED)], listed),
        "scatter": f"{float(found['phase_slope_standard_deviation']):.3f}",
        "leakage": ", ".join(f"`{c}`" for c in sorted(LEAKAGE)),
        "no_leakage": f"{float(found['scatter_without_leakage']):.3f}",
        "left": f"{100 * float(found['left_without_leakage']):.1f}",
        "explained": f"{100 * (1 - float(found['left_without_leakage'])):.1f}",
        "left_all": f"{float(found['left_without_all']):.0e}".replace("-", "−"),
        "image_least": f"{100 * float(image['least_share']):.0f}",
        "image_largest": f"{100 * float(image['largest_share']):.0f}",
        "bins_first": f"{100 * float(bins['share_removed_first']):.0f}",
        "bins_last": f"{100 * float(bins['share_removed_last']):.1f}",
        "level_and_bins": f"{100 * float(share[['centre', 'envelope', 'bins', 'step']].sum()):.0f}",
        "period": f"{1e3 * np.pi / float(found['predicted_phase_slope']):.0f}",
        "ideal": f"{float(found['ideal_phase_slope_standard_deviation']):.3f}",
        "ideal_without": f"{float(found['ideal_scatter_without_image']):.0e}".replace("-", "−"),
    }  # fmt: skip


def _point(found: xr.Dataset) -> dict[str, str]:
    steps = found["half_step"].values
    rows = [
        [
            str(one["series"].item()),
            *(f"{scatter:.3f}" for scatter in one["step_scatter"].values),
            f"{float(one['step_largest'].sel(half_step=1e-4)):.3g}",
        ]
        for one in (found.isel(series=i) for i in range(found.sizes["series"]))
    ]
    tenth = found.sel(half_step=1e-4, series="as the run")
    slope, held = found["beat_phase_slope"], found["held_beat_phase_slope"]

    predicted = float(found["predicted_phase_slope"])
    noise = found["step_ray_noise"]
    own = found["diameter"].values[1] - found["diameter"].values[0]
    k = found["wavenumber"].values[found.sizes["wavenumber"] // 2]
    config = json.loads(found.attrs["config"])["scene"]["refractive_index"]
    law = np.polyfit(found["diameter"], found["focus"], 1)[0]
    follows = -2 * config["glass"] * law * k
    axis = {"": (follows, follows + predicted, predicted), "held_": (0.0, predicted, predicted)}

    def cell(name: str, on_axis: float) -> str:
        off = found[f"{name}_phase_slope"].mean() - on_axis
        return f"{number(on_axis, '.2f')} {number(off, '+.2f')}"

    rows_of_sides = [
        [text, *(cell(prefix + s, value) for s, value in zip(SIDES, axis[prefix], strict=True))]
        for prefix, text in (("", "focus follows the law"), ("held_", "focus held"))
    ]
    return {
        "steps": table(
            ["slopes", *(f"±{1e3 * s:.2g} nm" for s in steps), "largest, ±0.1 nm"], rows
        ),
        "tenth": f"{float(tenth['step_scatter']):.2f}",
        "tenth_percent": f"{100 * float(tenth['step_scatter']) / predicted:.1f}",
        "tenth_largest": f"{float(tenth['step_largest']):.1f}",
        "tenth_largest_percent": f"{100 * float(tenth['step_largest']) / predicted:.0f}",
        "noise_least": f"{float(noise[0]):.3f}",
        "noise_own": f"{float(noise.sel(half_step=own, method='nearest')):.3f}",
        "beat": f"{float(slope.mean()):.3f} ± {float(slope.std()):.3f}",
        "beat_first": f"{float(slope[0]):.3f}",
        "beat_last": f"{float(slope[-1]):.3f}",
        "beat_error": f"{float(found['beat_phase_slope_error'].max()):.0e}".replace("-", "−"),
        "held": f"{float(held.mean()):.2f} ± {float(held.std()):.2f}",
        "held_first": f"{float(held[0]):.2f}",
        "held_last": f"{float(held[-1]):.2f}",
        "held_error": f"{float(found['held_beat_phase_slope_error'].max()):.0e}".replace("-", "−"),
        "predicted": f"{predicted:.3f}",
        "sides": table(["on the axis, and off it", "near side", "far side", "beat"], rows_of_sides),
    }


SIDES = ("near", "far", "beat")
TEMPLATE = """# The spike, and what makes the slope scatter

Written by `make docs` from `results/thesis/causes.nc`; do not edit. `octsim run causes`, half a
minute on two cores, makes it for a config of yours. Slopes and scatters (standard deviations over
the diameters) are in mrad/nm.

Which way each ray came is known, so the intensity falls into parts: the *beat* Re(2 Eₙ* E_f) of the
field Eₙ off the glass and the near side with the field E_f off the far side; what does not
oscillate, |Eₙ|² + |E_f|², a level and a slow envelope over k; and what light adds that is reflected
more than once. The phase of the beat is what is asked for. All else in the component whose phase is
read has leaked there, and can be switched off by itself.

## The spike at 1.15 µm

![The spike](figures/spike.png)

The processing subtracts (max + min)/2. Between {first} and {last} µm the largest intensity is that
at the edge of the band, {edge}/µm: a crest is leaving the band. As long as the crest is inside, its
height hardly moves; once its flank is at the edge, the maximum falls with every nanometre, until
another crest, at {inside}/µm, is the higher one. On the way the level that is subtracted goes from
{level_first} to {level_last} % of the beat's amplitude off the true one, and at {last} µm it kinks.

The error of the level is a constant, and the window hands {window_1} % of a constant to component
1. Over those {width} nm it turns the component's phase from {turn_first} to {turn_last} mrad. At a
point that makes a slope of up to {top}, where it is {after} just beyond; the sweep, whose
difference spans 13 nm, has {swept} off the trend left of it. With the true level subtracted, and
nothing else changed, the slope goes from {least_without} to {largest_without} over all of the
figure.

From {switch} µm on component 2 is the strongest. It gets {window_2} % of a constant, so that crests
that leave the band later make no spike: there the level changes the slope by {beyond} at most. (The
points jitter as the largest of 1000 samples is not the crest itself, and moves from sample to
sample.)

## What carries the scatter

![The causes](figures/causes.png)

The slope of the run scatters by {scatter}. Seven causes can each be switched off:

{shares}

How much a cause carries depends on which others are there, so the slope is found with each of the
128 sets of causes, and a cause's part at each diameter is the mean of what it adds over all orders
of switching them off (Shapley's value). Its share is cov(part, slope) / var(slope): shares sum to
100 % as they must. *Least* and *largest* are over all orders; a negative share goes against the
others.

That sum would be 100 % for any list of causes. What tells that these are the ones is what is left
when they are off. Without {leakage} the scatter is {no_leakage}, nearly all of it the beat's own
trend; about the trend {left} % of the run's variance is left, so that these three explain
{explained} %. Without all seven {left_all} of the variance is left.

- **The oscillation**, the thesis's 2 %, is the image. A real spectrum holds the beat twice, at nd
  and at −nd. With one to three oscillations in the band the window does not keep them apart, and
  the image turns once against the component while d grows by π/(n (k_min + k_max)), {period} nm.
  It carries {image_least} to {image_largest} %, whatever the order. The thesis's ideal cos(2ndk)
  has nothing but its image: a scatter of {ideal} with it, of {ideal_without} without.
- **The spike** is the level's (`centre`), together with the envelope that makes one crest higher
  than another and leaks too (`envelope`).
- **Bins make nothing, and hand on**: alone they leave the slope as it is, and switched off last
  they carry {bins_last} %, switched off first {bins_first} %. The components' depths are not nd,
  and a transform at nd itself gets less of the level and of the envelope. That another component
  becomes the strongest does no harm by itself.
- **The step** of the sweep takes scatter away: it smooths the spike.
- **Rays and other light paths** hardly matter beside these.

The peaks by their parts:

{peaks}

## The slope at a point

Experiments live at expansions of a nanometre and below; the thesis's difference is 6.7 nm to each
side. Scatter over the step to each side of a central difference:

{steps}

*As the run* has all other causes, *converged* all but the rays, *without leakage* neither rays nor
{leakage}, *beat alone* none, or the run's rays only. The last column is the largest deviation from
a trend of degree 4.

Down to a tenth of a nanometre the thesis's processing gets worse, as a small step sees all of the
spike: over ±0.1 nm it scatters by {tenth}, {tenth_percent} % of an expansion, and is off by up to
{tenth_largest}, {tenth_largest_percent} %. The beat's own slope does not depend on the step, and
3000 rays add {noise_own} (rms) to it over the sweep's step and {noise_least} at ±0.01 nm, hardly
more: rays come and go at the rim of the detector, where they weigh nothing.

The beat's own slope, differentiated at a point (Richardson's extrapolation of ±1 and ±0.5 nm,
estimated error up to {beat_error}), is {beat}, from {beat_first} at the first diameter to
{beat_last} at the last; n (k_min + k_max) is {predicted}. That is with a focus that follows the
diameter by the law. With the focus held, as it is while a neuron is active, it is by rays {held}
(Maxwell's is in [calibration.md](calibration.md); estimated error up to {held_error}), from
{held_first} to {held_last}: the two differ by the law's
slope times ∂φ/∂z. Mean slopes of the sides' own phases, at the middle of the band, as what they are
along the axis plus what light off the axis adds:

{sides}

On the axis the far side's path grows by 2n_neuron with the diameter and the near side's stays;
a focus that follows shortens both by 2n_glass times the law's slope, which the beat does not see.
"""
