# From a config to the phase slope: the stages of a run, in the order that light meets them.
#
#   config ─┬─ focus_scan
#           ├─ focus_sweep ─ focus_law ─┐   (where sweep.focus is law)
#           └──────────────────── detections ─ spectra ─ phase_slope
#                                              (and paths)
#
# Each rule names the config keys that it reads and the script whose code it runs: nothing else
# makes it run again. Outputs are marked `update`: a script replaces them whole, at its end, so a
# run that fails leaves what was there.
import math
import os
import sys
from collections.abc import Callable
from pathlib import Path

from filelock import FileLock, Timeout
from octsim.config.models import Config
from octsim.base.errors import OctsimError
from octsim.base.files import require_folder
from octsim.stages.cost_estimate import check_budget, expected
from octsim.datasets.gallery import STAGES, TARGETS, figures_of
from octsim.config.grid import remarks
from octsim.stages.run_id import begin, is_latest
from octsim.config.load import load_config
from octsim.base.provenance import lock_file, source_digest
from octsim.datasets.catalog import keys_read, needs_law
from octsim.config.derive import parts_of
from octsim.stages.workload import SCATTERED, shares_of

try:
    # the files themselves too, as snakemake's own reading lets a key stand twice
    run = load_config(*workflow.configfiles, config)
    require_folder(Path(f"results/{run.run}"))
    estimate = expected(run)
    if estimate.is_large:
        print(f"octsim: {estimate}", file=sys.stderr)
except OctsimError as error:
    sys.exit(f"octsim: {error}")
if run.run == Config().run and run != Config():
    remark = "run: not given, so this goes to results/thesis in the place of the thesis itself"
    print(f"octsim: warning: {remark}", file=sys.stderr)
for remark in remarks(run):
    print(f"octsim: warning: {remark}", file=sys.stderr)

os.environ["OCTSIM_RUN"] = str(os.getpid())  # a job ends with the run that started it
if workflow.is_main_process:
    os.environ["OCTSIM_CORES"] = str(workflow.cores)
elif not is_latest(Path(f"results/{run.run}")):
    # queued on a cluster by a run that was killed: it must not touch what the next one makes
    sys.exit("octsim: this job's run has ended, and another of its name has begun")
# not workflow.cores, which in a job on a cluster are all that its node has
CORES = int(os.environ.get("OCTSIM_CORES", workflow.cores))
FIGURES = figures_of(run)
SHARES = shares_of(run)  # a stage that takes long is scattered over several jobs
LAW_SWEPT = f"results/{run.run}/focus_law.nc" if needs_law(run) else []
# of targets of a single config; a job of a grid says so at once, and no law is fitted for it
LAW = LAW_SWEPT if not run.grid.varied else []
# a measured series is a file of the user's; one that is not there is said by the job
SERIES = [file for file in [run.expansion.series] if file and Path(file).is_file()]
LOCK = FileLock(f"results/{run.run}/.lock")  # held from the start of a run to its end
# of other targets, what was asked for once: an archive has it too, brought up to date
BESIDE = [file for file in (f"results/{run.run}/{t}.nc" for t in TARGETS) if Path(file).is_file()]
SCRIPTS = Path(workflow.basedir) / "workflow" / "scripts"


wildcard_constraints:
    run=run.run,
    stage="|".join(SCATTERED),
    number=r"\d+",
    of=r"\d+",


def made_from(script: str, *keys: str) -> dict[str, object]:
    """Give what a rule's results follow from, besides its inputs: its code and what it reads.

    One value for the whole, as snakemake compares a rule's params as a set, without their names.
    """
    return {"code": source_digest(SCRIPTS / f"{script}.py"), **parts_of(run.to_dict(), *keys)}


def of_stage(stage: str) -> dict[str, object]:
    """Give what a stage's results follow from."""
    return made_from(stage, *keys_read(stage, run))


def shares(stage: str) -> list[str]:
    """Give the files that a stage is gathered from; none where it is one job."""
    of = SHARES[stage] if SHARES[stage] > 1 else 0
    return [f"results/{run.run}/shares/{stage}-{n}-of-{of}.npz" for n in range(1, of + 1)]


