"""Write what is made of the docs: the config's schema and reference, and the thesis's numbers.

Run by `make docs`, after `make results`.
"""

import json
import shutil
from pathlib import Path

import numpy as np
import xarray as xr
from archive_part import archive_part
from axons_page import axons_page
from calibration_page import calibration_page
from design_page import design_page
from detector_page import detector_page
from diffraction_page import diffraction_page
from effect_costs_part import effect_costs_part
from effects_page import effects_page
from estimators_page import estimators_page
from interferometers_page import interferometers_page
from markdown import table
from maxwell_part import claim
from pydantic import BaseModel
from responses_page import responses_page
from spike_page import spike_page
from validity_page import validity_page

import octsim
from octsim.config.derive import reference
from octsim.config.models import Config
from octsim.instrument.build import detector_of
from octsim.studies.tradeoff.settings import CONVERGED_SAMPLES, FINER

DOCS = Path(__file__).parent
RESULTS = DOCS.parent / "results" / "thesis"
CORES = ("4.0 um", "4.2 um", "4.4 um", "4.6 um", "4.8 um", "5.0 um")
THESIS_LAW = {"slope": 0.581, "intercept": "69 nm"}
SUMMARY = (
    "mean_phase_slope", "phase_slope_standard_deviation", "standard_deviation_from_ideal",
    "largest_deviation", "largest_deviation_diameter",
)  # fmt: skip


def summary(law: xr.Dataset, slopes: xr.Dataset) -> list[str]:
    """Give the focus law and the summary figures of a run as text."""
    figures = [f"{float(slopes[name]):.3f}" for name in SUMMARY]
    return [f"{float(law['slope']):.4f}", f"{1000 * float(law['intercept']):.1f}", *figures]


def run(core: str, focus: object = "law") -> list[str]:
    """Run the thesis's config with another fibre core, and maybe with a given focus."""
    overlay = {"detector": {"core_diameter": core}, "sweep": {"focus": focus}}
    config = octsim.load_config(overlay)
    law = octsim.focus_law(config, octsim.gaussian_fits(config, octsim.focus_sweep(config, 2)))
    spectra = octsim.spectra(config, octsim.detections(config, law, 2))
    slopes = octsim.phase_slope(config, octsim.fourier(config, spectra))
    return [f"{detector_of(config).radius:.3f}", *summary(law, slopes)]


def keys(model: type[BaseModel], values: dict[str, object], prefix: str = "") -> list[list[str]]:
    """Give a row for each key of the config: its path, default and meaning."""
    rows = []
    for name, field in model.model_fields.items():
        value, kind = values[name], field.annotation
        if isinstance(value, dict) and value and "num" not in value and isinstance(kind, type):
            rows += keys(kind, value, f"{prefix}{name}.")
        else:
            default = json.dumps(value).replace('"', "")
            rows.append([f"`{prefix}{name}`", f"`{default}`", field.description or ""])
    return rows


def config_reference() -> str:
    """Write the page of the config's keys."""
    rows = keys(Config, Config().to_dict())
    return CONFIG_TEMPLATE.format(keys=table(["key", "default", "meaning"], rows))


CONFIG_TEMPLATE = """# The config

Written by `make docs` from `octsim/config/models.py`; do not edit.

A file of yours holds only what differs from the defaults. Mappings merge deeply, everything else
replaces. Lengths are text with their unit (`5 nm`, `1.4 um`, `0.3 mm`); ranges are
`{{start, stop, num}}` or `{{start, stop, step}}`, evenly spaced, both ends included; the diameters
of sweep, focus law and calibration may also be a list, as `[1 um, 1.2 um, 1.5 um]`. Where null is
of the sweep, one range serves all: `octsim init` writes such a config. `config/schema.json` is the
same as a JSON Schema, with the limits of each value, for editors.

{keys}
`sweep.focus` is `law`, the line fitted through the focus law's points, or a line of your own as
`{{slope: 0.581, intercept: 69 nm}}`; slope 0 is a fixed focus.

Give a config by `--configfile`: snakemake reads what stands behind `--config` its own way, and all
but a run's name (`--config run=other`) is better written in a file.
"""


