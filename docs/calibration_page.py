"""Write the page of the calibration, from its dataset and that of the worked example."""

from pathlib import Path

import numpy as np
import xarray as xr
from markdown import table

from octsim.config.models import Config
from octsim.studies.calibration.expansion import expansion
from octsim.studies.calibration.parameters import parameter_named
from octsim.studies.calibration.round_trips import REST, TRIALS
from octsim.studies.calibration.scheme import ACCURACY
from octsim.studies.calibration.sensitivity import LARGEST, sensitivity_at
from octsim.studies.calibration.study import RAYS

TOLERANCE = {"um": "{0:g} nm", "rad": "{1:.3g}°", "1": "{2:g}"}
UNIT = {"um": "mrad/nm per nm", "rad": "mrad/nm per rad", "1": "mrad/nm"}
SHOWN = (1.0, 1.2, 1.4, 1.6, 1.8, 2.0)
EXAMPLE = (0.011, 1.4)  # rad, µm


def rms(values: xr.DataArray) -> float:
    """Give the root mean square."""
    return float(np.sqrt((values**2).mean()))


def span(values: xr.DataArray) -> str:
    """Write the least and the greatest of some values."""
    ends = float(values.min()), float(values.max())
    return " to ".join(f"{end:.2f}".replace("-", "−") for end in ends)


def percents(ratio: xr.DataArray) -> str:
    """Write the least and the greatest of some ratios, less one, in percent."""
    ends = float(ratio.min()) - 1, float(ratio.max()) - 1
    return " to ".join(f"{end:+.1%}".replace("-", "−") for end in ends)


def slopes(found: xr.Dataset) -> str:
    """Write the slopes at some diameters."""
    rows = []
    for diameter in SHOWN:
        one = found.sel(diameter=diameter, method="nearest")
        slope = float(one["fixed_focus_phase_slope"])
        error = float(one["fixed_focus_phase_slope_standard_error"])
        rows.append([
            f"{float(one['diameter']):.2f}",
            f"{slope:.3f} ± {error:.3f}",
            f"{1e3 * float(one['diameter_per_phase']):.2f} ± "
            f"{1e3 * float(one['diameter_per_phase_standard_error']):.2f}",
            f"{float(one['phase_curvature']):+.4f}",
            f"{float(one['focus_phase_slope']):+.3f}",
            f"{float(one['light_paths_phase_slope']):.3f}",
            f"{float(one['following_phase_slope']):.3f}",
            f"{float(one['fft_fixed_focus_phase_slope']):.3f}",
            f"{float(one['fft_following_phase_slope']):.3f}",
        ])  # fmt: skip
    head = [
        "d (µm)", "**slope** (mrad/nm)", "pm/mrad", "curvature (mrad/nm²)",
        "∂φ/∂focus (mrad/nm)", "by rays", "focus follows d", "fft, focus held",
        "fft, focus follows d",
    ]  # fmt: skip
    return table(head, rows)


def signed(value: float) -> str:
    """Write a sensitivity; what is but rounding is 0."""
    return "0" if abs(value) < 1e-9 else f"{value:+.3g}".replace("e-0", "e-")


def budget(found: xr.Dataset, config: Config) -> str:
    """Write the sensitivities at some diameters, and what the tolerances make of them."""
    ends = (SHOWN[0], EXAMPLE[1], SHOWN[-1])
    rows = []
    for name in found["parameter"].values.tolist():
        tolerance, unit = config.calibration.tolerances.of[name], parameter_named(name).unit
        sensitivity = [
            float(found[f"{name}_sensitivity"].sel(diameter=d, method="nearest")) for d in ends
        ]
        shares = found["budget"].sel(parameter=name) / found["fixed_focus_phase_slope"]
        checked = found["budget_error"].sel(parameter=name).max()
        rows.append([
            name.replace("_", " "),
            TOLERANCE[unit].format(1e3 * tolerance, np.degrees(tolerance), tolerance),
            *map(signed, sensitivity),
            UNIT[unit],
            *(f"{100 * float(shares.sel(diameter=d, method='nearest')):.3f}" for d in ends),
            f"{float(checked):.0e}",
        ])  # fmt: skip
    error = found["fixed_focus_phase_slope_standard_error"] / found["fixed_focus_phase_slope"]
    whole = [f"**{100 * float(error.sel(diameter=d, method='nearest')):.2f}**" for d in ends]
    rows.append(["all, and interpolation", "", "", "", "", "", *whole, ""])
    head = [
        "", "tolerance", *(f"sensitivity at {d:g} µm" for d in ends), "unit",
        *(f"% of the slope at {d:g} µm" for d in ends), "two rules differ by (mrad/nm)",
    ]  # fmt: skip
    return table(head, rows)


