"""The page of what is in and around an axon, from scenes.nc."""

import json

import numpy as np
import xarray as xr
from markdown import table

from octsim.studies.scenes.cases import CaseStatus

_WORDS = {
    CaseStatus.MEASURED: "no fringe",
    CaseStatus.NOT_BY_THIS_SCHEME: "not by it",
    CaseStatus.TOO_LONG: "too long",
}
_BOUND = 0.01
_KNOWN = """By Maxwell's equations the slope at a held focus moves by more than {percent} % at some
diameter with: {moving}. By less everywhere with: {still}. Rays alone, which see less of light that
is out of focus than waves do, put these below {percent} %: {rays}."""
_HEAD = [
    "scene", "by paths: mean", "scatter", "by Maxwell: mean", "scatter", "worst",
    "phase by Maxwell (rad)",
]  # fmt: skip


def axons_page(found: xr.Dataset) -> str:
    """Write the page."""
    config = json.loads(found.attrs["config"])
    wavelength = config["spectrum"]["wavelength"]
    sinusoid = found.sel(estimator="sinusoid")
    first = sinusoid["scene_phase_slope"].isel(case=0).mean("diameter")
    return TEMPLATE.format(
        number=found.sizes["diameter"],
        first=f"{float(found['diameter'][0]):g}",
        last=f"{float(found['diameter'][-1]):g}",
        band=f"{wavelength['min']} to {wavelength['max']}",
        own=", ".join(
            f"{float(first.sel(scheme=scheme, focus_mode='held')):.2f} by `{scheme}`"
            for scheme in found["scheme"].values
        ),
        percent=f"{100 * found.attrs['tolerance']:g}",
        known=_known(sinusoid.sel(focus_mode="held")),
        held=table(_HEAD, _changes(sinusoid.sel(focus_mode="held"))),
        follows=table(_HEAD, _changes(sinusoid.sel(focus_mode="follows"))),
        tolerated=table(["scene", "by paths", "by Maxwell", "unit"], _tolerated(found)),
    )


def _changes(found: xr.Dataset) -> list[list[str]]:
    rows = []
    for name in found["case"].values[1:]:
        one = found.sel(case=name)
        row = [str(name)]
        for scheme in ("paths", "fullwave"):
            by = one.sel(scheme=scheme)
            why = _WORDS[CaseStatus(int(by["case_status"]))]
            values = [by["scene_mean_change"], by["scene_change_scatter"]]
            row += [_signed(values[0], why), _plain(values[1])]
        waves = one.sel(scheme="fullwave")
        phase = np.abs(waves["scene_phase_change"])
        rows.append([*row, _plain(waves["scene_worst_change"]), _plain(phase.mean())])
    return rows


def _known(found: xr.Dataset) -> str:
    """Say what moves the held slope by more than a percent somewhere, and what never does."""
    bound = _BOUND * float(found["scene_phase_slope"].isel(case=0).sel(scheme="fullwave").mean())
    moving, still, rays = [], [], []
    for name in found["case"].values[1:]:
        one = found["scene_worst_change"].sel(case=name)
        waves, paths = float(one.sel(scheme="fullwave")), float(one.sel(scheme="paths"))
        if np.isfinite(waves):
            (moving if waves > bound else still).append(str(name))
        elif paths <= bound:
            rays.append(str(name))
    return _KNOWN.format(
        percent=f"{100 * _BOUND:g}", moving="; ".join(moving) or "nothing",
        still="; ".join(still) or "nothing", rays="; ".join(rays) or "nothing",
    )  # fmt: skip


def _signed(value: xr.DataArray, otherwise: str) -> str:
    return f"{float(value):+.3f}".replace("-", "−") if np.isfinite(value) else otherwise


def _plain(value: xr.DataArray) -> str:
    return f"{float(value):.3f}" if np.isfinite(value) else "–"


def _tolerated(found: xr.Dataset) -> list[list[str]]:
    rows = []
    for name in found["case"].values[1:]:
        by = [found["tolerated"].sel(case=name, scheme=scheme) for scheme in ("paths", "fullwave")]
        if any(np.isfinite(one) for one in by):
            said = [f"{float(one):.2g}" if np.isfinite(one) else "–" for one in by]
            rows.append(
                [str(name), *said, str(found["quantity_unit"].sel(case=name).item()) or "1"]
            )
    return rows


TEMPLATE = """# Membranes, myelin, neighbours, a tilt and a cover glass

Written by `make docs` from `results/thesis/scenes.nc`; do not edit. `octsim run scenes` makes it
for the config's own scene, some minutes on two cores: one thing at a time is put into it, and the
phase slope is found at {number} diameters from {first} to {last} µm, {band}, by counted rays
(`vogel`), light paths (`paths`, 1e-4) and Maxwell's equations (`fullwave`, 1e-4). The slope is
that of a least-squares sinusoid at the depth of each diameter; the foci stay on the configured
line, which is not fitted anew. A sheath is part of the diameter, which is that of the outermost
surface, and keeps its thickness as the diameter changes. A neighbour is as thick as the middle of
the sweep and stands as far beside the thickest neuron of the sweep as its row says, so farther
beside a thinner one.

{known}

As configured the slope at a held focus is {own} (mrad/nm, mean over the diameters).

![What each scene changes](figures/scenes.png)

## The focus is held, as while a neuron fires

Changes of the slope from the configured scene's by the same scheme, in mrad/nm.

{held}
*Not by it*: scheme `fullwave` has no elevation. *Too long*: a cover as high takes half a
minute a point; `tracing: {{preset: exact}}` does such a scene by itself. A
change that is below the scatter over the diameters is none that a lab can take off: it is another
at each diameter.

## The focus follows the diameter

{follows}
## How well it must be known

By how much more of the quantity the slope at a held focus moves by {percent} % (rms over the
diameters), from one row of the tables above to the next.

{tolerated}
`calibration.tolerances` takes any of these by its key, as `scene.cylinders.0.shells.0.thickness:
5 nm`, and makes it part of the calibration's error ([calibration.md](calibration.md)).
"""
