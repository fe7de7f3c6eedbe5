"""The page of the thesis's section 2, from interferometers.nc."""

import numpy as np
import xarray as xr
from markdown import table

_LENGTH = 9.0  # of the arm, µm, one way


def interferometers_page(found: xr.Dataset) -> str:
    """Write the page."""
    k, intensity = found["wavenumber"].values, found["michelson_intensity"].values
    closed = found["michelson_closed_form"].values
    strongest = int(found["michelson_magnitude"].values.argmax())
    arm, band = found["arm"].values, found["band_intensity"].values
    period = _period(k, intensity)
    mirror = _period(arm, found["one_wavelength_intensity"].values)
    ideal, two, three = (found.isel(case=place) for place in (0, 1, 2))
    return TEMPLATE.format(
        length=f"{_LENGTH:g}",
        there_and_back=f"{2 * _LENGTH:g}",
        error=f"{np.abs(intensity - closed).max() / closed.max():.0e}",
        period=f"{period:.4f}",
        expected=f"{np.pi / _LENGTH:.4f}",
        as_written=f"{np.pi / (2 * _LENGTH):.4f}",
        component=f"{float(found['depth'][strongest]):.2f}",
        step=f"{float(found['depth'][1]):.2f}",
        mirror=f"{1000 * mirror:.0f}",
        wavelength=f"{2e3 * np.pi / ((k[0] + k[-1]) / 2):.0f}",
        coherence=f"{np.abs(arm[np.abs(band - 1) >= 0.5]).max():.2f}",
        sinc=f"{1.8955 / (k[-1] - k[0]):.2f}",
        predicted=f"{float(found['predicted_phase_slope']):.3f}",
        ideal=_slope(ideal),
        two=_slope(two),
        two_error=f"{float(two['plates_error']):.0e}",
        three_error=f"{float(three['plates_error']):.0e}",
        three=_slope(three),
        thicknesses=str(found.sizes["diameter"]),
        cases=table(["", "mean", "scatter"], [_row(found.isel(case=i))
                                              for i in range(found.sizes["case"])]),
    )  # fmt: skip


def _period(x: np.ndarray, values: np.ndarray) -> float:
    """Return the mean distance of the maxima, each by the parabola through three samples."""
    inner = np.flatnonzero((values[1:-1] > values[:-2]) & (values[1:-1] >= values[2:])) + 1
    before, at, after = values[inner - 1], values[inner], values[inner + 1]
    places = x[inner] + (x[1] - x[0]) * (before - after) / (2 * (before - 2 * at + after))
    return float(np.diff(places).mean())


def _slope(one: xr.Dataset) -> str:
    mean, scatter = one["mean_phase_slope"], one["phase_slope_standard_deviation"]
    return f"{float(mean):.2f} ± {float(scatter):.2f}"


def _row(one: xr.Dataset) -> list[str]:
    names = ("mean_phase_slope", "phase_slope_standard_deviation")
    return [str(one["case"].item()), *(f"{float(one[name]):.2f}" for name in names)]


TEMPLATE = """# Interferometers: a reference arm, and plates

Written by `make docs` from `results/thesis/interferometers.nc`; do not edit. `snakemake
interferometers` makes it, in about half a minute.

The pipeline has the thesis's section 2: a Michelson interferometer follows eq. (1) to {error} of
its largest intensity, once ΔL is the difference *one way*, and two weak plates have a phase slope
of {two} mrad/nm (mean ± scatter over {thicknesses} thicknesses), where eq. (2) says {predicted}.

## A reference arm (§2.1)

```yaml
interferometer:
  reference: {{amplitude: 0.004, length: 9 um}}    # adds a e^(2ikL), L one way, from the focus
```

![A Michelson interferometer](figures/michelson.png)

The sample is the glass–water plane with the focus on it, from which all rays return in phase; the
arm returns as much. With L = {length} µm the maxima are {period} µm⁻¹ apart in k; those of
cos(2kL) are π/L = {expected} apart.

**Eq. (1) and its text are of two lengths.** The thesis defines an arm's length from the beam
splitter to the mirror *and back*. By that ΔL is {there_and_back} µm here, and the cos(2kΔL) of
eq. (1) would have its maxima {as_written} µm⁻¹ apart, twice as close. Either ΔL is one way, or the
2k of eq. (1) is to be k. The text before it is of the latter: a mirror that makes the arm half a
wavelength longer turns light to dark. octsim takes one way, as eq. (1) and the plates' cos(2ndk)
do.

The strongest component of the Fourier transform is at L = {component} µm, as near as the
components, {step} µm apart, allow: the thesis's peak at a distance 2ΔL.

With one wavelength ({wavelength} nm) the light oscillates with the mirror, every {mirror} nm one
way, half a wavelength, and tells no depth. With the whole band it fades: the last extremum with
half the contrast is {coherence} µm from equal lengths, and the envelope of a flat band,
sin(ΔkL)/(ΔkL), is at half at {sinc} µm. That is the coherence length, "on the order of 1 µm".

## Plates (§2.2)

```yaml
scene:
  layers: [glass, {{medium: neuron, thickness: swept}}, glass]   # from below
  cylinders: []
```

![Plates](figures/plates.png)

Layers without a cylinder are plates; one of them is `swept`, and takes the sweep's diameters as its
thicknesses. All three schemes have them: rays go to and fro between the planes as far as
`max_intersections`, `fullwave` sums all reflections (Airy's sum) of each plane wave of the pupil.

Light along the axis (NA 0.001) is that of Airy's sum, to {two_error} of its largest intensity with
two planes and {three_error} with three: a few rays of the rim miss it. Of two planes it is
*1 − cos(2ndk)*: only at one of them, into the denser medium, is the light turned by π. Slopes do
not depend on that.

Phase slopes in mrad/nm, by the thesis's Fourier transform, over {thicknesses} thicknesses:

{cases}
- **Two planes** are the ideal: {two}, beside {ideal} of cos(2ndk). The scatter is that of the
  transform, as the band holds no whole number of oscillations.
- **Three planes**, with a film of 0.7 µm of water below the plate, add the beats of the film, and
  of film and plate together. In the transform they are one broad peak: {three}.
- **A cone of light** meets the plate at angles, where its optical thickness is nd cos θ: by
  Maxwell's equations the slope falls with the aperture. The focus is in the middle of the plate,
  so both planes are out of focus; from NA 0.9 on what they return has no longer one depth, the
  strongest component changes, and a mean slope says nothing. The thesis's cylinder sends such light
  back to the focus, and plates do not.
"""
