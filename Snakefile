# From a config to the phase slope: the datasets of octsim/datasets/catalog.py, from first to last.
#
#   config ─┬─ focus_scan
#           ├─ focus_sweep ─ focus_law ─┐   (where sweep.focus is law)
#           └────────── detections or fields ─ spectra ─ phase_slope
#                                              (and paths)
#
# Each rule is a job of that table. Its params are the config keys that it reads and a digest of the
# code that it runs: nothing else makes it run again. Outputs are marked `update`: a job replaces them
# whole, at its end, so a run that fails leaves what was there.
import math
import os
import shlex
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

# a script of the user's that is called octsim.py too, here or on PYTHONPATH, is not the package
for place in sys.path[:]:
    if Path(place, "octsim.py").is_file() and not Path(place, "octsim").is_dir():
        sys.path.remove(place)
from octsim.base.surroundings import settle_imports, settle_words

settle_imports()
settle_words()
from octsim.cli.stopped import DEAF, stops_at_signals, stops_by_cancelling
from psutil import Process

if workflow.is_main_process and workflow.modifier.is_main_snakefile():
    stops_at_signals(lambda: Process().children(recursive=True))

from filelock import FileLock, Timeout
from octsim.archive.report_file import REPORT, SHOWN, report_code
from octsim.base import clock
from octsim.base.errors import OctsimError
from octsim.base.files import digest_of, is_regular, require_folder
from octsim.base.provenance import lock_file, source_digest
from octsim.base.say import noting_for
from octsim.cli.job_server import PYTHON, SOCKET, start
from octsim.cli.told import edit_of, result_of
from octsim.config.derive import parts_of
from octsim.config.handed import FOLDER as LOOKED, keep_beside_runs
from octsim.config.load import load_and_tell
from octsim.config.models import Config
from octsim.config.told import told
from octsim.datasets.catalog import CATALOG, TARGETS, jobs
from octsim.datasets.code import code_of, figures_code
from octsim.datasets.gallery import ANIMATION, CAPTIONS, FORMS, drawn_with, run_figures
from octsim.datasets.keys import inputs_of, jobs_of, keys_read, stages_of
from octsim.datasets.stage import Stage
from octsim.stages.cost_estimate import check_budget, expected
from octsim.stages.run_id import begin, is_latest
from octsim.stages.workload import shares_of
from snakemake.logging import logger
from snakemake_logger_plugin_octsim import RESULT


def say(line: str) -> None:
    """Say a line in the order of what snakemake says, if octsim shows that; else at once."""
    if workflow.logger_manager.get_log_handlers():
        logger.info(line)
    else:
        print(line, file=sys.stderr)


if workflow.cores is not None and workflow.cores < 1:
    sys.exit(f"octsim: --cores: {workflow.cores} given; give 1 or more")
noting_for("reading")
if workflow.is_main_process and LOOKED not in os.environ:
    # jobs need not look at a grid's combinations again, on whatever node they are
    looked = keep_beside_runs()  # where nothing can be written it is said below
try:
    # the files themselves too, as snakemake's own reading lets a key stand twice
    run, said = load_and_tell(*workflow.configfiles, config)
    require_folder(Path(f"results/{run.run}"))
    estimate = expected(run)
    if estimate.is_large:
        say(f"octsim: {estimate}")
    if workflow.is_main_process and (remark := clock.set_back(Path(f"results/{run.run}"))):
        say(f"octsim: warning: {remark}")
except OctsimError as error:
    sys.exit("\n".join(f"octsim: {line}" for line in str(error).splitlines()))
if run.run == Config().run and run != Config():
    said.insert(
        0, "run: not given, so this goes to results/thesis in the place of the thesis itself"
    )
for line in told(run):
    say(f"octsim: {line}")
for remark in said:
    say(f"octsim: warning: {remark}")

