"""Write the page of the detector's falloff and radius, from detector.nc."""

import json

import numpy as np
import xarray as xr
from markdown import table

from octsim.config.models import Config
from octsim.schemes.light import AccuracyStatus
from octsim.studies.detector.cases import LimitStatus
from octsim.studies.detector.recommended import BLOCKS, Chosen, as_close, own


def detector_page(found: xr.Dataset) -> str:
    """Write the page."""
    config = Config.model_validate(json.loads(found.attrs["config"]))
    mine = own(found)
    said = str(found.attrs["recommendation"])
    diameter = found["diameter"]
    counted = found.sel(ray_scheme="vogel")
    at_radius = counted.sel(detector_radius=mine.radius)
    close = as_close(found)
    names = [str(name).replace("_", " ") for name in found["falloff"].values]
    unlike = [
        f"{falloff.replace('_', ' ')} at {float(radius):.3g}"
        for falloff in map(str, found["falloff"].values)
        for radius in found["detector_radius"].values
        if not bool(close.sel(falloff=falloff, detector_radius=radius))
    ]
    beyond = [
        name
        for name, status in zip(names, at_radius["limit_status"].values, strict=True)
        if status != LimitStatus.KNOWN
    ]
    return TEMPLATE.format(
        recommendation=f"{said[:1].upper()}{said[1:]}.",
        number=diameter.size,
        first=f"{float(diameter[0]):g}",
        last=f"{float(diameter[-1]):g}",
        step=f"{1e3 * float(diameter[1] - diameter[0]):.3g}",
        rays=config.tracing.rays,
        radius=f"{mine.radius:.3g}",
        own=table(_HEAD, [_row(found, Chosen(name, mine.radius))
                          for name in map(str, found["falloff"].values)]),
        noise=_over_radius(found["ray_noise"], ".2g"),
        edge=_over_radius(found["edge_phase_jump"], ".2g"),
        slope=_over_radius(counted["line_slope"], ".2f"),
        scatter=_over_radius(counted["slope_scatter"], ".2g"),
        away=_over_radius(counted["slope_difference"], ".2f"),
        shape=_over_radius(counted["shape_difference"], ".2f"),
        signal=_over_radius(counted["signal"], ".1e"),
        maxwell=f"{float(found['maxwell_line_slope']):.2f}",
        maxwell_scatter=f"{float(found['maxwell_slope_scatter']):.2f}",
        top_hat=_times(found["edge_phase_jump"], mine.radius, "top_hat", "parabolic"),
        top_hat_noise=_times(found["ray_noise"], mine.radius, "top_hat", "parabolic"),
        bell=_times(found["ray_noise"], mine.radius, "parabolic", "gaussian"),
        edge_rays=f"{float(at_radius['edge_rays'].sel(falloff='parabolic')):.1f}",
        blocks=BLOCKS,
        unlike=", ".join(unlike) if unlike else "none",
        beyond=" and ".join(beyond) if beyond else "none of them",
        late=int((found["accuracy_status"] != AccuracyStatus.REACHED).sum()),
    )  # fmt: skip


_HEAD = [
    "falloff", "ray noise (mrad/nm)", "jump of the phase (mrad)", "by edge rays (mrad/nm)",
    "edge rays' amplitude", "scatter, and of light paths", "slope, and of light paths", "signal",
    "rays, and effective ones", "less Maxwell's: rms, mean", "shape",
]  # fmt: skip


def _number(value: xr.DataArray, form: str) -> str:
    one = float(value)
    return f"{one:{form}}".replace("e-0", "e-") if np.isfinite(one) else "–"


def _row(found: xr.Dataset, one: Chosen) -> list[str]:
    """Write what a detector does."""
    at = found.sel(one.at)
    counted, limit = at.sel(ray_scheme="vogel"), at.sel(ray_scheme="paths")
    return [
        one.falloff.replace("_", " "),
        _number(at["ray_noise"], ".2g"),
        _number(1e3 * at["phase_jump"], ".2g"),
        _number(at["edge_phase_jump"], ".2g"),
        _number(at["edge_amplitude"], ".1e"),
        f"{_number(counted['slope_scatter'], '.3f')}, {_number(limit['slope_scatter'], '.3f')}",
        f"{_number(counted['line_slope'], '.3f')}, {_number(limit['line_slope'], '.3f')}",
        _number(counted["signal"], ".1e"),
        f"{_number(at['mean_rays_detected'], '.0f')}, {_number(at['effective_rays'], '.0f')}",
        f"{_number(counted['slope_difference'], '.2f')}, "
        f"{_number(counted['slope_bias'], '+.2f')}",
        _number(counted["shape_difference"], ".2f"),
    ]  # fmt: skip


