"""The page of advice for the lab, written from `design.nc`; `generate.py` calls it."""

import json
from typing import Any

import numpy as np
import xarray as xr
from markdown import table

from octsim.config.units import parse_length
from octsim.studies.design.criteria import CRITERIA
from octsim.studies.design.settings import ACCURACY, STEP
from octsim.studies.design.study import best

PHOTONS = (1e4, 1e6, 1e8)
EXPANSIONS = (1.0, 10.0)
LAUNCHED = 1e9
FITTED, LIKELIEST = "sinusoid", "maximum_likelihood"


def design_page(found: xr.Dataset) -> str:
    """Write the page."""
    config = json.loads(found.attrs["config"])
    given = config["design"]
    own, band = config["objective"]["numerical_aperture"], str(found["band"].values[0])
    here, draws = found.sel(aperture=own, band=band), int(found["draws"])
    kinds = (FITTED, LIKELIEST)
    advice = [
        [f"{count:.0e}", f"{change:g}", f"`{name}`", *_setting(_at(found, count, change), name)]
        for name in kinds
        for count in PHOTONS
        for change in EXPANSIONS
    ]
    launched = [
        [f"{change:g}", f"`{name}`", *_setting(_at(found, detected(found), change), name)]
        for name in kinds
        for change in EXPANSIONS
    ]
    fitted = here.sel(estimator=FITTED)
    least = fitted["slope_error"].isel(fitted["rms_error"].argmin(("fill", "focus_offset")))
    budget = {"as it is best": least.transpose("parameter", ...)} | {
        f"fill {fill:g}": fitted["slope_error"].sel(fill=fill).transpose("parameter", ...)
        for fill in here["fill"].values
    }
    parameters = [str(name).replace("_", " ") for name in found["parameter"].values]
    return TEMPLATE.format(
        photons=f"{given['photons']:.0e}",
        expansion=f"{1e3 * parse_length(given['expansion']):g} nm",
        aperture=f"{own:g}", band=band, draws=draws,
        of_draws=f"{100 / np.sqrt(2 * (draws - 1)):.0f}", step=f"{1e3 * STEP:g}",
        fill_tolerance=f"{100 * config['calibration']['tolerances']['fill']:g}",
        accuracy=f"{ACCURACY:g}",
        launched_photons=f"{LAUNCHED:.0e}",
        missed=int((found["accuracy_status"] != 0).sum()), settings=found["accuracy_status"].size,
        reached=f"{float(found['intensity_error'].max()):.1e}",
        diameters=", ".join(f"{d:.3g}" for d in found["diameter"].values),
        advice=table(["photons", "expansion (nm)", "estimator", *SETTING_HEAD], advice),
        launched=table(["expansion (nm)", "estimator", *SETTING_HEAD], launched),
        short=_short(here, _at(found, detected(found), EXPANSIONS[-1])), fills=_fills(here),
        estimators=_estimators(found), criteria=_criteria(here),
        budget=table(
            ["", *parameters],
            [
                [name, *(f"{100 * _rms(one):.2g}" for one in of_each)]
                for name, of_each in budget.items()
            ],
        ),
    )  # fmt: skip


SETTING_HEAD = ["fill", "focus (nm)", "NA", "band", "error (pm)", "bound (pm)", "systematic (%)"]


def detected(found: xr.Dataset) -> xr.DataArray:
    """Return the photons that are detected of `LAUNCHED`."""
    return LAUNCHED * found["brightness"]


def _at(found: xr.Dataset, photons: Any, expansion: float) -> xr.Dataset:
    """Return the dataset for other photons in a spectrum, and another expansion, nm."""
    given = json.loads(found.attrs["config"])["design"]
    fewer = np.sqrt(given["photons"] / photons)
    times = expansion / (1e3 * parse_length(given["expansion"]))
    squared = (fewer * found["statistical_error"]) ** 2 + (times * found["systematic_error"]) ** 2
    return found.assign(
        rms_error=np.sqrt(squared.mean("diameter", skipna=False)),
        least_error=fewer * found["least_error"],
    )


