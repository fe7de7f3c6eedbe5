"""Target tradeoff: what accuracy costs, one setting after the other."""

import logging
from pathlib import Path

from job import end_with_the_run, job

from octsim.config.grid import without_grid
from octsim.datasets.files import write
from octsim.figures.style import look, save
from octsim.figures.tradeoff import tradeoff_figure
from octsim.studies.tradeoff.study import summary, tradeoff

with job(snakemake) as config, look():
    measured = tradeoff(without_grid(config, "tradeoff"), snakemake.threads, end_with_the_run)
    write(measured, snakemake.output.tradeoff[0])
    for file in map(Path, snakemake.output.figures):
        save(tradeoff_figure(measured), file)
    logging.info("%s", summary(measured))
