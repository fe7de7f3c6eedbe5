"""The page of the estimators, written from `estimators.nc`; `generate.py` calls it."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from markdown import table

from octsim.studies.estimators.contenders import CONTENDERS
from octsim.studies.estimators.resolution import STEP
from octsim.studies.estimators.study import PHASES


def estimators_page(compared: xr.Dataset) -> str:
    """Write the page."""
    compared = compared.isel(estimator=compared["estimator"] != "run")
    each = [compared.isel(estimator=i) for i in range(compared.sizes["estimator"])]
    phases = compared.sel(estimator=list(PHASES))
    best = phases.isel(estimator=int(phases["converged_scatter"].values.argmin()))
    thesis, series = (compared.sel(estimator=n) for n in ("fft", "sinusoid_common_envelope"))
    single = compared.sel(estimator="sinusoid")
    beyond = single["resolution_over_bound"].isel(noise_diameter=slice(1, None))
    return TEMPLATE.format(
        best=best["estimator"].item(),
        scatter=f"{float(best['scatter']):.3f}",
        converged=f"{float(best['converged_scatter']):.4f}",
        spike=f"{abs(float(best['largest_spike'])):.2f}",
        fft=f"{float(thesis['scatter']):.2f}",
        fft_converged=f"{float(thesis['converged_scatter']):.2f}",
        fft_spike=f"{float(thesis['largest_spike']):+.2f}",
        times=f"{float(thesis['scatter'] / best['scatter']):.0f}",
        times_converged=f"{float(thesis['converged_scatter'] / best['converged_scatter']):.0f}",
        series=f"{float(series['resolution_over_bound'].max()):.2f}",
        single=f"{float(beyond.max()):.2f}",
        first=f"{float(compared['noise_diameter'][0]):.3g}",
        at_first=f"{float(single['resolution_over_bound'].isel(noise_diameter=0).max()):.1f}",
        worst_fft=f"{float(thesis['resolution_over_bound'].max()):.0f}",
        best_fft=f"{float(thesis['resolution_over_bound'].min()):.2f}",
        mean_fft=f"{float(compared['resolution_over_bound'].sel(estimator='fft_mean').max()):.2f}",
        seconds=f"{float(compared['estimator_seconds'].sum()):.2g}",
        true=f"{float(compared['path_phase_slope'].mean()):.3f}",
        mean=f"{float(compared['mean_path_slope'].mean()):.3f}",
        runs=int(compared["noise_runs"]),
        seed=int(compared["seed"]),
        read=f"{float(compared['read_noise']):g}",
        step=f"{1000 * STEP:g}",
        diameters=", ".join(f"{d:.3g}" for d in compared["noise_diameter"].values),
        options=table(
            ["estimator", "differs from the thesis's processing by"],
            [[f"`{name}`", _options(given)] for name, given in CONTENDERS.items()],
        ),
        slopes=table(SLOPE_HEAD, [_slopes(one) for one in each]),
        shot=_noise(compared, "resolution", ""),
        read_noise=_noise(compared, "read_noise_resolution", "read_noise_"),
        over=_over(compared, "resolution_over_bound"),
        misread=_misread(compared, each),
    )


def _options(given: Mapping[str, Any]) -> str:
    return f"`{json.dumps(given)}`".replace('"', "") if given else ""


def _number(value: xr.DataArray, form: str, scale: float = 1) -> str:
    return f"{scale * float(value):{form}}" if np.isfinite(value) else "–"


def _slopes(one: xr.Dataset) -> list[str]:
    return [
        f"`{one['estimator'].item()}`",
        *(
            _number(one[name], form)
            for prefix in ("", "converged_")
            for name, form in (
                (f"{prefix}scatter", ".4f"),
                (f"{prefix}largest_spike", "+.3f"),
                (f"{prefix}largest_spike_diameter", ".3f"),
                (f"{prefix}bias", "+.4f"),
            )
        ),
        _number(one["estimator_seconds"], ".3f"),
    ]


def _noise(compared: xr.Dataset, name: str, prefix: str) -> str:
    head = ["", *(f"{ratio:g} dB" for ratio in compared["snr"].values)]
    rows = [
        ["photons", *(f"{float(v):.3g}" for v in compared[f"{prefix}photons"])],
        ["**bound**", *(_number(v, ".4g", 1e6) for v in compared[f"{prefix}bound"])],
    ]
    rows += [
        [
            f"`{estimator}`",
            *(_number(v, ".4g", 1e6) for v in compared[name].sel(estimator=estimator)),
        ]
        for estimator in compared["estimator"].values
    ]
    return table(head, rows)


def _over(compared: xr.Dataset, name: str) -> str:
    """Tabulate the largest ratio of error to bound over the noise's ratios, for each diameter."""
    worst = compared[name].max("snr", skipna=False)
    head = ["", *(f"{d:.3g} µm" for d in compared["noise_diameter"].values)]
    return table(
        head,
        [
            [f"`{estimator}`", *(_number(v, ".2f") for v in worst.sel(estimator=estimator))]
            for estimator in compared["estimator"].values
        ],
    )


def _misread(compared: xr.Dataset, each: list[xr.Dataset]) -> str:
    scenes = [str(scene) for scene in compared["scene"].values]
    rows = [
        [
            f"`{one['estimator'].item()}`",
            *(
                f"{100 * float(mean):+.2f} ± {100 * float(scatter):.2f}"
                for mean, scatter in zip(
                    one["misreading"].values, one["misreading_scatter"].values, strict=True
                )
            ),
        ]
        for one in each
        if np.isfinite(one["misreading"]).all()
    ]
    offsets = [
        f"{round(1000 * float(off), 2) + 0.0:+.2f} nm" for off in compared["likelihood_offset"]
    ]
    return table(["", *scenes], [*rows, ["the diameter itself, by maximum likelihood", *offsets]])


