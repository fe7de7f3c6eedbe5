"""The page of the diffraction limit by defocus, from diffraction.nc."""

import json

import numpy as np
import xarray as xr
from markdown import table

import octsim
from octsim.instrument.build import detector_of
from octsim.optics.effects import Waist
from octsim.studies.diffraction.study import EACH, FIBRE, ONE, RAYS, UNIFORM


def diffraction_page(found: xr.Dataset) -> str:
    """Write the page."""
    of = {name: found.sel(case=name) for name in map(str, found["case"].values)}
    each, exact = of[EACH], of[UNIFORM]
    config = octsim.load_config(json.loads(found.attrs["config"]))
    detector, aperture = detector_of(config), config.objective.numerical_aperture
    reach = Waist().rayleigh_range(config.objective_material, aperture, config.spectrum.middle)
    rim = reach * detector.objective_radius / detector.focus_distance
    return TEMPLATE.format(
        each_change=_signed(each["slope_change"], 3),
        one_change=_signed(of[ONE]["slope_change"], 3),
        one_local=f"{float(of[ONE]['local_slope_change']):.3f}",
        each_local=f"{float(each['local_slope_change']):.3f}",
        exact_change=_signed(exact["slope_change"], 2),
        fibre_change=_signed(of[FIBRE]["slope_change"], 2),
        rays_scatter=_scatter(of[RAYS]),
        each_scatter=_scatter(each),
        exact_scatter=_scatter(exact),
        fibre_scatter=_scatter(of[FIBRE]),
        rim=f"{rim:.2f}",
        detector=f"{detector.radius:.2f}",
        inner=f"{100 * (detector.radius / rim) ** 2:.0f}",
        fainter=f"{_height(of[RAYS], 'glass') / _height(each, 'glass'):.0f}",
        middle=", ".join(f"{_share(one, 'middle'):.1g}" for one in (of[RAYS], each, exact)),
        far=", ".join(f"{_share(one, 'far side'):.1g}" for one in (of[RAYS], each, exact)),
        far_foci=", ".join(f"{_focus(one, 'far side'):.2f}" for one in (of[RAYS], each, exact)),
        middle_foci=", ".join(f"{_focus(one, 'middle'):.2f}" for one in (of[RAYS], each, exact)),
        glass_widths=", ".join(_width(one, "glass") for one in (of[RAYS], each, exact)),
        far_widths=", ".join(_width(one, "far side") for one in (of[RAYS], each, exact)),
        peaks=table(
            ["", *(f"{name}: focus, width (µm), height" for name in found["peak"].values)],
            [
                [name, *(_peak(one, peak) for peak in found["peak"].values)]
                for name, one in of.items()
            ],
        ),
        slopes=table(
            [
                "", "mean", "scatter", "mean less that of rays", "local difference, rms",
                *(f"mean, focus {_signed(1000 * by, 0)} nm" for by in found["focus_offset"]),
            ],
            [_slopes(name, one) for name, one in of.items()],
        ),
        diameters=str(found.sizes["diameter"]),
        rays_moved=_moved(of[RAYS]),
        each_moved=_moved(each),
        exact_moved=_moved(exact),
        fibre_moved=_moved(of[FIBRE]),
        apart=f"{1000 * float(np.ptp(found['focus_offset'].values)):.0f}",
        foci=str(found.sizes["focus"]),
    )  # fmt: skip


def _signed(value: xr.DataArray | float, digits: int) -> str:
    return f"{float(value):+.{digits}f}".replace("-", "−")


def _height(one: xr.Dataset, peak: str) -> float:
    return float(one["peak_height"].sel(peak=peak))


def _share(one: xr.Dataset, peak: str) -> float:
    return _height(one, peak) / _height(one, "glass")


def _focus(one: xr.Dataset, peak: str) -> float:
    return float(one["peak_focus"].sel(peak=peak))


def _scatter(one: xr.Dataset) -> str:
    return f"{float(one['phase_slope_standard_deviation']):.2f}"


def _width(one: xr.Dataset, peak: str) -> str:
    width = float(one["peak_width"].sel(peak=peak))
    return f"{width:.2f}" if np.isfinite(width) else "–"


