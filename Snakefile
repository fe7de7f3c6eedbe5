# From a config to the phase slope: the stages of a run, in the order that light meets them.
#
#   config ─┬─ focus_scan
#           ├─ focus_sweep ─ focus_law ─┐   (where sweep.focus is law)
#           └──────────────────── detections ─ spectra ─ phase_slope
#
# Each rule names the config keys that it reads and the script whose code it runs: nothing else
# makes it run again. Outputs are marked `update`: a script replaces them whole, at its end, so a
# run that fails leaves what was there.
from pathlib import Path

from octsim.errors import ConfigError
from octsim.loading import load_config, parts_of
from octsim.provenance import source_digest

try:
    run = load_config(config)
except ConfigError as error:
    raise WorkflowError(str(error)) from None

SCRIPTS = Path(workflow.basedir) / "workflow" / "scripts"
INSTRUMENT = ("scene", "objective", "detector", "tracing")


wildcard_constraints:
    run=run.run,


def stage(name: str) -> str:
    """Give the file of a stage's dataset."""
    return f"results/{run.run}/{name}.nc"


def reads(*keys: str) -> str:
    """Give what stands in the config under some keys, as a rule's parameter."""
    return parts_of(run, *keys)


def code(script: str) -> str:
    """Give the digest of a script and of all of octsim that it uses, as a rule's parameter."""
    return source_digest(SCRIPTS / f"{script}.py")


rule all:
    input:
        stage("focus_scan"),
        stage("phase_slope"),
        expand(
            "results/{run}/figures/figure_{number}.{form}",
            run=run.run,
            number=(6, 7, 12),
            form=("png", "svg"),
        ),


rule focus_scan:
    output:
        update("results/{run}/focus_scan.nc"),
    log:
        "results/{run}/logs/focus_scan.log",
        points="results/{run}/logs/focus_scan.json",
    benchmark:
        "results/{run}/benchmarks/focus_scan.tsv"
    params:
        reads=reads(*INSTRUMENT, "spectrum", "focus_scan"),
        code=code("focus_scan"),
    message:
        "Scan the focus for one diameter"
    script:
        "workflow/scripts/focus_scan.py"


rule focus_sweep:
    output:
        update("results/{run}/focus_sweep.nc"),
    log:
        "results/{run}/logs/focus_sweep.log",
        points="results/{run}/logs/focus_sweep.json",
    benchmark:
        "results/{run}/benchmarks/focus_sweep.tsv"
    params:
        reads=reads(*INSTRUMENT, "spectrum", "focus_law"),
        code=code("focus_sweep"),
    message:
        "Measure the intensity over the focus for the diameters of the focus law"
    script:
        "workflow/scripts/focus_sweep.py"


rule focus_law:
    input:
        focus_sweep="results/{run}/focus_sweep.nc",
    output:
        gaussian_fits=update("results/{run}/gaussian_fits.nc"),
        focus_law=update("results/{run}/focus_law.nc"),
    log:
        "results/{run}/logs/focus_law.log",
    benchmark:
        "results/{run}/benchmarks/focus_law.tsv"
    params:
        code=code("focus_law"),
    message:
        "Fit Gaussians over the focus, and the focus law through their centres"
    script:
        "workflow/scripts/focus_law.py"


rule detections:
    input:
        # a given focus needs no law, and is not traced again when the law changes
        focus_law=stage("focus_law") if run.sweep.focus == "law" else [],
    output:
        update("results/{run}/detections.nc"),
    log:
        "results/{run}/logs/detections.log",
        points="results/{run}/logs/detections.json",
    benchmark:
        "results/{run}/benchmarks/detections.tsv"
    params:
        reads=reads(*INSTRUMENT, "sweep"),
        code=code("detections"),
    message:
        "Trace the sweep over diameters"
    script:
        "workflow/scripts/detections.py"


rule spectra:
    input:
        detections="results/{run}/detections.nc",
    output:
        update("results/{run}/spectra.nc"),
    log:
        "results/{run}/logs/spectra.log",
    benchmark:
        "results/{run}/benchmarks/spectra.tsv"
    params:
        reads=reads("spectrum"),
        code=code("spectra"),
    message:
        "Sum the detected rays to spectra"
    script:
        "workflow/scripts/spectra.py"


rule phase_slope:
    input:
        spectra="results/{run}/spectra.nc",
    output:
        fourier=update("results/{run}/fourier.nc"),
        phase_slope=update("results/{run}/phase_slope.nc"),
    log:
        "results/{run}/logs/phase_slope.log",
    benchmark:
        "results/{run}/benchmarks/phase_slope.tsv"
    params:
        reads=reads("processing", "scene.refractive_index.neuron"),
        code=code("phase_slope"),
    message:
        "Transform the spectra and differentiate their phase over the diameter"
    script:
        "workflow/scripts/phase_slope.py"


rule figures:
    input:
        focus_scan="results/{run}/focus_scan.nc",
        gaussian_fits="results/{run}/gaussian_fits.nc",
        focus_law="results/{run}/focus_law.nc",
        phase_slope="results/{run}/phase_slope.nc",
    output:
        update(
            expand(
                "results/{{run}}/figures/figure_{number}.{form}",
                number=(6, 7, 12),
                form=("png", "svg"),
            )
        ),
    log:
        "results/{run}/logs/figures.log",
    benchmark:
        "results/{run}/benchmarks/figures.tsv"
    params:
        code=code("figures"),
    message:
        "Draw the figures"
    script:
        "workflow/scripts/figures.py"