sys.executable = shlex.quote(PYTHON)  # snakemake writes it into commands of a shell as it is
os.environ.update(OCTSIM_RUN=str(os.getpid()))  # a job ends with the run that started it
if workflow.is_main_process:
    os.environ.update(OCTSIM_CORES=str(workflow.cores))
elif not is_latest(Path(f"results/{run.run}")):
    # queued on a cluster by a run that was killed: it must not touch what the next one makes
    sys.exit("octsim: this job's run has ended, and another of its name has begun")
else:
    # of the machine that sent this job to a cluster
    os.environ.pop(SOCKET, None)
PLANNED = set()  # the rules of the jobs that are to be done
SERVER = []  # that jobs on this machine are forks of; it ends with this process
# not workflow.cores, which in a job on a cluster are all that its node has
CORES = int(os.environ.get("OCTSIM_CORES", workflow.cores))
FOLDER = f"results/{run.run}"
FIGURES = run_figures(run)
SHARES = shares_of(run)  # a stage that takes long is scattered over several jobs
# measured series and spectra are files of the user's: what stands in them counts, not their time,
# which another clock may have set; one that is not there is said by the job
SERIES = [file for file in [run.expansion.series] if file and is_regular(file)]
SPECTRA = [file for file in run.measured.files.values() if is_regular(file)]
LOCK = FileLock(f"{FOLDER}/.lock")  # held from the start of a run to its end
# of other targets, what was asked for once: an archive has it too, brought up to date
BESIDE = [file for file in (f"{FOLDER}/{target}.nc" for target in TARGETS) if Path(file).is_file()]
MOVING = f"{FOLDER}/figures/{ANIMATION.name}.gif"


# for `--sdm apptainer` alone: the image that `apptainer build octsim.sif apptainer.def` makes
container: "octsim.sif"


wildcard_constraints:
    stage="|".join(SHARES),
    number=r"\d+",
    of=r"\d+",


def made_from(code: str, *keys: str) -> dict[str, object]:
    """Return what a rule's results follow from, besides its inputs: its code and what it reads.

    One value for the whole, as snakemake compares a rule's params as a set, without their names.
    """
    return {"code": code, **parts_of(run.to_dict(), *keys)}


@cache  # as for sources
def made_from_rows(rows: tuple[Stage, ...]) -> dict[str, object]:
    """Return what the datasets of a rule follow from, and the figures that it draws."""
    codes = [code_of(row.name, run) for row in rows]
    codes += [figures_code(*row.figures) for row in rows if row.beside]
    keys = (key for row in rows for key in keys_read(row.name, run))
    names = {row.name for row in rows}
    files = [*(SERIES if "expansion" in names else []), *(SPECTRA if "measured" in names else [])]
    held = {file: digest_of(Path(file)) for file in files}
    return made_from(" ".join(codes), *dict.fromkeys(keys)) | held


def when_asked(work: Callable[..., object], *arguments: object) -> Callable[[object], object]:
    """Return a function that works for the jobs that are planned: digests of all take a while."""
    return lambda _: work(*arguments)


@cache  # once for all shares of a stage, of which there may be thousands
def sources(rows: tuple[Stage, ...]) -> dict[str, object]:
    """Return the datasets that a rule's are made from, by their names."""
    names = {name for row in rows for name in inputs_of(row, run)} - {row.name for row in rows}
    found = {name: f"{FOLDER}/{name}.nc" for name in CATALOG if name in names}
    if "expansion" in {row.name for row in rows}:
        # without phases or spectra the job says so at once, and nothing is calibrated for it
        return found if SERIES or (run.expansion.series is None and SPECTRA) else {}
    # a job of a grid says at once that it is of a single config, or one without a cylinder that it
    # needs one, and no law is fitted for it
    alone = run.grid.varied or not rows[0].serves(run)
    return {} if alone and rows[0].beside else found