def _short(here: xr.Dataset, launched: xr.Dataset) -> str:
    """Return the advice in three lines."""
    peaks = {name: here["criterion_offset"].sel(criterion=name).notnull() for name in CRITERIA}
    counted = [
        f"{name.replace('_', ' ')} at {int(there.sum())} of {there.size}"
        for name, there in peaks.items()
    ]
    at = best(launched.sel(estimator=[FITTED]))
    errors = {
        str(name): 1e3 * float(here["rms_error"].sel(estimator=name).min())
        for name in here["estimator"].values
    }
    ranked = sorted(errors, key=lambda name: errors[name])
    return SHORT.format(
        fill=f"{at['fill']:g}", aperture=f"{at['aperture']:g}",
        focus=f"{1e3 * at['focus_offset']:+.0f}", change=f"{EXPANSIONS[-1]:g}",
        ranked=", ".join(f"`{name}` {errors[name]:.3g}" for name in ranked),
        counted=", ".join(counted),
    )  # fmt: skip


SHORT = """\
- **Fill**: with the same light sent in, an expansion of {change} nm is known best by `sinusoid`
  with a fill of {fill} at NA {aperture}, the focus {focus} nm from the law's.
- **Estimator**: least error of each at the configured aperture and band, in pm: {ranked}.
- **Focus**: within the scan there is a peak, of all fills and diameters, of {counted}: look at
  what has one everywhere."""


def _rms(part: xr.DataArray) -> float:
    return float(np.sqrt((part**2).mean()))


def _relative(part: xr.Dataset) -> xr.DataArray:
    return np.sqrt((part["slope_error"] ** 2).sum("parameter", skipna=False))


def _setting(found: xr.Dataset, name: str) -> list[str]:
    """Return the best setting of an estimator as text."""
    at = best(found.sel(estimator=[name]))
    chosen = found.sel(at)
    return [
        f"{at['fill']:g}", f"{1e3 * at['focus_offset']:+.0f}", f"{at['aperture']:g}",
        str(at["band"]), f"{1e3 * float(chosen['rms_error']):.3g}",
        f"{1e3 * _rms(chosen['least_error']):.3g}", f"{100 * _rms(_relative(chosen)):.2g}",
    ]  # fmt: skip


def _fills(here: xr.Dataset) -> str:
    """Return what each fill gives at the law's focus, by two estimators."""
    middle = here.sel(focus_offset=0.0, method="nearest")
    rows = []
    for fill in here["fill"].values:
        one = middle.sel(fill=fill)
        row = [
            f"{fill:g}",
            f"{_rms(one['fringe_visibility']):.2f}",
            f"{_rms(one['brightness']):.1e}",
        ]
        for name in (FITTED, "fft", LIKELIEST):
            part = one.sel(estimator=name)
            row += [
                f"{1e3 * _rms(part['statistical_error']):.3g}",
                f"{100 * _rms(_relative(part)):.2g}",
            ]
        part = one.sel(estimator=FITTED)["phase_slope"]
        rows.append(
            [
                *row,
                f"{1e3 * _rms(one['least_error']):.3g}",
                f"{float(part.mean()):.2f} ± {float(part.std()):.2f}",
            ]
        )
    head = ["fill", "visibility", "brightness"]
    for name in (FITTED, "fft", LIKELIEST):
        head += [f"`{name}` (pm)", "(%)"]
    return table([*head, "bound (pm)", "slope (mrad/nm)"], rows)


def _estimators(found: xr.Dataset) -> str:
    names = [str(name) for name in found["estimator"].values]
    return table(
        ["estimator", *SETTING_HEAD], [[f"`{name}`", *_setting(found, name)] for name in names]
    )


