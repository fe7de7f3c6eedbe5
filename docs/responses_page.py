"""The page of what else than a diameter moves a phase, from responses.nc."""

import json

import numpy as np
import xarray as xr
from markdown import table

from octsim.studies.responses.at_diameter import DRAWS, TRIAL
from octsim.studies.responses.quantities import CONFIGURED, WITH_MEMBRANE
from octsim.studies.responses.separability import MOST_GROWTH, Separability
from octsim.studies.responses.sources import SOURCES

_WORDS = {"thickness": "membrane's thickness"}
_OBSERVABLES = {
    "whole": "whole band", "near_side": "near side's light", "far_side": "far side's light",
    "component_1": "strongest component", "component_2": "second component",
}  # fmt: skip
_SOURCES = {
    "spectrum": "spectrum", "spectrum_of_known_brightness": "spectrum, brightness known",
    "bands": "phases of the bands", "components": "phases of two components",
}  # fmt: skip


def responses_page(found: xr.Dataset) -> str:
    """Write the page."""
    config = json.loads(found.attrs["config"])
    one = found.sel(diameter=1.4, method="nearest")
    thin, bare = one.sel(variant=WITH_MEMBRANE), one.sel(variant=CONFIGURED)
    membrane = config["responses"]["membrane"]
    return TEMPLATE.format(
        diameter=f"{float(one['diameter']):g}",
        membrane=f"{1e3 * float(membrane['thickness'].split()[0]):g} nm, n {membrane['index']:g}",
        photons=f"{float(found['photons']):.0e}".replace("e+0", "e"),
        least=f"{float(found['diameter'].min()):g}", most=f"{float(found['diameter'].max()):g}",
        phases=_phases(bare, thin), errors=_errors(bare), with_membrane=_errors(thin),
        apparent=_apparent(found), growth=f"{MOST_GROWTH:g}",
        correlation=f"{np.sqrt(1 - MOST_GROWTH**-2):.3f}", pairs=_pairs(bare),
        thin_pairs=_pairs(thin), trial=_trial(bare, thin), draws=DRAWS, change=f"{TRIAL:g}",
        bands=_bands(one), by_phases=_by_phases(bare), short=_short(bare, thin), told=_told(found),
    )  # fmt: skip


def _names(one: xr.Dataset) -> list[str]:
    """Return the quantities that a scene has."""
    there = np.isfinite(one["phase_response"].sel(observable="whole"))
    return [str(name) for name in one["quantity"].values[there.values]]


def _unit(one: xr.Dataset, name: str) -> str:
    return str(one["quantity_unit"].sel(quantity=name).item()).replace("1e-3", "10⁻³")


def _word(name: str) -> str:
    return _WORDS.get(name, name)


def _number(value: float, digits: int = 3) -> str:
    return f"{value:.{digits}g}".replace("-", "−") if np.isfinite(value) else "–"


def _phases(bare: xr.Dataset, thin: xr.Dataset) -> str:
    rows = []
    names = _names(thin)
    for observable in bare["observable"].values.tolist():
        cells = []
        for name in names:
            of = bare if name in _names(bare) else thin
            at = of.sel(observable=observable, quantity=name)
            error = float(at["phase_response_standard_error"])
            stated = f" ± {error:.2g}" if np.isfinite(error) else ""
            cells.append(f"{_number(float(at['phase_response']))}{stated}")
        place = bare["observable"].values.tolist().index(observable)
        noise = np.sqrt(float(bare["phase_noise_covariance"].sel(observable=observable)[place]))
        words = _OBSERVABLES.get(observable, observable.replace("_", " "))
        rows.append([words, *cells, _number(noise, 2)])
    head = [f"{_word(name)} (mrad per {_unit(thin, name)})" for name in names]
    return table(["phase of", *head, "shot noise (mrad)"], rows)


def _apparent(found: xr.Dataset) -> str:
    rows = []
    bare, thin = found.sel(variant=CONFIGURED), found.sel(variant=WITH_MEMBRANE)
    names = [name for name in _names(thin.isel(diameter=0)) if name != "diameter"]
    for at in range(found.sizes["diameter"]):
        cells = []
        for name in names:
            of = bare if name in _names(bare.isel(diameter=0)) else thin
            one = of.isel(diameter=at).sel(quantity=name)
            whole = float(one["apparent_expansion"].sel(observable="whole"))
            shape = float(one["apparent_expansion_of_shape"])
            cells.append(f"{_number(whole)} ({_number(shape)})")
        rows.append([f"{float(found['diameter'][at]):g}", *cells])
    head = [f"{_word(name)}, {_unit(found, name)}" for name in names]
    return table(["d (µm)", *(f"nm per {one}" for one in _swapped(head))], rows)


def _swapped(head: list[str]) -> list[str]:
    return [f"{unit} of {name}" for name, unit in (one.split(", ") for one in head)]