def shares(stage: str) -> list[str]:
    """Return the files that a stage is gathered from; none where it is one job."""
    of = SHARES.get(stage, 1)
    return [f"{FOLDER}/shares/{stage}-{n}-of-{of}.npz" for n in range(1, of + 1) if of > 1]


def drawn(figure: str, category: str) -> list[str]:
    """Return the files of a figure, the first marked for snakemake's own report."""
    first, *others = (f"{FOLDER}/figures/{figure}.{form}" for form in FORMS)
    said = {"figure": figure, "shows": CAPTIONS[figure]}
    told = "workflow/report/figure.rst"
    return [report(first, caption=told, category=category, labels=said), *others]


def threads_of(rows: tuple[Stage, ...]) -> int:
    """Return the threads of a job: the two at the start share the cores, and scattered ones wait."""
    if shares(rows[0].name):
        return 1
    return max(1, CORES // 2) if rows[0].traces and not rows[0].after else CORES


def needs(*stages: str) -> dict[str, Callable[[object, int, int], int]]:
    """Return what a job asks a cluster for: with a margin, and more each time it is tried."""
    cost = estimate.of(*stages)
    of = max((SHARES.get(stage, 1) for stage in stages), default=1)
    minutes = math.ceil(60 + 3 * cost.cpu_seconds / of / 60)

    def megabytes(threads: int) -> int:
        return math.ceil(600 + 1.5e-6 * cost.memory(threads))  # and two snakemakes around it

    return {
        "mem_mb": lambda _, threads, attempt: attempt * megabytes(threads),
        "runtime": lambda _, threads, attempt: attempt * minutes,
    }


def result(remarks: tuple[str, ...] = tuple(said)) -> list[str]:
    """Return what the run comes to, a line each."""
    asked = {Path(job.log[0]).stem for job in dag().jobs if job.log}
    return result_of(Path(FOLDER), run, asked, remarks)


def dag() -> object:
    """Return snakemake's jobs."""
    return workflow.persistence.dag


RESULT.append(lambda: result(()))  # where nothing is to be done, the config's warnings stand above


onstart:
    # what is to be made, which may be less than all, may take more than was confirmed
    PLANNED.update(job.rule.name for job in dag().needrun_jobs())
    try:
        check_budget(run, estimate.of(*PLANNED), Path(FOLDER))
    except OctsimError as error:
        sys.exit(f"octsim: {error}")
    # one run of a name at a time; the lock goes with the process, however that ends
    try:
        LOCK.acquire(blocking=False)
    except Timeout:
        sys.exit(f"octsim: another run is at work on {FOLDER}; wait for it or stop it")
    begin(Path(FOLDER))
    if workflow.is_main_process and workflow.local_exec:
        sys.executable = shlex.join([*DEAF, PYTHON])
        SERVER.append(start())
    if workflow.is_main_process and workflow.modifier.is_main_snakefile():
        # again, as snakemake has its own by now
        if workflow.local_exec:
            stops_at_signals(lambda: Process().children(recursive=True))
        else:
            stops_by_cancelling()
    if edit := edit_of(Path(FOLDER), run, PLANNED):
        say(edit)


onsuccess:
    for line in result():
        say(line)
    wanted = [Path(file).name for stage in SHARES for file in shares(stage)]
    for share in Path(f"{FOLDER}/shares").glob("*.npz"):
        if share.name not in wanted:  # of a run that was given up, cut otherwise
            share.unlink()


onerror:
    # snakemake notes a failed job's new params with the old output that it restores, and would
    # take that for up to date: mark it incomplete
    for failed in workflow.scheduler.failed:
        workflow.persistence.started(failed)


rule all:
    input:
        [f"{FOLDER}/{stage}.nc" for stage in stages_of(run)],
        [f"{FOLDER}/figures/{name}.{form}" for name in FIGURES for form in FORMS],


rule share:
    input:
        unpack(lambda wildcards: sources((CATALOG[wildcards.stage],))),
    output:
        temp(f"{FOLDER}/shares/{{stage}}-{{number}}-of-{{of}}.npz"),
    log:
        f"{FOLDER}/logs/shares/{{stage}}-{{number}}-of-{{of}}.log",
    resources:
        mem_mb=lambda wildcards, threads, attempt: needs(wildcards.stage)["mem_mb"](
            wildcards, threads, attempt
        ),
        runtime=lambda wildcards, threads, attempt: needs(wildcards.stage)["runtime"](
            wildcards, threads, attempt
        ),
    params:
        made_from=lambda wildcards: made_from_rows((CATALOG[wildcards.stage],)),
    message:
        "Trace share {wildcards.number} of {wildcards.of} of {wildcards.stage}"
    script:
        "workflow/scripts/job.py"


for name, rows in (jobs_of(run) | jobs(beside=True)).items():

    rule:
        name:
            name
        input:
            **sources(rows),
            shares=shares(name),
        output:
            **{row.name: update(f"{FOLDER}/{row.name}.nc") for row in rows},
            figures=update(
                [
                    file
                    for row in rows
                    if row.beside
                    for figure in drawn_with(row.name)
                    for file in drawn(figure, row.name)
                ]
            ),
        log:
            f"{FOLDER}/logs/{name}.log",
        threads: threads_of(rows)
        resources:
            **needs(*(row.name for row in rows)),
        params:
            made_from=when_asked(made_from_rows, rows),
        message:
            "{}".format("; ".join(row.message for row in rows))
        script:
            "workflow/scripts/job.py"


rule figures:
    input:
        **{
            name: f"{FOLDER}/{name}.nc"
            for name in dict.fromkeys(name for one in FIGURES.values() for name in one.sources)
        },
    output:
        update([file for name in FIGURES for file in drawn(name, "run")]),
    log:
        f"{FOLDER}/logs/figures.log",
    threads: CORES
    resources:
        **needs("spectra", "phase_slope"),
    params:
        made_from=made_from(figures_code(*(one.figure for one in FIGURES.values())), "processing"),
    message:
        "Draw the figures"
    script:
        "workflow/scripts/job.py"


rule animation:
    input:
        # a grid is refused at once, and nothing is traced for it
        **{name: f"{FOLDER}/{name}.nc" for name in ANIMATION.of if not run.grid.varied},
    output:
        update(MOVING),
    log:
        f"{FOLDER}/logs/animation.log",
    resources:
        **needs("focus_scan"),
    params:
        made_from=lambda _: made_from(figures_code(ANIMATION), *keys_read("focus_scan", run)),
    message:
        "Animate the focus scan"
    script:
        "workflow/scripts/job.py"


rule report:
    input:
        [f"{FOLDER}/{stage}.nc" for stage in stages_of(run)],
        [file for file in BESIDE if Path(file).stem in SHOWN],
    output:
        update(f"{FOLDER}/{REPORT}"),
    log:
        f"{FOLDER}/logs/report.log",
    resources:
        **needs("spectra", "phase_slope"),
    params:
        # it shows the config, and whom to cite
        made_from=lambda _: made_from(report_code(), "archive", *run.to_record()),
    message:
        "Write the report"
    script:
        "workflow/scripts/job.py"


rule archive:
    input:
        rules.all.input,
        rules.report.output,
        BESIDE,
        [MOVING] if Path(MOVING).is_file() and not run.grid.varied else [],
    output:
        update(f"{FOLDER}/{run.run}.zip"),
    log:
        f"{FOLDER}/logs/archive.log",
    params:
        # it holds the whole config but for what no result depends on, and maybe a day
        made_from=lambda _: made_from(
            source_digest("octsim.archive.pack"), "archive", *run.to_record()
        ),
        lock=lambda _: (held := lock_file()) and digest_of(held),
        day=os.environ.get("SOURCE_DATE_EPOCH", ""),
    message:
        "Pack the run for a data repository"
    script:
        "workflow/scripts/job.py"
