"""A job of the workflow, told as plain data: done, logged and measured."""

import json
import logging
import os
import resource
import sys
import threading
import time
import warnings
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from octsim.base.errors import OctsimError, OctsimWarning
from octsim.base.files import whole
from octsim.base.say import noting_for, say
from octsim.cli.job_server import is_alive
from octsim.config.load import load_checked
from octsim.config.models import Config
from octsim.datasets.catalog import CATALOG, jobs
from octsim.datasets.keys import jobs_of
from octsim.stages.run_id import is_latest

_RSS_UNIT = 2**20 if sys.platform == "darwin" else 2**10  # of what is counted, in a MiB


class Task(NamedTuple):
    """What a job is told: plain data alone, as it may come from another process."""

    name: str
    """Of the job: one of the catalog's, figures, animation, report or archive."""
    folder: str
    """Of the run."""
    config: Mapping[str, Any]
    input: Mapping[str, str]
    """Files of the datasets that it reads, by their names."""
    output: Mapping[str, str]
    """Files of the datasets that it makes, by their names; or the one file, under any name."""
    shares: list[str]
    """Files of a scattered stage's shares, that it is gathered from."""
    log: str
    threads: int
    share: list[int]
    """Number of the share that is to be made, and how many there are."""
    figures: bool
    """Whether figures of its datasets are drawn too."""


def do(task: Task) -> int:
    """Do a job and return its exit status; what a user can mend is said in one line."""
    folder, begin = Path(task.folder), time.monotonic()
    end_with_the_run(folder)
    noting_for(Path(task.log).stem)
    Path(task.log).parent.mkdir(parents=True, exist_ok=True)
    logging.basicConfig(
        filename=task.log, encoding="utf-8", level=logging.INFO, format="%(message)s", force=True
    )
    logging.captureWarnings(capture=True)
    logging.raiseExceptions = False  # a full disk is said once, by what hits it
    warnings.simplefilter("ignore", OctsimWarning)  # the workflow has said these once
    others = {"figures": _draw, "animation": _animate, "report": _report, "archive": _archive}
    work = others.get(task.name, _make)
    try:
        work(task, folder, load_checked(task.config))
        if task.share == [1, 1]:
            _measure(folder / "benchmarks" / f"{task.name}.tsv", time.monotonic() - begin)
    except OctsimError as error:
        logging.error("%s", error)
        say(str(error))
        return 1
    return 0


def end_with_the_run(folder: Path) -> None:
    """End this process as soon as its run has ended: none goes on to write beside the next run.

    On a cluster a run's end is not seen, but the next run in its folder is.
    """
    run, parent = int(os.environ["OCTSIM_RUN"]), os.getppid()

    def watch() -> None:
        while is_latest(folder):  # once a second, as that asks a file server
            for _ in range(10):
                if os.getppid() != parent or not is_alive(run):
                    os._exit(1)
                time.sleep(0.1)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _make(task: Task, folder: Path, config: Config) -> None:
    """Make the datasets of a job, or a share of one, and the figures that go with them."""
    from octsim.stages.job import Job, perform
    from octsim.stages.scatter import Share

    rows = {**jobs_of(config), **jobs(beside=True)}[task.name]
    before = {name: Path(file) for name, file in task.input.items() if name in CATALOG}
    only = next(iter(task.output.values()))
    made = {row.name: Path(task.output.get(row.name, only)) for row in rows}
    share, shares = Share(*task.share), tuple(map(Path, task.shares))
    ends = partial(end_with_the_run, folder)
    counts = perform(Job(rows, before, made, task.threads, share, shares, ends), config)
    if rows[0].traces and task.share == [1, 1]:
        with whole(folder / "logs" / f"{task.name}.json") as file:
            file.write_text(json.dumps(counts) + "\n", encoding="utf-8")
    if task.figures:
        from octsim.datasets.gallery import drawn_with
        from octsim.figures.draw import draw

        for row in rows:
            draw(drawn_with(row.name), before | made, folder / "figures", config)


def _draw(task: Task, folder: Path, config: Config) -> None:
    """Draw the figures of a run, and remove those of the config before."""
    from octsim.datasets.gallery import all_run_figures, run_figures
    from octsim.figures.draw import draw

    figures = run_figures(config)
    files = {name: Path(file) for name, file in task.input.items()}
    ends = partial(end_with_the_run, folder)
    draw(figures, files, folder / "figures", config, task.threads, ends)
    for stale in set(all_run_figures()) - set(figures):
        for file in (folder / "figures").glob(f"{stale}.*"):
            file.unlink()


def _animate(task: Task, _folder: Path, config: Config) -> None:
    """Animate the focus scan of a run."""
    from octsim.base.named import named
    from octsim.config.grid import without_grid
    from octsim.datasets.files import read
    from octsim.datasets.gallery import ANIMATION

    config = without_grid(config, ANIMATION.name)
    sources = (read(Path(task.input[name]), name, config) for name in ANIMATION.of)
    named(ANIMATION.draw)(*sources, Path(next(iter(task.output.values()))))


def _report(task: Task, folder: Path, config: Config) -> None:
    """Write the report of a run, as one page."""
    from octsim.report.page import report

    file = Path(next(iter(task.output.values())))
    logging.info("octsim: %s", report(folder, file, given=config.archive))


def _archive(task: Task, folder: Path, config: Config) -> None:
    """Pack a run as one file, for a data repository."""
    from octsim.archive.pack import pack

    packed = pack(folder, config, Path(next(iter(task.output.values()))))
    for remark in packed.remarks:
        logging.warning("octsim: warning: %s", remark)
    logging.info("octsim: %s", packed)


def _measure(path: Path, seconds: float) -> None:
    """Write what a job took, with the headings of snakemake's own benchmarks."""
    here = resource.getrusage(resource.RUSAGE_SELF)
    handed = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = sum(one.ru_utime + one.ru_stime for one in (here, handed))
    largest = max(here.ru_maxrss, handed.ru_maxrss) / _RSS_UNIT
    with whole(path) as file:
        text = f"s\tmax_rss\tcpu_time\n{seconds:.4f}\t{largest:.2f}\t{cpu:.2f}\n"
        file.write_text(text, encoding="utf-8")
