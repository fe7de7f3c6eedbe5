"""How far a run's number can be trusted: what was measured of it, and what makes the rest."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr

from octsim.base.named import named
from octsim.config.scheme import scheme_of
from octsim.datasets.catalog import CATALOG
from octsim.phase.fringe_status import WITH_PHASE, FringeStatus
from octsim.report.markup import Html, details, element, joined, table
from octsim.report.shown import Shown
from octsim.report.words import capital, command, share, signed, with_error
from octsim.schemes.light import AccuracyStatus
from octsim.stages.beside_maxwell import beside
from octsim.studies.effects.variants import EffectStatus

FINE, LOOK, UNKNOWN = "fine", "look", "not measured"
_BESIDE = {
    "validity": ("Against full wave", "where rays are within 1, 3 and 10 % of Maxwell's equations"),
    "effects": ("Effects left out", "what each effect that is off would change"),
    "calibration": ("Error of the slope", "the standard error, and what makes it"),
}


class Row(NamedTuple):
    """One thing that bears on how far the number can be trusted."""

    about: str
    verdict: str
    said: Html


def trust(shown: Shown) -> Html:
    """Return the section on how far the number can be trusted."""
    rows = [
        element(
            "li",
            element("h3", one.about),
            element("span", one.verdict, class_="verdict", data_is=one.verdict),
            element("div", one.said),
            class_="trust",
        )
        for one in _rows(shown)
    ]  # fmt: skip
    tables = []
    if "effects" in shown.datasets:
        tables.append(details("Every effect that was tried", _effects(shown.datasets["effects"])))
    if "calibration" in shown.datasets:
        tables.append(
            details("What makes the standard error", _budget(shown.datasets["calibration"]))
        )
    heading = element("h2", "How far it can be trusted")
    return element("section", heading, element("ul", *rows, class_="plain"), *tables, id="trust")


def _rows(shown: Shown) -> Iterator[Row]:
    yield _accuracy(shown)
    yield _fringes(shown)
    slopes = shown.datasets.get("phase_slope")
    if slopes is not None and (said := beside(slopes)):
        compared = "not compared" not in said
        yield Row("Maxwell's equations, here", LOOK if compared else UNKNOWN, _sentence(said))
    for name, (about, what) in _BESIDE.items():
        if name in shown.datasets:
            yield _measured(name, about, shown.datasets[name])
            continue
        alone = " (in a config without a grid)" if shown.combination else ""
        how = joined(f"{capital(what)}{alone}: made by ", element("code", command(name)))
        yield Row(about, UNKNOWN, element("p", how))


def _sentence(text: str) -> Html:
    return element("p", f"{capital(text)}.")


def _accuracy(shown: Shown) -> Row:
    """Say whether the spectra have the accuracy that was asked for."""
    about, spectra = "Accuracy of the spectra", shown.datasets.get("spectra")
    if spectra is None:
        how = joined("There is no spectra.nc; made by ", element("code", command("")))
        return Row(about, UNKNOWN, element("p", how))
    error, status = spectra["intensity_error"].values, spectra["accuracy_status"].values
    known = error[np.isfinite(error)]
    estimate = (
        f"estimated error {np.median(known):.1e} of the largest intensity (median of {known.size} "
        f"spectra), at most {known.max():.1e}"
        if known.size
        else "no spectrum has an error that is known"
    )
    scheme, config = scheme_of(shown.config), shown.config
    if scheme.counts_rays:
        asked = f"{scheme.name} counts {config.tracing.rays} rays and has no accuracy to reach"
    else:
        reached = int((status == AccuracyStatus.REACHED).sum())
        asked = (
            f"accuracy {config.tracing.accuracy:g} asked for, reached by {reached} of "
            f"{status.size} spectra"
        )
    doubts = CATALOG["spectra"].doubts_of(spectra)
    fine = not doubts and not scheme.counts_rays
    said = joined(_sentence(f"{asked}; {estimate}"), _list(doubts))
    return Row(about, FINE if fine else LOOK, said)


def _fringes(shown: Shown) -> Row:
    """Say how many spectra have a fringe that a phase is read from."""
    about = "Fringes"
    found = next(
        (shown.datasets[name] for name in ("fourier", "phase_slope") if name in shown.datasets),
        None,
    )
    if found is None or "fringe_status" not in found:
        return Row(about, UNKNOWN, element("p", "No dataset of this run has a fringe_status."))
    status = found["fringe_status"].values
    seen = int(np.isin(status, WITH_PHASE).sum())
    doubts = CATALOG["fourier"].doubts_of(found)
    fine = bool((status == FringeStatus.VISIBLE).all())
    said = _sentence(f"a phase is read from {seen} of {status.size} spectra")
    return Row(about, FINE if fine else LOOK, joined(said, _list(doubts)))


def _measured(name: str, about: str, found: xr.Dataset) -> Row:
    """Say what a dataset beside the run comes to, and where it is to be doubted."""
    row = CATALOG[name]
    doubts = row.doubts_of(found)
    needed = name == "effects" and bool(found["needed"].any())
    said = _sentence(named(row.summary)(found))
    off = name == "validity" or needed or doubts
    return Row(about, LOOK if off else FINE, joined(said, _list(doubts)))


def _list(lines: list[str]) -> Html:
    return (
        element("ul", *(element("li", line) for line in lines), class_="doubts")
        if lines
        else Html()
    )


def _effects(found: xr.Dataset) -> Html:
    """Return the effects that were tried, the largest change of the mean slope first."""
    ranks = found["rank"].values
    order = sorted(range(ranks.size), key=lambda i: (ranks[i] == 0, ranks[i]))
    return table(
        "What each effect changes of the phase slope",
        [
            "Effect",
            "Change of the mean slope (mrad/nm)",
            "Relative",
            "Largest at one diameter (mrad/nm)",
            "Verdict",
        ],
        [_effect(found.isel(effect=place)) for place in order],
    )


def _effect(one: xr.Dataset) -> list[object]:
    change, noise = float(one["mean_slope_change"]), float(one["mean_slope_change_noise"])
    status = EffectStatus(int(one["effect_status"]))
    if not np.isfinite(change):
        verdict = status.name.lower().replace("_", " ")
    else:
        verdict = (
            "needed"
            if one["needed"]
            else "undecided: noise hides it"
            if one["undecided"]
            else "may stay off"
        )
    name = f"{one['effect'].item()}"
    worst = signed(float(one["worst_slope_change"]))
    return [
        name,
        with_error(change, noise),
        share(float(one["calibration_change"])),
        worst,
        verdict,
    ]


def _budget(found: xr.Dataset) -> Html:
    """Return what each tolerance makes of the slope's standard error, the largest first."""
    slope = np.abs(found["fixed_focus_phase_slope"])
    parts = (found["budget"] / slope).mean("diameter")
    order = np.argsort(-np.nan_to_num(parts.values, nan=np.inf), kind="stable")
    return table(
        "Standard error of the phase slope by what may differ, mean over the diameters",
        ["What may differ", "Standard error, relative"],
        [
            [str(parts["parameter"].values[i]).replace("_", " "), share(float(parts[i]))]
            for i in order
        ],
    )
