"""What every job does around its stage: read the config, log, and say in one line what failed."""

import json
import logging
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


@contextmanager
def job(snakemake: Any) -> Iterator[Config]:
    """Give a job its config; log what it says; end it with one line if a user can mend it."""
    logging.basicConfig(filename=snakemake.log[0], level=logging.INFO, format="%(message)s")
    logging.captureWarnings(capture=True)
    warnings.simplefilter("ignore", OctsimWarning)  # the workflow has said these once
    try:
        yield load_config(snakemake.config)
    except OctsimError as error:
        logging.error("%s", error)
        sys.exit(f"octsim: {error}")
    logging.info("done")


def count_points(snakemake: Any, dataset: xr.Dataset) -> None:
    """Leave the number of traced points, each a diameter at a focus, in the job's points log."""
    counts = {"points_traced": dataset["rays_detected"].size, "points_from_cache": 0}
    Path(snakemake.log.points).write_text(json.dumps(counts) + "\n", encoding="utf-8")