def results() -> str:
    """Write the page of the thesis's numbers."""
    stored = {
        stage: xr.load_dataset(RESULTS / f"{stage}.nc") for stage in ("focus_law", "phase_slope")
    }
    law, slopes = stored["focus_law"], stored["phase_slope"]

    def value(dataset: xr.Dataset, name: str, digits: int) -> str:
        return f"{float(dataset[name]):.{digits}f}"

    ideal = [
        value(slopes, name, 3)
        for name in ("mean_ideal_phase_slope", "ideal_phase_slope_standard_deviation")
    ]
    spread, off = "phase_slope_standard_deviation", "standard_deviation_from_ideal"
    thesis = [
        ["focus law, slope", "0.581", value(law, "slope", 4)],
        ["focus law, intercept (µm)", "0.069", value(law, "intercept", 4)],
        ["prediction (mrad/nm)", "23.14", value(slopes, "predicted_phase_slope", 3)],
        ["mean phase slope (mrad/nm)", "very close", value(slopes, "mean_phase_slope", 3)],
        ["scatter about the mean (mrad/nm)", "0.23", value(slopes, spread, 3)],
        ["scatter from the ideal slope (mrad/nm)", "0.19", value(slopes, off, 3)],
        ["largest spike at (µm)", "~1.15", value(slopes, "largest_deviation_diameter", 3)],
        ["ideal slope, mean ± scatter (mrad/nm)", "", " ± ".join(ideal)],
    ]
    head = [
        "R_det (µm)", "law, slope", "law, intercept (nm)", "mean slope", "scatter", "from ideal",
        "largest deviation", "at (µm)",
    ]  # fmt: skip
    return (TEMPLATE).format(
        thesis=table(["quantity", "thesis", "octsim"], thesis),
        radii=table(head, [run(core) for core in CORES]),
        given=table(head, [run(core, THESIS_LAW) for core in ("4.0 um", "4.4 um")]),
    )


TEMPLATE = """# The thesis's numbers

Written by `make docs` from `results/thesis/`; do not edit.

{thesis}
## What the detector's radius does

The thesis does not give the radius of the detector's image, R_det. The default is that of a fibre
with a 4.4 µm core at 20×. With everything else the thesis's, slopes in mrad/nm:

{radii}
The law's intercept and the scatter grow with R_det, which decides how much of the light off the
axis counts. No one radius gives all of the thesis's values at once: its law is that of the largest
radius of the table, its scatters are those of radii between 0.105 and 0.115 µm.

A few nanometres of focus matter as much: with the sweep focused by the thesis's own law,
0.581 d + 0.069 µm, instead of the fitted one (the law's columns are still the fitted),

{given}

The scatter moves by tenths with nanometres of focus, as it is made of a few spikes: with the fitted
law it is at the lower end of what other readings of the thesis give (0.25 ± 0.03), with the
thesis's own law in the middle.

How long a run takes is in [speed.md](speed.md).
"""


def stability() -> str:
    """Write the page of the errors at the extremes."""
    matrix = xr.load_dataset(RESULTS / "stability.nc")
    names = matrix["status"].attrs["flag_meanings"].split()
    counts = [
        [name.replace("_", " "), str(int((matrix["status"] == code).sum()))]
        for code, name in zip(matrix["status"].attrs["flag_values"], names, strict=True)
    ]
    compared = matrix.isel(cell=matrix["status"].isin([0, 1]))
    ordinary = compared.isel(cell=~compared["value"].isin(EDGES))
    thesis = matrix.sel(cell="default / none / ")
    diameters = Config().sweep.diameters
    step = (diameters.stop - diameters.start) / (diameters.num - 1)

    def worst(name: str, dataset: xr.Dataset) -> list[str]:
        place = int(np.nanargmax(dataset[name].values))
        cell = str(dataset["cell"].values[place])
        return [f"{float(dataset[name][place]):.1e}", cell.removesuffix(" / none / ")]

    rows = []
    for quantity, (text, unit) in QUANTITIES.items():
        error, share = f"{quantity}_error", f"{quantity}_share"
        name = f"{text} ({unit})" if unit else text
        row = [name, f"{float(thesis[error]):.1e}", *worst(error, ordinary)]
        rows.append([*row, *worst(share, compared)] if share in matrix else [*row, "", ""])
    head = ["error of", "thesis", "largest", "in", "largest share of the bound", "in"]
    return STABILITY_TEMPLATE.format(
        counts=table(["cells", ""], counts),
        worst=table(head, rows),
        least=float(thesis["single_phase_error"] / thesis["phase_error"]),
        slope=float(thesis["single_phase_error"]) / step,
        large=float((ordinary["single_phase_error"] > 1e-2).mean()) * 100,
        over=int((ordinary["phase_error"] > 1e-9).sum()),
    )


