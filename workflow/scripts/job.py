"""What every job does around its stage: read the config, log, and say in one line what failed."""

import json
import logging
import os
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from octsim.base.errors import OctsimError, OctsimWarning
from octsim.base.files import whole
from octsim.config.load import load_config
from octsim.config.models import Config
from octsim.stages.run_id import is_latest

if TYPE_CHECKING:
    import xarray as xr

    from octsim.datasets.stage import Stream
    from octsim.instrument.points import Points
    from octsim.stages.scatter import Share


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


@contextmanager
def job(snakemake: Any) -> Iterator[Config]:
    """Give a job its config; log what it says; end it with one line if a user can mend it."""
    end_with_the_run(Path(snakemake.log[0]).parent.parent)
    logging.basicConfig(filename=snakemake.log[0], level=logging.INFO, format="%(message)s")
    logging.captureWarnings(capture=True)
    logging.raiseExceptions = False  # a full disk is said once, by what hits it
    warnings.simplefilter("ignore", OctsimWarning)  # the workflow has said these once
    try:
        yield load_config(snakemake.config)
    except OctsimError as error:
        logging.error("%s", error)
        sys.exit(f"octsim: {error}")


def fitted_law(snakemake: Any, config: Config) -> "xr.Dataset | None":
    """Read a target's focus law, where its config needs one."""
    from octsim.datasets.files import read

    file = snakemake.input.focus_law
    return read(file, "focus_law", config) if file else None


def trace(snakemake: Any, config: Config, stage: "Callable[[Points, Share], Stream]") -> None:
    """Make a stage that traces, or a job's share of it, or gather it from its shares.

    What it traced and what the cache had are counted in the log of points.
    """
    # numba's import is not for jobs that trace nothing
    from octsim.datasets.writer import write_stream
    from octsim.instrument.point_store import opened
    from octsim.instrument.points import Points
    from octsim.stages.progress import watched
    from octsim.stages.scatter import WHOLE, Share, gathered, notes_of, write_share

    output, shares = Path(snakemake.output[0]), [Path(file) for file in snakemake.input.shares]
    if shares:
        write_stream(gathered(stage(Points(), WHOLE), shares), output)
        _count(snakemake, notes_of(shares))
        return
    number, of = map(int, (snakemake.wildcards.get(name, 1) for name in ("number", "of")))
    whence = Points(opened(config.cache))
    stream = watched(stage(whence, Share(number, of)))
    try:
        if of > 1:
            write_share(stream, Share(number, of), output, lambda: counts_of(whence))
        else:
            write_stream(stream, output)
    finally:
        whence.keep()
    if of == 1:
        _count(snakemake, counts_of(whence))


def counts_of(points: "Points") -> dict[str, int]:
    """Say how many points a job traced, and how many the cache had."""
    return {"points_traced": points.traced, "points_from_cache": points.from_cache}


def _count(snakemake: Any, counts: dict[str, int]) -> None:
    with whole(Path(snakemake.log.points)) as file:
        file.write_text(json.dumps(counts) + "\n", encoding="utf-8")
