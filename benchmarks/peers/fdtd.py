"""Meep beside the reference in two dimensions: error and time over the resolution."""

import time
from typing import Any, NamedTuple

import numpy as np
from line_beam import LineBeam, Polarisation, Slide, detected, gaussian_beam, normal
from peers.others import DEBIAN, asked, table

SLIDE = Slide()
FOCUS, FILL, WAVENUMBER = 0.75, 0.5, 8.0
BAND = np.linspace(7.0, 9.6, 41)
RESOLUTIONS = (20, 40, 80)
HALF_WIDTH = 4.0
"""Of the current sheet, µm; the beam is 1e-3 of its height there."""
EXTENT_3D = 2 * HALF_WIDTH
"""That a scene in three dimensions would have along the cylinder, µm."""
Kind = tuple[Polarisation, int]


class Sheet(NamedTuple):
    """A current in the glass that sends out the beam of one wavenumber, and others' kin to it."""

    height: float
    """Of the sheet, µm."""
    beam: LineBeam
    """At `WAVENUMBER`."""

    @property
    def current(self) -> Any:
        """Its plane waves: a current over k_z is a field."""
        kz = normal(SLIDE.glass, WAVENUMBER, self.beam.kx)
        return self.beam.amplitude * kz * np.exp(1j * kz * self.height)

    def sent(self, k: float) -> LineBeam:
        """Return the beam at a wavenumber: the pupil is the same in k_x."""
        kz = normal(SLIDE.glass, k, self.beam.kx)
        return self.beam._replace(amplitude=self.current / kz * np.exp(-1j * kz * self.height))


def sheet_of(light: Polarisation, resolution: float) -> Sheet:
    """Return a sheet that lies on a row of Meep's grid, where its fields are not averaged."""
    height = -0.3 + (0.5 / resolution if light == "across" else 0)
    return Sheet(height, gaussian_beam(SLIDE, WAVENUMBER, FOCUS, FILL))


def by_meep(light: Polarisation, resolution: float) -> dict[str, Any]:
    """Let Meep find the overlap at `WAVENUMBER` and in the band."""
    sheet = sheet_of(light, resolution)
    x = np.linspace(-HALF_WIDTH, HALF_WIDTH, 3201)
    waves = sheet.current * sheet.beam.weight
    profile = (waves[:, None] * np.exp(1j * sheet.beam.kx[:, None] * x)).sum(axis=0)
    job = {
        "indices": SLIDE[:3], "gap": SLIDE.gap, "diameter": SLIDE.diameter, "light": light,
        "sheet": sheet.height, "half_width": HALF_WIDTH, "x": x.tolist(),
        "real": profile.real.tolist(), "imag": profile.imag.tolist(),
        "wavenumbers": [WAVENUMBER, *BAND.tolist()], "centre": 8.3, "spread": 3.0, "after": 20,
        "resolution": resolution,
    }  # fmt: skip
    found: dict[str, Any] = asked(DEBIAN, "meep_run.py", job)
    return found


def by_reference(light: Polarisation, resolution: float) -> tuple[Any, float]:
    """Return the same by partial waves, and the seconds that one wavenumber took."""
    sheet = sheet_of(light, resolution)
    began = time.perf_counter()
    values = [detected(SLIDE, k, sheet.sent(k), light) for k in (WAVENUMBER, *BAND.tolist())]
    return np.array(values), (time.perf_counter() - began) / len(values)


def section() -> str:
    """Measure, and write the page's part."""
    rows, rate, each, version, spectra = [], [], [], "", {}
    lights: tuple[Polarisation, ...] = ("along", "across")
    for light in lights:
        for resolution in RESOLUTIONS:
            meep = by_meep(light, resolution)
            truth, seconds = by_reference(light, resolution)
            found = np.array(meep["real"]) + 1j * np.array(meep["imag"])
            intensity, true_intensity = abs(found[1:]) ** 2, abs(truth[1:]) ** 2
            of_field = abs(found[0] - truth[0]) / abs(truth[0])
            of_spectrum = abs(intensity - true_intensity).max() / true_intensity.max()
            rows.append([
                light, str(resolution), f"{of_field:.2g}", f"{of_spectrum:.2g}",
                f"{meep['seconds']:.3g}",
            ])  # fmt: skip
            rate.append(meep["work"] / meep["scene_seconds"])
            each.append(seconds)
            version, spectra[resolution] = meep["version"], (of_spectrum, meep["seconds"])
    finest, (error, seconds) = RESOLUTIONS[-1], spectra[RESOLUTIONS[-1]]
    at_1e4 = seconds * (error / 1e-4) ** 1.5 / 3600
    cube = seconds * finest * EXTENT_3D / 3600
    head = [
        "light polarised … the cylinder", "pixels a µm", "relative error of the field, k = 8 /µm",
        "max abs(ΔI) / max I, k = 7 … 9.6 /µm", "seconds",
    ]  # fmt: skip
    per_wavenumber = 1e3 * float(np.median(each))
    slab = finest * EXTENT_3D
    return f"""Meep {version}. The reference takes {per_wavenumber:.2g} ms a wavenumber and
polarisation, to 1e-11.

{table(head, rows)}

A pulse has all wavenumbers, so these seconds are a spectrum's. Errors fall with the square of the
pixel, and seconds rise with the cube of their number: 1e-4 of the spectrum would take
{at_1e4:.2g} hours for a polarisation in two dimensions. In three, {EXTENT_3D:.0f} µm of the
cylinder at {finest} pixels a µm would be {slab:.0f} times as many pixels: at least {cube:.2g} hours
for a polarisation and a diameter, still at an error of {error:.1g}. Both are extrapolated, at
{np.median(rate) / 1e6:.3g} million pixels a second, the symmetry in x used."""