def _over_radius(values: xr.DataArray, form: str) -> str:
    """Write a table of a value: a row for each falloff, a column for each radius."""
    radii = values["detector_radius"].values
    rows = [
        [
            name.replace("_", " "),
            *(_number(values.sel(falloff=name, detector_radius=radius), form) for radius in radii),
        ]
        for name in map(str, values["falloff"].values)
    ]
    return table(["R_det (µm)", *(f"{radius:.3g}" for radius in radii)], rows)


def _times(values: xr.DataArray, radius: float, more: str, less: str) -> str:
    """Write how many times one falloff has what another has at a radius."""
    at = values.sel(detector_radius=radius)
    times = float(at.sel(falloff=more) / at.sel(falloff=less))
    return f"{times:.0f}" if times >= 10 else f"{times:.2g}"


TEMPLATE = """# The detector's falloff and radius

Written by `make docs` from `results/thesis/detector.nc`; do not edit. `octsim run detector` makes
it. The thesis (§4.4) weighs detected light by a parabola, so that a ray that just misses the
detector when the neuron is a nanometre larger takes no amplitude along; it says that the falloff
"was added in a late stage of the project and was not properly analysed", and that a parabola was
taken "over e.g. a bell curve" as it keeps the detector's finite size. This is that analysis.

**{recommendation}**

![The detector's falloff and radius](figures/detector.png)

## What is compared

Five falloffs (`detector.falloff`) at eight radii R_det of the fibre core's image
(`detector.core_diameter` over twice the magnification): 1 − u², 1 up to the edge, cos(πu/2),
exp(−u²) without an edge, and the mode LP01 of a fibre of that core, with u = ρ/R_det; at
{number} diameters from {first} to {last} µm ({step} nm apart), with {rays} counted rays. The
focus is by the run's law for all of them: with another detector another law would be fitted
([results.md](results.md)), which is not done here. Phases are by a least-squares sinusoid at the
nominal depth.

- **Ray noise**: the slope by counted rays less that by scheme `paths`, which is what they come to
  as they become more, rms over the diameters; it is larger for smaller steps. `paths` is at its
  preset standard, 1e-4, which is not reached at {late} points: at the Gaussian's largest radii what
  is below about 0.01 mrad/nm is its own. It knows no limit of: {beyond} (`limit_status`).
- **Jump of the phase**: the second difference, from diameter to diameter, of what the two phases
  differ by, rms.
- **By edge rays**: the thesis's jump. At each diameter rays that leave the detector while the
  diameter grows by 1 nm are taken out and those that enter it are put in, all others stay as they
  are: by how much the phase turns, rms. `edge_amplitude` is the sum of their amplitudes over that
  of all.
- **Scatter**: the local slope less that of the line through the phase, rms.
- **Effective rays**: (Σ|E|)²/Σ|E|², as a falloff without an edge detects thousands that carry
  nothing.
- **Maxwell's**: scheme `fullwave` at the same diameters and foci, whose detector is the mode of the
  pupil (a 5 µm fibre unless `objective.pupil` is given), whatever the falloff. *Shape* is the
  spectrum over its mean, rms over band and diameters.

## At the run's radius, {radius} µm

{own}
About {edge_rays} rays enter or leave in a nanometre. By them a top hat moves the phase {top_hat}
times as much as the parabola, and its ray noise is {top_hat_noise} times as large: the parabola
cures what it was made for. What noise it still has is of its kink at the edge, as a Gaussian of the
same radius, which has none, has {bell} times less.

## Over the radius

Ray noise (mrad/nm):

{noise}
Turn of the phase by edge rays, rms (mrad/nm):

{edge}
Slope of the line through the phase (mrad/nm; by Maxwell's equations {maxwell}):

{slope}
Scatter (mrad/nm; by Maxwell's equations {maxwell_scatter}):

{scatter}
Signal (1 is all launched light in phase):

{signal}
## Beside Maxwell's equations

Slope, rms difference (mrad/nm):

{away}
Shape of the spectrum, rms difference over its mean:

{shape}
No falloff and no radius makes waves of rays: by Maxwell's equations the slope swings by
{maxwell_scatter} mrad/nm over the diameters ([validity.md](validity.md)). Two detectors are told
apart here only where their mean square differences are, by two standard errors over {blocks} blocks
of the diameters. Told from the closest one are: {unlike}. Of the others the one of the least ray
noise is recommended.

The fibre's mode is that of a core whose image has R_det, with `fibre_na`: a small core hardly
guides, its mode is far wider than the core, and it collects light that returns from beside the
focus; a large one guides more modes than this.
"""