def _errors(one: xr.Dataset) -> str:
    names, rows = _names(one), []
    for source in SOURCES:
        of = one.sel(source=source)
        for name in names:
            status = Separability(int(of["separability"].sel(quantity=name)))
            alone, together = (
                1e3 * float(of[f"error_{kind}"].sel(quantity=name))
                for kind in ("alone", "together")
            )
            rows.append([
                _SOURCES[source], _word(name), _number(alone, 2), _number(together, 2),
                _number(together / alone, 2), f"`{status.name}`",
            ])  # fmt: skip
    head = ["by", "quantity", "alone", "all together", "growth", ""]
    return table(head, rows)


def _pairs(one: xr.Dataset) -> str:
    names = _names(one)
    of = one.sel(source="spectrum")
    rows = []
    for name in names:
        row = of["error_with_other"].sel(quantity=name).values
        places = [of["quantity"].values.tolist().index(other) for other in names]
        rows.append([_word(name), *(_number(1e3 * row[place], 2) for place in places)])
    return table(["error of, with unknown", *map(_word, names)], rows)


def _by_phases(one: xr.Dataset) -> str:
    """Return the growth of errors by phases, two quantities at a time."""
    names, rows = _names(one), []
    places = [one["quantity"].values.tolist().index(name) for name in names]
    for source in ("bands", "components"):
        of = one.sel(source=source)
        growth = of["error_with_other"].values / of["error_alone"].values[:, np.newaxis]
        for at, name in zip(places, names, strict=True):
            cells = [_number(growth[at, other], 2) if other != at else "" for other in places]
            rows.append([_SOURCES[source], _word(name), *cells])
    return table(["by", "error of, with unknown", *map(_word, names)], rows)


def _trial(bare: xr.Dataset, thin: xr.Dataset) -> str:
    rows = []
    for words, one in (("as it is", bare), ("with a membrane", thin)):
        of = one.sel(source="spectrum")
        rows += [
            [
                words, _word(name), _number(1e3 * float(one["trial_bias"].sel(quantity=name)), 2),
                _number(1e3 * float(of["error_together"].sel(quantity=name)), 2),
                f"{100 * float(one['trial_coverage'].sel(quantity=name)):.0f}",
            ]
            for name in _names(one)
        ]  # fmt: skip
    return table(["neuron", "quantity", "mean error (10⁻³ units)", "stated", "within it (%)"], rows)


def _bands(one: xr.Dataset) -> str:
    ends = zip(one["band_min"].values, one["band_max"].values, strict=True)
    return " and ".join(f"{1e3 * a:.0f} to {1e3 * b:.0f} nm" for a, b in ends)


def _told(found: xr.Dataset) -> str:
    """Return at how many of the diameters each pair is told apart, by the spectrum."""
    rows = []
    for words, variant in (("as it is", CONFIGURED), ("with a membrane", WITH_MEMBRANE)):
        one = found.sel(variant=variant, source="spectrum")
        names = _names(found.sel(variant=variant).isel(diameter=0))
        codes = one["separability_with_other"]
        where = [one["quantity"].values.tolist().index(name) for name in names]
        for at, name in zip(where, names, strict=True):
            rows.append([
                words, _word(name),
                *(
                    str(int((codes[:, at, other] == 0).sum())) if other != at else ""
                    for other in range(one.sizes["quantity"])
                    if other in where
                ),
                *["–"] * (one.sizes["quantity"] - len(where)),
                str(int((one["separability"][:, at] == 0).sum())),
            ])  # fmt: skip
    every = [_word(str(name)) for name in found["quantity"].values]
    return table(["neuron", "diameters of which", *(f"with {w}" for w in every), "all"], rows)


def _short(bare: xr.Dataset, thin: xr.Dataset) -> str:
    """Return what a lab needs to know, in lines."""

    def apparent(one: xr.Dataset, name: str) -> str:
        return _number(float(one["apparent_expansion"].sel(observable="whole", quantity=name)), 2)

    of = bare.sel(source="spectrum")
    alone, gap, together = (
        1e3 * float(value) for value in (
            of["error_alone"].sel(quantity="diameter"),
            of["error_with_other"].sel(quantity="diameter")[1],
            of["error_together"].sel(quantity="diameter"),
        )
    )  # fmt: skip
    return SHORT.format(
        gap=apparent(bare, "gap"), index=apparent(bare, "index"),
        thickness=apparent(thin, "thickness"), alone=f"{alone:.2g}", with_gap=f"{gap:.2g}",
        together=f"{together:.2g}",
    )  # fmt: skip