def most_shares(found: xr.Dataset) -> str:
    """Name the parameters that have most of the budget, with their mean share of the slope."""
    shares = (found["budget"] / found["fixed_focus_phase_slope"]).mean("diameter")
    largest = shares.sortby(shares, ascending=False)[:3]
    return ", ".join(
        f"{str(name).replace('_', ' ')} {100 * float(share):.1f} %"
        for name, share in zip(largest["parameter"].values, largest.values, strict=True)
    )


def trips(fired: xr.Dataset) -> str:
    """Write how often the stated error covers the truth."""
    names = ("coverage_noise", "coverage_instrument", "coverage_both")
    rows = []
    for number in range(fired.sizes["trip_diameter"]):
        one = fired.isel(trip_diameter=number)
        rows.append([
            f"{float(one['trip_diameter']):.2f}",
            *(f"{100 * float(one[name]):.1f}" for name in names),
            f"{1e3 * float(one['trip_statistical_error'].mean()):.1f}",
            f"{1e3 * float(one['trip_systematic_error'].mean()):.1f}",
            f"{100 * float(one['trip_bias']):+.2f}",
        ])  # fmt: skip
    rows.append([
        "all", *(f"**{100 * float(fired[name].mean()):.1f}**" for name in names), "", "",
        f"**{100 * float(fired['trip_bias'].mean()):+.2f}**",
    ])  # fmt: skip
    head = [
        "d (µm)", "noise alone: within 1σ (%)", "instrument alone (%)", "both (%)",
        "statistical (pm)", "systematic (pm)", "mean error (% of the expansion)",
    ]  # fmt: skip
    return table(head, rows)


def calibration_page(results: Path) -> str:
    """Write the page."""
    found = xr.load_dataset(results / "calibration.nc")
    fired = xr.load_dataset(results / "action_potential.nc")
    config = Config()
    slope = found["fixed_focus_phase_slope"]
    of_fft = found["fft_fixed_focus_phase_slope"] - slope
    chain = slope + found["focus_phase_slope"] * found["slope"] - found["following_phase_slope"]
    one, at = expansion(*EXAMPLE, found), sensitivity_at(EXAMPLE[1], found)
    by_rays = found["light_paths_phase_slope"].interp(diameter=EXAMPLE[1])
    off = 1e3 * (fired["expansion"] - fired["true_expansion"])
    fft_off = 1e3 * (fired["fft_expansion"] - fired["true_expansion"])
    truth = 1e3 * config.action_potential.expansion
    top = fired["true_expansion"] > 0.9 * fired["true_expansion"].max()
    stated = np.hypot(fired["statistical_error"], fired["systematic_error"])
    return TEMPLATE.format(
        example=f"{1e3 * float(one.expansion):.0f} ± {1e3 * float(one.systematic_error):.0f} pm",
        example_slope=f"{at.slope:.2f} ± {at.standard_error:.2f}",
        thesis_example=f"{1e3 * 11 / float(found['predicted_phase_slope']):.0f} pm",
        rays_example=f"{1e3 * 11 / float(by_rays):.0f}",
        slopes=slopes(found),
        chain=f"{float(np.abs(chain).max()):.0e}",
        far=span(found["far_side_phase_slope"]),
        near=span(found["near_side_phase_slope"]),
        law=f"{float(found['slope']):.3f}",
        more=percents(slope / found["following_phase_slope"]),
        by_rays=percents(found["light_paths_phase_slope"] / slope),
        least=f"{float(slope.min()):.2f}",
        greatest=f"{float(slope.max()):.2f}",
        shift=percents(1 + found["slope_shift"] / slope),
        most_shares=most_shares(found),
        accuracy=f"{ACCURACY['fullwave']:.0e}".replace("e-0", "e-"),
        fft_rms=f"{rms(of_fft):.2f}",
        fft_max=f"{float(np.abs(of_fft).max()):.2f}",
        fft_percent=f"{100 * float(np.abs(of_fft / slope).max()):.1f}",
        step=f"{1e3 * config.calibration.step:g}",
        difference=f"{float(found['difference_error'].max()):.0e}",
        interpolation=f"{float(found['interpolation_error'].max()):.0e}",
        rays=RAYS,
        rays_rms=f"{rms(found['rays_phase_slope'] - found['light_paths_phase_slope']):.2f}",
        largest=f"{LARGEST:g}",
        straight=f"{100 * float(np.abs(found['phase_curvature'] / slope).max()) * 10 / 2:.1f}",
        budget=budget(found, config),
        photons=f"{config.action_potential.photons:.0e}".replace("e+0", "e"),
        off=f"{float(off.std()):.1f}",
        statistical=f"{1e3 * float(fired['statistical_error'].mean()):.1f}",
        trace_covered=f"{100 * float((np.abs(off) <= 1e3 * stated).mean()):.0f}",
        top=f"{float(off.where(top).mean()):+.1f}",
        fft_top=f"{float(fft_off.where(top).mean()):+.1f}",
        oscillation=f"{float((of_fft / slope).interp(diameter=EXAMPLE[1])):+.1%}".replace("-", "−"),
        most_oscillation=f"{float(np.abs(of_fft / slope).max()):.1%}",
        trips=trips(fired),
        trials=TRIALS,
        rest=REST,
        seed=int(fired["seed"]),
        many=fired["trip_expansion"].size,
        worst=f"{float(np.abs(fired['trip_expansion'] / truth - 1).max()):.0%}",
    )