SLOPE_HEAD = [
    "estimator", "scatter", "largest spike", "at (µm)", "bias",
    "converged: scatter", "largest spike", "at (µm)", "bias", "CPU (s)",
]  # fmt: skip
TEMPLATE = """# Estimators of the phase

Written by `make docs` from `results/thesis/estimators.nc`; do not edit. `make docs` runs
`octsim run estimators`, two to three minutes on two cores. The same target compares them on a scene of yours.

![Estimators of the phase](figures/estimators.png)

- **Least scatter**: `{best}`, by {scatter} mrad/nm on the thesis's counted rays and {converged} on
  converged spectra, no point more than {spike} from the trend. The thesis's method `fft` scatters by
  {fft} and {fft_converged}, with a spike of {fft_spike}: {times} and {times_converged} times as
  much. What is left by counted rays is their own noise.
- **Least noise**: `sinusoid_common_envelope`, at most {series} times the Cramér–Rao bound from 20
  to 60 dB, at every diameter: as good as maximum likelihood, which knows the model. `sinusoid`,
  which knows of no other spectrum, is within {single} above {first} µm; at {first} µm, little more
  than one oscillation can't tell a slope of the envelope from a phase, and it has up to {at_first}
  times the bound. The thesis's method is at {best_fft} times the bound at its best and {worst_fft}
  at its worst: the midpoint of a noisy spectrum is that of its two most extreme samples. `fft_mean`,
  which differs in that alone, is within {mean_fft}.

## What each is

Phases are those of cos(2 z (k − k_mid) + φ) at the middle of the band, where a depth z that is off
turns them least; `fft` has those of its components, as in the thesis. The depth is n_neuron ·
diameter, unless `processing.depth` is `peak` or a length. In this table, and in `estimators.nc`:

{options}
| `processing.estimator` | formula | source |
| --- | --- | --- |
| `fft` | arg of the strongest component Σ w (I − c) e^(−2πijm/K) | the thesis, §5 |
| `zero_padded` | arg Σ w (I − c) e^(−2iz(k − k_mid)): the component at z itself | the limit of many zeros; `scipy.signal.czt` is its check |
| `sinusoid` | least squares of I = Σ oⱼ xʲ + Re Σ cⱼ xʲ e^(2iz(k − k_mid)), φ = arg c₀, x from −1 to 1 over the band; all but z is linear and eliminated, a fitted z has real cⱼ/c₀ | variable projection: Golub and Pereyra, Inverse Problems 19, R1 (2003), in Kaufman's form |
| `hilbert` | transform, keep depths z (1 ± band), transform back, fit a line to the phase | Takeda, Ina and Kobayashi, J. Opt. Soc. Am. 72, 156 (1982) |
| `esprit` | eigenvalues of the shift between rows of the first singular vectors of a Hankel matrix | Roy and Kailath, IEEE Trans. ASSP 37, 984 (1989) |
| `fringe` | z = (m − 1) π / 2k_e from the wavenumber k_e of the extremum nearest to the middle, of order m; no phase | fringes of equal chromatic order: Israelachvili, J. Colloid Interface Sci. 44, 259 (1973) |
| `maximum_likelihood` | d of max Σ (y + σ²) ln(μ(d) + σ²) over modelled spectra μ; no phase | Snyder, Hammoud and White, J. Opt. Soc. Am. A 10, 1014 (1993), for the σ² |

Those without a phase give predicted_phase_slope · ∂d̂/∂d. `c` is `processing.centre`: the midpoint,
the mean, the mean weighted by the window, or a polynomial fitted with these weights. Weights of
`sinusoid` are equal, or those of shot noise, 1/(fitted intensity + read noise²).
`sinusoid: {{envelope: common}}` takes the polynomials of a series' mean for all of it: for phases
over time at one diameter. How well a phase of one spectrum is known, and when there is none, is in
[phases.md](phases.md).

## Slopes

`scatter` is the standard deviation about a polynomial of the fourth degree over the diameter;
`bias` the mean of the slope less that of the phase between the light that has been inside the
neuron and the rest, at the middle of the band, from the light paths themselves ({true} mrad/nm; the mean
path of the two times k has {mean}: rays of a focused beam add to a field whose phase is not that of
the mean path). mrad/nm; CPU time is for all diameters, together {seconds} s.

{slopes}
`maximum_likelihood` on converged spectra is on its own model, and exact by construction; its slope
is that of the prediction, from which the light's own differs. `fringe` has its spikes where the
extremum nearest to the middle is another one.

## Noise

Error of the diameter in pm, rms over {runs} seeded draws (seed {seed}) at each of {diameters} µm,
at a fixed focus. The error of a phase is divided by the slope that the same estimator has there. The
ratio is 10 log₁₀ of Σ(μ − μ̄)² / 2 mean(μ + σ²) with the counts μ and the read noise σ: the fringe's
peak in the depth profile over the noise there, as powers. The bound is 1/√F, F = Σ (∂μ/∂d)²/(μ +
σ²) with the brightness unknown, and ∂μ/∂d by differences of ±{step} and ±2 · {step} nm, which have to
agree. A dash is an estimator that found nothing in one of the draws.

Shot noise alone:

{shot}
Shot noise, and read noise of {read} photons a sample:

{read_noise}
Error over the bound under shot noise, the largest from 20 to 60 dB:

{over}
## Another scene than the model

How a change of diameter is misread, in %, mean ± scatter over the sweep, if spectra of another
scene are read with the slopes (for maximum likelihood the spectra) of the run's own. An index of the
neuron that is off is misread by all alike: no phase can tell it from a diameter.

{misread}"""  # noqa: E501