EDGES = ("tangent", "critical, glass", "critical, neuron")
QUANTITIES = {
    "phase": ("phase", "rad"),
    "amplitude": ("amplitude, relative", ""),
    "phase_slope": ("phase slope", "mrad/nm"),
    "spectrum": ("sum over rays, of its peak", ""),
    "launch": ("ray's place, of the radius", ""),
    "single_phase": ("phase in float32", "rad"),
    "single_amplitude": ("amplitude in float32", ""),
}
STABILITY_TEMPLATE = """# Rounding at the extremes

Written by `make docs` from `results/thesis/stability.nc`; do not edit. `make docs` runs
`octsim run stability`, about two minutes on two cores, which traces up to 100 rays a cell with 50
digits (`octsim/studies/stability/exact.py`, on mpmath) beside octsim's doubles. A cell is one
factor changed in one of five configs: the default; one with no gap, the focus on the glass and NA
1.5; a neuron of index 3.33; one 1 nm thick; one 1 mm thick below an objective 1 m away. *Wide* ones
have a detector that sees all that returns.

Inputs are the doubles of the config and of the rays' positions on the objective. The bound is
max(1e-9, 8 ε κ), in rad of phase at the largest wavenumber and relative for amplitudes; the
condition number κ = Σ |x ∂/∂x| is found by perturbing every input of the 50-digit run. Where the
two trees decide otherwise about a ray (met or missed, refracted or totally reflected, detected or
not), the 50-digit margin of a decision on its path must be within 8 ε times that margin's own
condition number: the cell is then called *edge*. Shares of the bound are upper limits: an error
below 1e-9 counts as its share of 1e-9.

{counts}
*Refused* are foci beyond the objective. *Warned* are gaps of 1e7 diameters and more, where the last
digit of a height turns the cylinder's normal, and diameters above 1 cm: octsim says so when it
reads such a config, as it does of an NA above the index of water, which brings rays close to the
critical angle.

![Errors at the extremes](figures/stability.png)

{worst}
*Largest* leaves out the cells whose rays are placed within a few units of the last place of a
tangent or of a critical angle, where any double is wrong as far as κ says; the shares include them.
Of all others {over} have a phase off by more than 1e-9 rad, each with NA above the index of water.
The phase slope is rounding alone: k (Λ(d + δ) − Λ(d − δ)) / 2δ of the brightest path through the
neuron, 2δ the sweep's step (d/50 if that is less), from the same two diameters in both tracers. The
sum is compared with `math.fsum` of terms that are rounded once.

## float32

The same formulas in float32, ray by ray: phases are {least:.0e} times as wrong in the thesis's
config, and off by more than 10 mrad in {large:.0f} % of the cells. Differences over a step of the
sweep divide that by nanometres: {slope:.2g} mrad/nm of phase slope in the thesis's config.
"""