def hands(stage: str, beside: int = 1) -> int:
    """Give the threads of a stage that traces, unless shares do, with as many such jobs beside."""
    return 1 if SHARES[stage] > 1 else max(1, CORES // beside)


def needs(*stages: str) -> dict[str, Callable[[object, int], int]]:
    """Give what a job asks a cluster for: with a margin, and more each time it is tried."""
    cost = estimate.of(*stages)
    megabytes = math.ceil(600 + 1.5e-6 * cost.memory_bytes)  # and two snakemakes around it
    of = max((SHARES.get(stage, 1) for stage in stages), default=1)
    minutes = math.ceil(60 + 3 * cost.cpu_seconds / of / 60)
    return {
        "mem_mb": lambda _, attempt: attempt * megabytes,
        "runtime": lambda _, attempt: attempt * minutes,
    }


onstart:
    # what is to be made, which may be less than all, may take more than was confirmed
    stages = {job.rule.name for job in workflow.persistence.dag.needrun_jobs()}
    try:
        check_budget(run, estimate.of(*stages), Path(f"results/{run.run}"))
    except OctsimError as error:
        sys.exit(f"octsim: {error}")
    # one run of a name at a time; the lock goes with the process, however that ends
    try:
        LOCK.acquire(blocking=False)
    except Timeout:
        sys.exit(f"octsim: another run is at work on results/{run.run}; wait for it or stop it")
    begin(Path(f"results/{run.run}"))


onsuccess:
    for stage in ("spectra", "phase_slope"):
        found = Path(f"results/{run.run}/logs/{stage}.log")
        lines = found.read_text().splitlines() if found.is_file() else []  # asked for less
        told = [line for line in lines if line.startswith(("octsim: ", "phase slope", "mean "))]
        print(*told, sep="\n", end="\n" if told else "", file=sys.stderr)
    print(f"octsim: datasets and figures are in results/{run.run}/", file=sys.stderr)
    wanted = [Path(file).name for stage in SCATTERED for file in shares(stage)]
    for share in Path(f"results/{run.run}/shares").glob("*.npz"):
        if share.name not in wanted:  # of a run that was given up, cut otherwise
            share.unlink()


onerror:
    # snakemake notes a failed job's new params with the old output that it restores, and would
    # take that for up to date: mark it incomplete
    for failed in workflow.scheduler.failed:
        workflow.persistence.started(failed)


rule all:
    input:
        expand("results/{run}/{stage}.nc", run=run.run, stage=STAGES),
        expand(
            "results/{run}/figures/{figure}.{form}",
            run=run.run,
            figure=FIGURES,
            form=("png", "svg"),
        ),


rule share:
    input:
        focus_law=lambda wildcards: LAW_SWEPT if wildcards.stage == "detections" else [],
        shares=[],
    output:
        temp("results/{run}/shares/{stage}-{number}-of-{of}.npz"),
    log:
        "results/{run}/logs/shares/{stage}-{number}-of-{of}.log",
    resources:
        mem_mb=lambda wildcards, attempt: needs(wildcards.stage)["mem_mb"](wildcards, attempt),
        runtime=lambda wildcards, attempt: needs(wildcards.stage)["runtime"](wildcards, attempt),
    params:
        made_from=lambda wildcards: of_stage(wildcards.stage),
    message:
        "Trace share {wildcards.number} of {wildcards.of} of {wildcards.stage}"
    script:
        "workflow/scripts/{wildcards.stage}.py"


rule focus_scan:
    input:
        shares=shares("focus_scan"),
    output:
        update("results/{run}/focus_scan.nc"),
    log:
        "results/{run}/logs/focus_scan.log",
        points="results/{run}/logs/focus_scan.json",
    benchmark:
        "results/{run}/benchmarks/focus_scan.tsv"
    threads: hands("focus_scan", 2)
    resources:
        **needs("focus_scan"),
    params:
        made_from=of_stage("focus_scan"),
    message:
        "Scan the focus for one diameter"
    script:
        "workflow/scripts/focus_scan.py"


rule focus_sweep:
    input:
        shares=shares("focus_sweep"),
    output:
        update("results/{run}/focus_sweep.nc"),
    log:
        "results/{run}/logs/focus_sweep.log",
        points="results/{run}/logs/focus_sweep.json",
    benchmark:
        "results/{run}/benchmarks/focus_sweep.tsv"
    threads: hands("focus_sweep", 2)
    resources:
        **needs("focus_sweep"),
    params:
        made_from=of_stage("focus_sweep"),
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
    resources:
        **needs(),
    params:
        made_from=of_stage("focus_law"),
    message:
        "Fit Gaussians over the focus, and the focus law through their centres"
    script:
        "workflow/scripts/focus_law.py"


rule detections:
    input:
        # a given focus needs no law, and is not traced again when the law changes
        focus_law=LAW_SWEPT,
        shares=shares("detections"),
    output:
        update("results/{run}/detections.nc"),
    log:
        "results/{run}/logs/detections.log",
        points="results/{run}/logs/detections.json",
    benchmark:
        "results/{run}/benchmarks/detections.tsv"
    threads: hands("detections")
    resources:
        **needs("detections"),
    params:
        made_from=of_stage("detections"),
    message:
        "Trace the sweep over diameters"
    script:
        "workflow/scripts/detections.py"


rule spectra:
    input:
        detections="results/{run}/detections.nc",
    output:
        spectra=update("results/{run}/spectra.nc"),
        paths=update("results/{run}/paths.nc"),
    log:
        "results/{run}/logs/spectra.log",
    benchmark:
        "results/{run}/benchmarks/spectra.tsv"
    threads: CORES
    resources:
        **needs("spectra"),
    params:
        made_from=of_stage("spectra"),
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
    resources:
        **needs("phase_slope"),
    params:
        made_from=of_stage("phase_slope"),
    message:
        "Transform the spectra and differentiate their phase over the diameter"
    script:
        "workflow/scripts/phase_slope.py"


rule figures:
    input:
        **{
            stage: f"results/{run.run}/{stage}.nc"
            for stage in dict.fromkeys(sum(FIGURES.values(), ()))
        },
    output:
        update(
            expand(
                "results/{{run}}/figures/{figure}.{form}",
                figure=FIGURES,
                form=("png", "svg"),
            )
        ),
    log:
        "results/{run}/logs/figures.log",
    benchmark:
        "results/{run}/benchmarks/figures.tsv"
    threads: CORES
    resources:
        **needs("spectra", "phase_slope"),
    params:
        made_from=made_from("figures", "processing"),
    message:
        "Draw the figures"
    script:
        "workflow/scripts/figures.py"


rule stability:
    output:
        stability=update(expand("results/{run}/stability.nc", run=run.run)),
        figures=update(
            expand("results/{run}/figures/stability.{form}", run=run.run, form=("png", "svg"))
        ),
    log:
        f"results/{run.run}/logs/stability.log",
    benchmark:
        f"results/{run.run}/benchmarks/stability.tsv"
    threads: CORES
    resources:
        **needs(),
    params:
        made_from=of_stage("stability"),
    message:
        "Measure rounding at the extremes against 50 digits"
    script:
        "workflow/scripts/stability.py"


rule tradeoff:
    output:
        tradeoff=update(expand("results/{run}/tradeoff.nc", run=run.run)),
        figures=update(
            expand("results/{run}/figures/tradeoff.{form}", run=run.run, form=("png", "svg"))
        ),
    log:
        f"results/{run.run}/logs/tradeoff.log",
    benchmark:
        f"results/{run.run}/benchmarks/tradeoff.tsv"
    threads: CORES
    resources:
        **needs(),
    params:
        made_from=of_stage("tradeoff"),
    message:
        "Measure error and cost, one setting after the other"
    script:
        "workflow/scripts/tradeoff.py"


rule causes:
    input:
        focus_law=LAW,
    output:
        causes=update(expand("results/{run}/causes.nc", run=run.run)),
        figures=update(
            expand(
                "results/{run}/figures/{figure}.{form}",
                run=run.run,
                figure=("causes", "spike"),
                form=("png", "svg"),
            )
        ),
    log:
        f"results/{run.run}/logs/causes.log",
    benchmark:
        f"results/{run.run}/benchmarks/causes.tsv"
    threads: CORES
    resources:
        **needs(),
    params:
        made_from=of_stage("causes"),
    message:
        "Tell what makes the phase slope scatter, and spike"
    script:
        "workflow/scripts/causes.py"


rule estimators:
    input:
        focus_law=LAW,
    output:
        estimators=update(expand("results/{run}/estimators.nc", run=run.run)),
        figures=update(
            expand("results/{run}/figures/estimators.{form}", run=run.run, form=("png", "svg"))
        ),
    log:
        f"results/{run.run}/logs/estimators.log",
    benchmark:
        f"results/{run.run}/benchmarks/estimators.tsv"
    threads: CORES
    resources:
        **needs(),
    params:
        made_from=of_stage("estimators"),
    message:
        "Compare the estimators of the phase"
    script:
        "workflow/scripts/estimators.py"


rule calibration:
    input:
        focus_law=LAW,
    output:
        calibration=update(expand("results/{run}/calibration.nc", run=run.run)),
        figures=update(
            expand("results/{run}/figures/calibration.{form}", run=run.run, form=("png", "svg"))
        ),
    log:
        f"results/{run.run}/logs/calibration.log",
    benchmark:
        f"results/{run.run}/benchmarks/calibration.tsv"
    threads: CORES
    resources:
        **needs(),
    params:
        made_from=of_stage("calibration"),
    message:
        "Differentiate the phase over the diameter at a fixed focus and gap"
    script:
        "workflow/scripts/calibration.py"


rule expansion:
    input:
        # without a series the job says so at once, and nothing is calibrated for it
        series=SERIES,
        calibration=f"results/{run.run}/calibration.nc" if SERIES else [],
    output:
        expansion=update(expand("results/{run}/expansion.nc", run=run.run)),
        figures=update(
            expand("results/{run}/figures/expansion.{form}", run=run.run, form=("png", "svg"))
        ),
    log:
        f"results/{run.run}/logs/expansion.log",
    benchmark:
        f"results/{run.run}/benchmarks/expansion.tsv"
    resources:
        **needs(),
    params:
        made_from=of_stage("expansion"),
    message:
        "Turn a measured series of phases into nanometres"
    script:
        "workflow/scripts/expansion.py"


rule action_potential:
    input:
        focus_law=LAW,
        calibration=f"results/{run.run}/calibration.nc",
    output:
        action_potential=update(expand("results/{run}/action_potential.nc", run=run.run)),
        figures=update(
            expand(
                "results/{run}/figures/action_potential.{form}",
                run=run.run,
                form=("png", "svg"),
            )
        ),
    log:
        f"results/{run.run}/logs/action_potential.log",
    benchmark:
        f"results/{run.run}/benchmarks/action_potential.tsv"
    threads: CORES
    resources:
        **needs(),
    params:
        made_from=of_stage("action_potential"),
    message:
        "Simulate an action potential and recover it"
    script:
        "workflow/scripts/action_potential.py"


rule archive:
    input:
        rules.all.input,
        BESIDE,
        lock_file() or [],
    output:
        update(expand("results/{run}/{run}.zip", run=run.run)),
    log:
        f"results/{run.run}/logs/archive.log",
    benchmark:
        f"results/{run.run}/benchmarks/archive.tsv"
    params:
        # it holds the whole config but for what no result depends on, and maybe a day
        made_from=made_from("archive", "archive", *run.to_record()),
        day=os.environ.get("SOURCE_DATE_EPOCH", ""),
    message:
        "Pack the run for a data repository"
    script:
        "workflow/scripts/archive.py"
