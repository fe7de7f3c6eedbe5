"""Every job of the workflow: makes what its rule is for, logs it, and ends with its run."""

import json
import logging
import os
import sys
import threading
import time
import warnings
from functools import partial
from pathlib import Path

from octsim.base.errors import OctsimError, OctsimWarning
from octsim.base.files import whole
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.datasets.catalog import CATALOG
from octsim.stages.run_id import is_latest


def end_with_the_run(folder: Path) -> None:
    """End this process as soon as its run has ended: none goes on to write beside the next run.

    On a cluster a run's end is not seen, but the next run in its folder is.
    """
    run, parent = int(os.environ["OCTSIM_RUN"]), os.getppid()

    def watch() -> None:
        while is_latest(folder):  # once a second, as that asks a file server
            for _ in range(10):
                if os.getppid() != parent or not _is_alive(run):
                    os._exit(1)
                time.sleep(0.1)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def make(folder: Path, config: Config) -> None:
    """Make the datasets of a rule, or a share of one, and the figures that go with them."""
    from octsim.stages.job import Job, perform
    from octsim.stages.scatter import Share

    rows = tuple(row for row in CATALOG.values() if row.rule == NAME)
    before = {name: Path(file) for name, file in snakemake.input.items() if name in CATALOG}
    made = {row.name: Path(snakemake.output.get(row.name, snakemake.output[0])) for row in rows}
    job = Job(
        rows,
        before,
        made,
        snakemake.threads,
        Share(*(int(snakemake.wildcards.get(name, 1)) for name in ("number", "of"))),
        tuple(map(Path, snakemake.input.get("shares", ()))),
        partial(end_with_the_run, folder),
    )
    counts = perform(job, config)
    if counts and snakemake.log.get("points"):
        with whole(Path(snakemake.log.points)) as file:
            file.write_text(json.dumps(counts) + "\n", encoding="utf-8")
    if snakemake.output.get("figures"):
        from octsim.datasets.gallery import drawn_with
        from octsim.figures.draw import draw as draw_all

        for row in rows:
            draw_all(drawn_with(row.name), before | made, folder / "figures", config)


def draw(folder: Path, config: Config) -> None:
    """Draw the figures of a run, and remove those of the config before."""
    from octsim.datasets.gallery import all_run_figures, run_figures
    from octsim.figures.draw import draw as draw_all

    figures = run_figures(config)
    files = {name: Path(file) for name, file in snakemake.input.items()}
    ends = partial(end_with_the_run, folder)
    draw_all(figures, files, folder / "figures", config, snakemake.threads, ends)
    for stale in set(all_run_figures()) - set(figures):
        for file in (folder / "figures").glob(f"{stale}.*"):
            file.unlink()


def archive(folder: Path, config: Config) -> None:
    """Pack a run as one file, for a data repository."""
    from octsim.archive.pack import pack

    packed = pack(folder, config, Path(snakemake.output[0]))
    for remark in packed.remarks:
        logging.warning("octsim: warning: %s", remark)
        print(f"octsim: warning: {remark}", file=sys.stderr)
    logging.info("%s", packed)


# not the rule's name, which is another where this workflow is a module of one of the user's
NAME = snakemake.wildcards.get("stage", Path(snakemake.log[0]).stem)
run = next(above for above in Path(snakemake.log[0]).parents if above.name == "logs").parent
end_with_the_run(run)
logging.basicConfig(filename=snakemake.log[0], level=logging.INFO, format="%(message)s")
logging.captureWarnings(capture=True)
logging.raiseExceptions = False  # a full disk is said once, by what hits it
warnings.simplefilter("ignore", OctsimWarning)  # the workflow has said these once
try:
    {"figures": draw, "archive": archive}.get(NAME, make)(run, load_config(snakemake.config))
except OctsimError as error:
    logging.error("%s", error)
    sys.exit(f"octsim: {error}")