def tradeoff() -> str:
    """Write the page of what accuracy costs."""
    trade = xr.load_dataset(RESULTS / "tradeoff.nc")

    def cells(one: xr.Dataset) -> list[str]:
        texts = [
            f"{scale * one[name].item():{form}}" if np.isfinite(one[name]) else "–"
            for name, scale, form in TRADE_COLUMNS.values()
        ]
        # of some diameters only: their time is scaled to the sweep
        return [*texts, "yes" if one["frontier"] else ""]

    each = [trade.isel(setting=i) for i in range(trade.sizes["setting"])]
    named = [
        [
            f"{'**this run**' if one['default'] else str(one['preset'].item())}",
            f"`{one['setting'].item()}`",
            *cells(one),
        ]
        for one in each
        if one["default"] or one["preset"].item()
    ]
    head = [*TRADE_COLUMNS, "efficient"]
    every = [[f"`{one['setting'].item()}`", *cells(one)] for one in each]
    targets = [
        [
            f"{float(one['target_error']):.2g}",
            str(one["target"].item()) if number == 0 else "",
            f"{float(one['rays_segments']):.3g}",
            "measured" if one["rays_measured"] else "by the power law",
            f"{float(one['paths_segments']):.0f}",
            f"{float(one['segments_ratio']):.0f}",
            f"{float(one['paths_segments_between']):.0f}",
            f"{float(one['segments_ratio_between']):.0f}",
        ]
        for number, one in enumerate(trade.isel(target=i) for i in range(trade.sizes["target"]))
    ]
    dropped = trade.isel(setting=trade["factor"] == "tracing.min_amplitude")
    check = trade.isel(setting=trade["factor"] == "reference")
    diameters = int(trade["diameters_traced"].where(trade["default"] == 1).max())
    part = trade["diameters_traced"].where(trade["factor"] == "tracing.rays")
    return TRADE_TEMPLATE.format(
        named=table(["", "setting", *head], named),
        targets=table(TARGET_HEAD, targets),
        every=table(["setting", *head], every),
        dropped=table(
            ["`min_amplitude`", "change of I(k)", "segments a diameter"],
            [
                [f"{float(v):g}", f"{float(c):.1e}", f"{float(s):.3g}"]
                for v, c, s in zip(
                    dropped["value"], dropped["intensity_change"],
                    dropped["segments_per_diameter"], strict=True,
                )
            ],
        ),
        exponent=f"{float(trade['rays_law_exponent']):.2f}".replace("-", "−"),
        claim=claim(trade),
        maxwell=trade.attrs["maxwell"],
        check=f"{float(check['worst_intensity_error'].max()):.1e}",
        diameters=diameters,
        part=int(part.min()),
        accuracy=reference(Config()).tracing.accuracy,
        most=reference(Config()).tracing.max_intersections,
        samples=CONVERGED_SAMPLES,
        finer=FINER,
        effects=effect_costs_part(trade),
    )  # fmt: skip


TRADE_COLUMNS = {
    # heading: variable, scale, format
    "error of I(k), worst": ("worst_intensity_error", 1, ".1e"),
    "median": ("median_intensity_error", 1, ".1e"),
    "above the accuracy": ("beyond_accuracy", 1, "d"),
    "of the phase slope, rms (mrad/nm)": ("phase_slope_rms_error", 1, ".1e"),
    "largest": ("phase_slope_largest_error", 1, ".1e"),
    "of the law's focus (nm)": ("focus_error", 1e3, ".1e"),
    "of the spectrum's shape from Maxwell, worst": ("maxwell_spectrum_worst_error", 1, ".1e"),
    "of the slope from Maxwell, rms (mrad/nm)": ("maxwell_slope_rms_error", 1, ".1e"),
    "segments a diameter": ("segments_per_diameter", 1, ".3g"),
    "CPU (s)": ("cpu_seconds", 1, ".3g"),
    "memory (MiB)": ("peak_memory", 1, ".1f"),
}
TARGET_HEAD = [
    "error", "", "rays: segments", "", "paths: segments, cheapest within it", "times fewer",
    "paths: between points", "times fewer",
]  # fmt: skip
TRADE_TEMPLATE = """# What accuracy costs

Written by `make docs` from `results/thesis/tradeoff.nc`; do not edit. `make docs` runs
`octsim run tradeoff`, some minutes on two cores. The same target measures a config of yours.

![Error over cost](figures/tradeoff.png)

One key of the config is varied at a time: `rays` and `min_amplitude` with the scheme `vogel`, the
accuracy of Maxwell's equations with `fullwave`, all else with `paths`, where the accuracy is 1e-6
unless it is what is varied. Errors are those from a scheme's own limit, unless they are said to
be from Maxwell: of `fullwave` that at 1e-9, of rays a reference, `paths` at {accuracy:g} and
{most} intersections, of the same diameters, foci and wavenumbers. With 1e-8 and 30 intersections
the latter moves by {check}, at {part} of the diameters. The error of I(k) is max |ΔI| / max I
over k, the worst and the median over the diameters, and at how many it is above the accuracy that
was asked for (fewer intersections than the light takes are no matter of the accuracy). The slope
of fewer or more `samples` is compared with that of {samples}, the slope of fewer or more
diameters with that of {finer} times the run's steps; the law's focus with the reference's, at its
largest difference over the sweep. A dash stands for what was not measured, or for a law without a
peak.

Costs are those of the sweep's {diameters} diameters on one thread: segments traced a diameter (for
`paths` those that look for the paths too), processor time to trace and sum, and by how much the
process's memory grew. Where there is no error of the slope, {part} diameters were traced and the
time is scaled to the sweep. Waves have no segments, their cost is time. *Efficient* is what no
other setting of rays beats in both segments and worst error. Time and memory are this machine's,
and differ from run to run.

## The presets, and the run itself

{named}
`tracing: {{preset: standard}}` takes one.

## Errors from Maxwell's equations

![Error from Maxwell over time](figures/truth.png)

They are measured from {maxwell}; each scheme has its own pupil, unless the config gives one
([scenes.md](scenes.md)), and all the same foci. Of a spectrum the *shape* is compared, I over its
mean over k, as what an intensity of 1 is differs between schemes. The slope is that of the Fourier
transform's strongest component, whose jumps are part of the rms.

{claim}
## What an effect costs

An effect that is off costs nothing. One that is on takes so many times as long as a point without
it, by each scheme; in brackets is what it changes, max |ΔI| / max I, both medians over a few
diameters. Where the way of light depends on the wavenumber (dispersion, a focal shift) counted
rays are traced again at so many wavenumbers as their interpolation to 2e-10 needs, and light
paths at few. A Gaussian falloff has no edge: its patches of the aperture are some 20 times as
large. The last rows are scenes: a sheath, a second plane, a neuron that is moved or turned. A dash
is what a scheme does not do, or has by itself. [effects.md](effects.md) and [axons.md](axons.md)
have what each changes of the phase slope.

{effects}

## Light paths beside counted rays

{targets}
The error of counted rays falls as segments^({exponent}). *Cheapest within it* is a setting that was
measured; *between points* interpolates along the efficient ones.

## Every setting

{every}
What `min_amplitude` changes by itself, largest change of I(k) over its maximum:

{dropped}"""