TEMPLATE = """# From milliradians to nanometres

Written by `make docs` from `results/thesis/calibration.nc` and `action_potential.nc`; do not edit.

A phase that moved by 11 mrad, on a neuron 1.4 µm thick: with {example_slope} mrad/nm that is
{example} (the error is that of the calibration; that of the phase comes on top). The thesis's slope
would have said {thesis_example}, rays at a held focus {rays_example}.

A slope is nothing without what it is of. This one is by Maxwell's equations (scheme `fullwave`,
whatever the run's own), a pupil that the mode of a fibre fills (5 µm, at the magnification),
unpolarised light, the focus held where the law puts it, and the estimator `sinusoid` with the
frequency held. A lab gives its own pupil: `objective: {{pupil: {{gaussian: 0.5}}}}`, with `tracing:
{{preset: exact}}`. [design.md](design.md) says which pupil, focus and estimator know an expansion
best: a pupil that is less filled has a slope that moves less with the diameter.

```sh
.venv/bin/snakemake calibration --cores 2        # calibration.nc and its figure
.venv/bin/snakemake expansion --cores 2 --configfile mine.yaml     # a series of yours: expansion.nc
.venv/bin/snakemake action_potential --cores 2   # the worked example below
```

```python
calibration = octsim.calibration(config, law)  # or xarray.open_dataset("calibration.nc")
octsim.expansion(0.011, 1.4, calibration)  # rad, µm: nm, with both errors
```

![The slope and its error](figures/calibration.png)

## The focus is held

An action potential does not move the objective. The thesis's slope is the change of the phase from
one neuron to a thicker one, with the focus moved along the law in between; what an experiment sees
is the change at a focus and a gap that stay where they are. That slope is {more} from the one that
follows, and both depend on the diameter: held, it is {least} to {greatest} mrad/nm.

{slopes}
Slopes by rays (light paths to 1e-8) are {by_rays} from Maxwell's: rays have neither the diffraction
of the pupil nor its fibre ([validity.md](validity.md)). That is why the calibration is not by them
where it need not be.

The light of the far side by itself moves its phase by {far} mrad/nm and that of the near side by
{near}, though its lowest point stays where it is. The rest is the glass's own reflection, whose
beat with both sides the estimator does not tell from theirs. The chain rule, slope(follows) =
slope(held) + {law} ∂φ/∂focus, is obeyed by the columns to {chain} mrad/nm.

- **Phase**: by default a sinusoid of the held frequency 2nd, its offset and amplitude linear in k,
  is fitted by least squares; `calibration.estimator` names another
  ([estimators.md](estimators.md)), with its options in `processing`. The thesis's Fourier transform
  (`calibration: {{estimator: fft}}`, here beside it) is {fft_rms} mrad/nm rms away from that, at
  most {fft_max} ({fft_percent} %). A calibration serves the estimator that it was made with, and no
  other. What an estimator holds (frequency, component) it holds while anything moves.
- **Numbers**: the slope is taken over ±{step} nm and ±half of that, which agree to {difference}
  mrad/nm, on spectra at an accuracy of {accuracy}: the error of waves is the same on both sides of
  so small a step. Counted rays come and go at the detector's edge: over such a step the slope by
  {rays} of them is {rays_rms} mrad/nm rms from that by light paths. Between the diameters cubic
  splines are used; from every second one they are within {interpolation} mrad/nm.
- **Scheme**: `calibration: {{scheme: paths}}` calibrates by rays. How far these are from Maxwell's
  equations is then part of the standard error, as `model` in the budget. Where Maxwell's equations
  are not solved (an NA at or above the index of water) the calibration is by rays of itself, says
  why, and states no standard error: it is not known (`model_status`, and NaN).
- **Curvature**: at a held focus the slope itself changes as the neuron swells. `expansion` solves φ
  = s δ + c δ²/2; without c, 10 nm would be wrong by up to {straight} %. What the third order leaves
  is below the standard error; beyond {largest} nm it refuses.

## How sure it is

`calibration.tolerances` states how well each thing is known, as one standard deviation. The slope
is differentiated by each, and is found with each off at the five nodes of Gauss and Hermite's rule
for its normal deviates, within ±2.9 tolerances (what is beyond a limit is put at it). That says how
far it scatters and by how much it is shifted as a mean; the last column is how far a rule of three
is from that of five. Scatters are added in quadrature, with these differences, the errors of the
interpolation and of the finite differences; shifts are added as they are
(`slope_shift`, {shift} of the slope) and then in quadrature.

{budget}
On average most is by {most_shares}.
Any number of the scene can have a tolerance, by its dotted key, as
`scene.cylinders.1.x: 50 nm` or `scene.refractive_index.myelin: 0.005`; what it is of is then a line
of the budget by that name.
The table takes it that the focus is looked for on the neuron itself and found within the tolerance;
a diameter at rest that is misjudged then moves the focus with it. By waves the total intensity
mostly has no peak at the law's focus; what has is in [design.md](design.md). A neuron off the axis
has no first derivative, as it is the same to both sides, and still counts, most of all by its tails
(the round trips below). `fill` is relative, of what fills the pupil. `polarisation` turns linear
input, or else an analyser; without either it makes the light linear, by the sine of twice the
angle. By rays these three are not seen, and `detector_radius` is.

## A series of your own

```yaml
expansion: {{series: phases.csv, diameter: 1.4 um, rest: 20}}
```

CSV with the heading `time,phase` or `time (ms),phase (mrad),phase_error (mrad)`, or netCDF with
variables of these names and `units`; s and rad without a word. Phases may be wrapped, samples may
be missing (empty, or NaN). The first `rest` samples are of no expansion. What can't be right is
refused in a line that names the row of the file or the sample, both counted from 1: a diameter
outside the table, steps too large to unwrap, too few samples at rest, times that do not increase.
`statistical_error` is that of the phase, `systematic_error` that of the slope: the latter is the
same fraction of every sample, so no average makes it smaller.

A gap, an index or a membrane that changes moves the phase as an expansion does: by how much, and
how phases in several bands (`expansion.fit`, `expansion.bands`) tell them apart, is in
[responses.md](responses.md).

**How files are read**, those of spectra too: commas, semicolons or tabs stand between cells, points
before decimals, and every row has as many cells as there are headings. Text is UTF-8, quotes end on
their line, and # begins a note only where a line begins; the heading may be one of the notes above
the numbers, as `numpy.savetxt` writes it. `Time [ms]`, `phase/mrad`, `phase_mrad`,
`phase error (deg)`, `time (μs)` are read as they are meant; a second column of the same name, a
unit that is not known, and headings that may be meant as one of these (`t`, `phase_err`, `sigma`)
are refused by name. Other columns may stand beside. In netCDF what was never written (9.97e36), is
marked as missing or is out of the valid range is missing; elsewhere such numbers, and codes such as
-9999 far from all else, are refused.

**Errors**: without `phase_error` the scatter at rest is the error of every sample, widened to the
interval of Student's t that covers 68.3 % (1.32 times for 3 samples at rest, 1.03 for 20). A
scatter below Δ/√12, where Δ is the smallest step of the recorder, says nothing: the error of
rounding is stated, or NaN where no step is seen. `error_status` says which it is. A
`phase_error` that is 0, or five times off the scatter at rest, as of another unit, is asked about.

**Outliers**: one or two samples that are more than five standard deviations from the median of
themselves and their four neighbours (a Hampel filter) are named in a warning, and never are the
largest change that is told. `outliers: mark` adds the variable `outlier` and rings them in the
figure, `outliers: drop` takes them as missing, at rest too; a pulse of two samples' width is none.

**Drift**: `drift: linear` subtracts the straight line through the samples at rest in place of their
mean; far from them it is known less well, and `statistical_error` grows. With `drift: {{reference:
[[181, 200]]}}` more samples are at rest, from first to last and counted from 1, so that the line is
held at both ends. A drift at rest that is not subtracted is warned of.

## A worked example

Neurons move by about a nanometre in about a millisecond as they fire: Hill et al. (1977) saw a
crayfish axon contract by 1.8 nm within 1 ms, Iwasa and Tasaki (1980) squid axons swell, Akkin et
al. (2004) less than 1 nm for 1 ms on crayfish nerves by low-coherence reflectometry, Akkin,
Landowne and Sivaprakasam (2009) phases of squid axons by OCT, Ling et al. up to 3 nm on spiking HEK
cells (2018) and −0.7 to 0.9 nm on neurites (2020).

![A simulated action potential](figures/action_potential.png)

A neuron of 1.4 µm swells by 1 nm for 1 ms (a Gaussian, at half height). 20 000 spectra a second are
simulated at its diameter at that time, each with {photons} photons of shot noise, about what the
pixels of a line camera hold, and turned to nanometres by the calibration. The recovered trace is
{off} pm rms a spectrum from the truth, where {statistical} are stated; {trace_covered} % of it is
within its stated error. Around the top (above 90 %) it is {top} pm off as a mean, the thesis's way
(its transform's phase over its predicted slope) {fft_top} pm.
The thesis's slope is one for all diameters, pupils and foci; by itself, the oscillation of its
transform (its slope at a held focus, over the calibrated one) is {oscillation} here and up to
{most_oscillation} elsewhere, as the figure shows on the right.

**Round trips**: {trials} at each of some diameters between those of the table (seed {seed}). Each
knows {rest} noisy spectra at rest and one at 1 nm. With the instrument as believed only the
statistical error is stated; drawn from the tolerances (gap, indices, focus, ..., all at once)
without noise only the systematic one counts; then both.

{trips}
A standard error of what is normal covers 68 %; {many} trips tell it to about 1.5. What is not known
of the instrument is not normal, as the slope bends over it: more lies within the root of the mean
square, which is what is stated, and the tails are longer (the largest error of a trip is {worst} of
the expansion).

## Spectra of your own

A CSV file has a first column `wavelength (nm)`, or `wavenumber (1/um)` (2π/λ), and a column of
intensity for each spectrum, with a name of its own; a netCDF file has a variable intensity along
such a coordinate. Every value has to be there. The phases have to be those of the calibration's
estimator:

```python
from octsim.studies.calibration.study import calibrating

depth = config.scene.refractive_index.neuron * 1.4  # of the neuron's two sides, µm
estimate = octsim.phase_of(
    "spectra.csv", calibrating(config), depth, reference="source.csv", band=(0.65, 0.9)
)
phase = estimate.phase
octsim.expansion(phase - phase[0], 1.4, calibration)
```

`band` is the calibration's, `spectrum.wavelength` (µm). `reference` is the source's own spectrum,
in the same form and with the dark subtracted, as the spectra are; without it the source is taken
for flat. Heed the warnings: a source that is not flat, or samples that are cut, bend phases by far
more than their standard error ([phases.md](phases.md)). Raw files of a spectrometer go in by
[`octsim import`](measured.md), with all that comes before a phase.

## References

- T. Akkin, D. P. Davé, T. E. Milner, H. G. Rylander III, Detection of neural activity using
  phase-sensitive optical low-coherence reflectometry, *Optics Express* **12**, 2377–2386 (2004).
- T. Akkin, D. Landowne, A. Sivaprakasam, Optical coherence tomography phase measurement of
  transient changes in squid giant axons during activity, *Journal of Membrane Biology* **231**,
  35–46 (2009).
- B. C. Hill, E. D. Schubert, M. A. Nokes, R. P. Michelson, Laser interferometer measurement of
  changes in crayfish axon diameter concurrent with action potential, *Science* **196**, 426–428
  (1977).
- K. Iwasa, I. Tasaki, Mechanical changes in squid giant axons associated with production of action
  potentials, *Biochemical and Biophysical Research Communications* **95**, 1328–1331 (1980).
- T. Ling et al., Full-field interferometric imaging of propagating action potentials, *Light:
  Science & Applications* **7**, 107 (2018).
- T. Ling et al., High-speed interferometric imaging reveals dynamics of neuronal deformation during
  the action potential, *PNAS* **117**, 10278–10285 (2020).
"""
