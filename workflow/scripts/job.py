"""What every job does around its stage: read the config, log, and say in one line what failed."""

import json
import logging
import os
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from octsim.config import Config
from octsim.errors import OctsimError, OctsimWarning
from octsim.files import whole
from octsim.latest import is_latest
from octsim.loading import load_config

if TYPE_CHECKING:
    import xarray as xr

    from octsim.points import Points


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
    from octsim.datasets import read

    file = snakemake.input.focus_law
    return read(file, "focus_law", config) if file else None


@contextmanager
def points(snakemake: Any, config: Config) -> Iterator["Points"]:
    """Give a stage where its light is from, the cache or the tracer; log how much came of each."""
    # numba's import is not for jobs that trace nothing
    from octsim.cache import opened
    from octsim.points import Points

    with opened(config.cache.path(), config.cache.gigabytes) as cache:
        whence = Points(cache)
        try:
            yield whence
        finally:
            whence.keep()
    counts = {"points_traced": whence.traced, "points_from_cache": whence.from_cache}
    with whole(Path(snakemake.log.points)) as file:
        file.write_text(json.dumps(counts) + "\n", encoding="utf-8")