def _criteria(here: xr.Dataset) -> str:
    """Return where each criterion finds the focus, and what is lost there."""
    fitted = here.sel(estimator=FITTED)
    rows = []
    for name in CRITERIA:
        for fill in here["fill"].values:
            one = fitted.sel(criterion=name, fill=fill)
            offset, peaks = one["criterion_offset"], int(one["criterion_offset"].notnull().sum())
            least = fitted.sel(fill=fill)["rms_error"].min()
            everywhere = peaks == offset.size
            rows.append([
                name.replace("_", " "), f"{fill:g}", f"{peaks} of {offset.size}",
                f"{1e3 * float(offset.mean()):+.0f}" if peaks else "–",
                f"{1e3 * float(offset.std()):.0f}" if peaks > 1 else "–",
                f"{100 * float(one['criterion_prominence'].mean()):.0f}",
                f"{1e3 * _rms(one['criterion_error']):.3g}" if everywhere else "–",
                f"{1e3 * float(least):.3g}",
            ])  # fmt: skip
    head = [
        "greatest", "fill", "peaks", "at (nm)", "scatter (nm)", "prominence (%)",
        "error there (pm)", "least error (pm)",
    ]  # fmt: skip
    return table(head, rows)


TEMPLATE = """# Advice for the lab

Written by `make docs` from `results/thesis/design.nc`; do not edit. `octsim run design` makes it
for a config of yours, minutes on two cores.

![How well an expansion is known](figures/design.png)

Which fill of the pupil, focus, aperture, band and estimator know a change of the diameter best?
Spectra are Maxwell's (scheme fullwave, to {accuracy}), whatever the run's scheme, of neurons of
{diameters} µm at rest. The focus is held while the neuron swells. An error has two parts:

- **statistical**: the standard error of one spectrum by its photons ({draws} draws of shot noise,
  which give it to {of_draws} % for one diameter), through the slope of the same estimator; the
  spectrum at rest is known from many. Beside it is the Cramér–Rao bound, the brightness unknown.
- **systematic**: what `calibration.tolerances` and a fill known to {fill_tolerance} % leave
  unknown of the slope, times the expansion. A slope is over ± {step} nm; of the diameter it is
  the change of the mean slope from one side to the other. It is the same in every spectrum and
  does not fall with photons.

Errors below are rms over the diameters, focus in nm above the law's. {missed} of {settings}
settings are not as accurate as asked; the largest estimated error of a spectrum is {reached} of
the largest intensity of its band, which for part of the band solved is more than what was asked
for.

{short}

The least of many settings is found where the draws happen to be small: differences below their
scatter say nothing, and an error a little below the bound is of that kind.

## What to choose

For photons detected in a spectrum, and an expansion:

{advice}
With the same light sent in, {launched_photons} photons of which a perfect mirror in the focus
would return all, wider pupils and other foci detect fewer:

{launched}
`sinusoid` is least squares whose frequency is held at that of the neuron at rest;
`maximum_likelihood` compares with modelled spectra, so that it is as good as the model is: its
systematic error has the tolerances, and no error of the model itself.

## Which estimator

Each at its best setting, {photons} photons and {expansion}:

{estimators}
`sinusoid_following` is the same sinusoid at the frequency of each diameter, which a lab does not
know while it measures; its slope is another, its noise the same.

## Which fill

At NA {aperture}, {band} and the law's focus, {photons} photons; (%) is the systematic error of
the slope:

{fills}
What makes the systematic error of `sinusoid`, in % of the slope, rms over diameters (and over the
foci of a fill):

{budget}
## How to find the focus

At NA {aperture} and {band}. A *peak* is a greatest value inside the scan of foci, at each
diameter; *prominence* is how far it is above the higher end of the scan; *error there* is that of
{expansion} by `sinusoid`, beside the least over the foci of that fill.

{criteria}
`visibility` is of the fringe of the neuron's far side over its offset; `depth peak` the height of
that fringe in the depth profile (the windowed transform at the neuron's optical depth).
"""
