"""What every job does around its stage: read the config, log, and say in one line what failed."""

import ctypes
import json
import logging
import os
import signal
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import xarray as xr

from octsim.config import Config
from octsim.errors import OctsimError, OctsimWarning
from octsim.loading import load_config


def end_with_the_run() -> None:
    """Have this job killed when the run is: none goes on to write beside the next run's."""
    if sys.platform == "linux":
        set_parent_death_signal = 1
        ctypes.CDLL(None).prctl(set_parent_death_signal, signal.SIGKILL)
    if os.environ.get("OCTSIM_RUN") != str(os.getppid()):
        sys.exit("octsim: the run that started this job is gone")


@contextmanager
def job(snakemake: Any) -> Iterator[Config]:
    """Give a job its config; log what it says; end it with one line if a user can mend it."""
    end_with_the_run()
    logging.basicConfig(filename=snakemake.log[0], level=logging.INFO, format="%(message)s")
    logging.captureWarnings(capture=True)
    logging.raiseExceptions = False  # a full disk is said once, by what hits it
    warnings.simplefilter("ignore", OctsimWarning)  # the workflow has said these once
    try:
        yield load_config(snakemake.config)
    except OctsimError as error:
        logging.error("%s", error)
        sys.exit(f"octsim: {error}")


def count_points(snakemake: Any, dataset: xr.Dataset) -> None:
    """Leave the number of traced points, each a diameter at a focus, in the job's points log."""
    counts = {"points_traced": dataset["rays_detected"].size, "points_from_cache": 0}
    Path(snakemake.log.points).write_text(json.dumps(counts) + "\n", encoding="utf-8")
