"""The page of what rays are worth beside Maxwell's equations, from validity.nc."""

import json

import numpy as np
import xarray as xr
from markdown import table
from spike_page import number

_KINDS = (
    ("follows", "fft"), ("follows", "sinusoid"), ("held", "fft"), ("held", "sinusoid"),
)  # fmt: skip
_HEAD = ["focus follows, FFT", "follows, sinusoid", "held, FFT", "held, sinusoid"]


def validity_page(found: xr.Dataset) -> str:
    """Write the page."""
    paths = found.sel(ray_scheme="paths")
    wavelength = json.loads(found.attrs["config"])["spectrum"]["wavelength"]
    values = {
        "number": str(found.sizes["diameter"]),
        "first": f"{float(found['diameter'][0]):g}",
        "last": f"{float(found['diameter'][-1]):g}",
        "band": f"{wavelength['min']} to {wavelength['max']}",
        "slopes": table(["pupil", *_HEAD], _slopes(found)),
        "errors": table(["instrument", *_HEAD], [_errors(paths, name) for name in _names(found)]),
        "others": table(
            ["instrument", "phase (rad)", "visibility", "spectrum",
             "within 1, 3, 10 % (follows, sinusoid)"],
            [_others(paths, name) for name in _names(found)],
        ),
    }  # fmt: skip
    return TEMPLATE.format(**values)


def _names(found: xr.Dataset) -> list[str]:
    return [str(name) for name in found["case"].values]


def _spread(slopes: xr.DataArray) -> str:
    return f"{float(slopes.mean()):.2f} ± {float(slopes.std()):.2f}"


def _slopes(found: xr.Dataset) -> list[list[str]]:
    first = found.isel(case=0)
    rows = [
        [f"rays, scheme {scheme}", *(
            _spread(first["ray_phase_slope"].sel(
                ray_scheme=scheme, focus_mode=mode, estimator=estimator))
            for mode, estimator in _KINDS
        )]
        for scheme in found["ray_scheme"].values
    ]  # fmt: skip
    for case in np.flatnonzero(found["quantity"].values == "pupil").tolist():
        exact = found["exact_phase_slope"].isel(case=case)
        slopes = [_spread(exact.sel(focus_mode=mode, estimator=name)) for mode, name in _KINDS]
        rows.append([f"Maxwell, {exact['quantity_value'].item()}", *slopes])
    return rows


def _errors(paths: xr.Dataset, name: str) -> list[str]:
    one = paths.sel(case=name)

    def said(mode: str, estimator: str) -> str:
        kind = one.sel(focus_mode=mode, estimator=estimator)
        error, sure = kind["mean_slope_error"], kind["mean_slope_error_standard_error"]
        return f"{number(100 * error, '+.1f')} ± {float(100 * sure):.1f}"

    return [name, *(said(*kind) for kind in _KINDS)]


def _others(paths: xr.Dataset, name: str) -> list[str]:
    one = paths.sel(case=name)
    shares = one["share_within"].sel(focus_mode="follows", estimator="sinusoid")
    return [
        name,
        number(one["ray_phase_error"].mean(), "+.2f"),
        number(100 * one["ray_visibility_error"].mean(), "+.0f") + " %",
        number(100 * one["ray_spectrum_error"].mean(), ".0f") + " %",
        ", ".join(f"{float(100 * share):.0f} %" for share in shares),
    ]


TEMPLATE = """# Rays beside Maxwell's equations

Written by `make docs` from `results/thesis/validity.nc`; do not edit. `octsim run validity` makes
it, in about two minutes of processor time. For the configured instrument, and with one quantity
varied at a time, it compares both schemes of rays with the scheme `fullwave` (accuracy 1e-4) at
{number} diameters from {first} to {last} µm, {band}. Where a pupil is named it
weighs rays too, as they are launched; without `objective.pupil` it is even for rays, and a fibre's
mode for `fullwave`.

A slope is nothing without its pupil, focus and estimator. The focus follows the diameter by the
law, or is held while a slope is taken (as while a neuron fires). Estimators are the thesis's
Fourier transform, and a least-squares sinusoid with linear offset and amplitude at the nominal
depth of each diameter.

## Slopes (mrad/nm, mean ± scatter over the diameters)

{slopes}
## Error of the slope by light paths

Mean difference over the mean slope, with its standard error over the diameters, in %. A large
scatter is mostly the Fourier transform's, whose strongest component changes.

{errors}
## Error of phase, visibility and spectrum by light paths

The phase is that of the fringe at the middle of the band; the spectrum's error is rms over the
band, each spectrum over its own mean. The last column is the share of the diameters where the
slope is within 1, 3 and 10 %. The phase is off by about a radian, and the spectrum by half of its
mean: an absolute phase by rays says nothing. A slope with the focus held is high by more than one
whose focus follows.

{others}
![Where rays are within 1, 3 and 10 %](figures/validity.png)

## In every run by rays

The job of `phase_slope.nc` solves Maxwell's equations at five of the sweep's diameters and their
neighbours, to 1e-3, with the run's own focus and estimator, in about 0.3 s of processor time.
`exact_phase_slope` holds the slopes, figure 12 shows them, and the log says how far rays are off
on average and what `tracing: {{preset: exact}}` takes. `exact_status` says why nothing is
compared, if so: `beyond_scheme` (a numerical aperture at or above the index of water, or a scene
that `fullwave` can't do), `too_long` (large diameters), `other_estimator` (maximum likelihood),
`other_combination` (of a grid the first is compared), `no_focus`, `not_reached`, or `by_maxwell`,
where the run's own light is by Maxwell's equations.
"""