SHORT = """\
- One phase does not say what moved. A gap that grows by 1 nm looks like an expansion of {gap} nm,
  an index of the neuron that rises by 10⁻³ like {index} nm, a membrane that thickens by 1 nm, the
  neuron's outside held, like {thickness} nm.
- The shape of a spectrum tells more: a diameter is known to {alone} pm if nothing else moved, to
  {with_gap} pm if the gap may have moved too, to {together} pm if the index may have as well."""

TEMPLATE = """# Expansion by what?

Written by `make docs` from `results/thesis/responses.nc`; do not edit.

An action potential may change a neuron's diameter, its membrane's thickness, the gap below it or
its index: ions and water move, and the neuron may lift off. What each does to the phase at a held
focus, and how far it is told from the others, is `octsim run responses`, some minutes on two cores.
Spectra are by Maxwell's equations, as those of [calibration.md](calibration.md).

At {diameter} µm:

{short}

![Phase responses](figures/responses.png)

## Phase responses at {diameter} µm

- **diameter**: of the outermost surface, gap held; **gap**: below the neuron, which rises whole;
  **index**: of the neuron, inside its shells; **thickness**: of a shell, the outermost diameter
  held, so that the inside shrinks. Small changes add: a membrane that grows outwards by 1 nm is a
  thickness of 1 nm and a diameter of 2 nm more.
- The thesis's neuron has no membrane. So that its response is known too, the same neuron is given
  one (`responses.membrane`, {membrane}; variant `with_membrane`), whose thickness is the last
  column; the other columns are of the neuron as it is.
- Phases are of the calibration's estimator over the whole band and over sub-bands
  (`expansion.bands`, else the halves in k: {bands}), of the two
  strongest components of the run's Fourier transform, and of each side's light by itself, which an
  instrument that resolves depths would see against a reference arm. ± is by
  `calibration.tolerances`, and is the same error every time.

{phases}
A gap moves both sides alike, so against the reflection off the glass it turns the whole fringe; an
expansion moves the far side, and hardly the near one. Shot noise is of {photons} photons in a
spectrum. Halves of the band have less than one oscillation of the fringe: an estimator with an
offset and an amplitude that are free knows their phase badly.

## What another quantity looks like

Apparent expansion by the phase of the whole band and, in brackets, by the likeliest diameter of
the spectrum:

{apparent}
## What tells them apart

The spectrum I(k) has more than a phase: its derivatives by the quantities have different shapes.
Their Fisher information under Poisson noise is F = Σ ∂ᵢμ ∂ⱼμ / μ; its inverse is the covariance of
the maximum-likelihood estimate of all of them at once (`octsim.phase.estimators.changes`). An
unknown brightness is one more parameter, unless it is said to be known. Phases are weighed by their
own noise. Standard errors in 10⁻³ of the unit: pm, or 10⁻⁶ of the index.

**A status by one rule**: a quantity is `SEPARABLE` if what else is fitted makes its standard error
grow no more than {growth} times, which for two is a correlation below {correlation}. Beyond that
an error of one per cent of a response makes tens of per cent of a change: `NOT_SEPARABLE`, fit
fewer, hold one by another measurement, or take wider bands. Fewer phases than quantities are
`TOO_FEW`.

The neuron as it is, at {diameter} µm:

{errors}
By the spectrum, two at a time (10⁻³ of the unit):

{pairs}
By phases, how many times an error grows by one other quantity (of which beyond {growth} is
`NOT_SEPARABLE`):

{by_phases}
With a membrane:

{with_membrane}
{thin_pairs}
At how many of the diameters from {least} to {most} µm a spectrum tells them apart:

{told}
**Noisy spectra**: {draws} spectra with shot noise of a neuron of which all quantities have changed
by {change} units at once, solved by Maxwell's equations, and fitted with the straight responses:

{trial}
Where errors grow little the fits are as good as stated. Where they grow much so does the bend of
the spectrum over the change, small as it is, and with a membrane the stated error of a straight
model is far too small: another reason to heed the status. All of this is by shot noise; what is
not known of the instrument makes the same error of every change, and grows as well.

## Phases of several bands in a series of your own

```yaml
expansion:
  series: phases.csv               # time,phase_1,phase_2 and maybe phase_error_1,phase_error_2
  fit: [diameter, gap]
  bands: [[650 nm, 760 nm], [760 nm, 900 nm]]
```

`octsim run expansion` then takes the responses of these bands at `expansion.diameter` in the place
of the calibration. Weighted least squares give each quantity with its statistical error and, by
what `calibration.tolerances` does to the responses, its systematic one, and the covariances of
both; `reduced_chi_square` tells, where there are more phases than quantities, whether something
else has moved. Fewer bands than quantities, overlapping bands and changes beyond 5 units, where
responses are no longer straight, are refused; quantities that the bands can't tell apart have the
status `NOT_SEPARABLE`, in the dataset, the log and the figure. `fit: [diameter]` without bands is
as it was: by the calibration.
"""