if __name__ == "__main__":
    schema = json.dumps(Config.model_json_schema(), indent=2) + "\n"
    (DOCS.parent / "config" / "schema.json").write_text(schema, encoding="utf-8")
    (DOCS / "config.md").write_text(config_reference(), encoding="utf-8")
    (DOCS / "results.md").write_text(results(), encoding="utf-8")
    archives = DOCS / "archives.md"
    archives.write_text(archive_part(archives.read_text("utf-8"), RESULTS), encoding="utf-8")
    (DOCS / "figures").mkdir(exist_ok=True)
    (DOCS / "stability.md").write_text(stability(), encoding="utf-8")
    (DOCS / "tradeoff.md").write_text(tradeoff(), encoding="utf-8")
    pages = {
        "spike": lambda: spike_page(xr.load_dataset(RESULTS / "causes.nc")),
        "estimators": lambda: estimators_page(xr.load_dataset(RESULTS / "estimators.nc")),
        "calibration": lambda: calibration_page(RESULTS),
        "validity": lambda: validity_page(xr.load_dataset(RESULTS / "validity.nc")),
        "diffraction": lambda: diffraction_page(xr.load_dataset(RESULTS / "diffraction.nc")),
        "interferometers": lambda: interferometers_page(
            xr.load_dataset(RESULTS / "interferometers.nc")
        ),
        "detector": lambda: detector_page(xr.load_dataset(RESULTS / "detector.nc")),
        "effects": lambda: effects_page(xr.load_dataset(RESULTS / "effects.nc")),
        "axons": lambda: axons_page(xr.load_dataset(RESULTS / "scenes.nc")),
        "responses": lambda: responses_page(xr.load_dataset(RESULTS / "responses.nc")),
        "design": lambda: design_page(xr.load_dataset(RESULTS / "design.nc")),
    }
    for name, page in pages.items():
        (DOCS / f"{name}.md").write_text(page(), encoding="utf-8")
    drawn = (
        "figure_12", "stability", "tradeoff", "truth", "causes", "spike", "estimators",
        "calibration", "action_potential", "detector", "effects", "design", "validity",
        "diffraction", "michelson", "plates", "responses", "scenes", "scene",
    )  # fmt: skip
    for figure in drawn:
        shutil.copy(RESULTS / "figures" / f"{figure}.png", DOCS / "figures" / f"{figure}.png")