def _peak(one: xr.Dataset, peak: str) -> str:
    focus = _focus(one, peak)
    if not np.isfinite(focus):
        return "none"
    return f"{focus:.2f}, {_width(one, peak)}, {_share(one, peak):.2g}".replace("-", "−")


def _slopes(name: str, one: xr.Dataset) -> list[str]:
    return [
        name,
        f"{float(one['mean_phase_slope']):.3f}",
        f"{float(one['phase_slope_standard_deviation']):.3f}",
        _signed(one["slope_change"], 3),
        f"{float(one['local_slope_change']):.3f}",
        *(f"{float(value):.3f}" for value in one["offset_phase_slope"]),
    ]


def _moved(one: xr.Dataset) -> str:
    below, above = one["offset_phase_slope"].values
    return _signed(above - below, 2)


TEMPLATE = """# The diffraction limit by defocus

Written by `make docs` from `results/thesis/diffraction.nc`; do not edit. `octsim run diffraction`
makes it, in about ten minutes of processor time, nearly all of it for rulings of each wavelength.

**Rulings are no substitute for diffraction**: they bring figure 6's peaks closer to Maxwell's in
height and place, but leave them several times too narrow, and they move the mean phase slope by
{each_change} mrad/nm, where Maxwell's equations move it by {exact_change} (with a fibre's mode
{fibre_change}): the wrong way. Nor do they make it less dependent on the focus. Who needs
diffraction takes `tracing: {{preset: exact}}`, which is faster than rulings of each wavelength.

The thesis leaves the diffraction limit out (its section 7), and suggests to emulate it by a bundle
that is defocused on purpose. That would broaden the peaks of figure 6, and may make the slope less
dependent on the focus. As rays it is done best as the *rulings* of a Gaussian beam: straight lines
whose envelope is the beam's hyperboloid, of waist λ/(π NA), both families at half the weight
(`beam: {{waist: diffraction}}`, for each wavelength or for one, [scenes.md](scenes.md)). Beside
them is `fullwave`, with the pupil that rays have, lit evenly, and with its own, a fibre's mode.

![Figure 6 and the phase slope](figures/diffraction.png)

## The peaks of figure 6

Focus, full width at half height and height over that of the glass's, at {foci} foci; a dash where
the intensity does not fall to half before it rises again.

{peaks}
In the order rays, rulings of each wavelength, Maxwell with the same pupil:

- **Heights**, the best part: over the glass's, the middle peak is {middle}, the far side's
  {far}.
  Plain rays that are focused on the glass all return, as with no diffraction. But the rulings'
  glass peak is {fainter} times fainter than that of rays: those of the pupil's rim cross the focal
  plane {rim} µm from the axis, and the detector's radius is {detector} µm, so that the inner
  {inner} % of them are detected at all.
- **Places**: the far side's peak is at {far_foci} µm, which is better; the middle one at
  {middle_foci} µm, which is not. By Maxwell's equations it hardly stands out from what is around.
- **Widths**: of the glass's peak {glass_widths} µm, of the far side's {far_widths} µm:
  wider, and not wide enough. How much of that is the detector's cut by position, where `fullwave`
  has the overlap with the pupil's mode, was not separated.

## The phase slope

Of a least-squares sinusoid at the nominal depth, over {diameters} diameters, the focus by the
thesis's law (0.581 d + 0.069 µm), in mrad/nm. The mean is the slope of the line through the phase;
the local difference from plain rays is without that of the means.

{slopes}
- **Mean**: rulings {one_change} (one wavelength) and {each_change} (each), Maxwell
  {exact_change} to {fibre_change}. Means by 3000 rays are known to about 0.005.
- **Scatter**: {rays_scatter} of rays, {each_scatter} of rulings, {exact_scatter} by Maxwell's
  equations ({fibre_scatter} with a fibre's mode), whose oscillation over the diameter has no
  counterpart in rulings.
- **Local differences**: {one_local} of one wavelength and {each_local} of each. The latter may
  be the estimator's, whose envelope is linear over the band, and not the phase's.
- **Focus**: over {apart} nm of focus the mean slope moves by {rays_moved} with rays, and by more,
  {each_moved}, with rulings, against the thesis's hope; by {exact_moved} by Maxwell's equations,
  {fibre_moved} with a fibre's mode.
"""
