"""Target stability: the tracer's rounding at the extremes, measured against 50 digits."""

import logging
from pathlib import Path

from job import end_with_the_run, job

from octsim.config.grid import without_grid
from octsim.datasets.files import write
from octsim.figures.stability import stability_figure
from octsim.figures.style import look, save
from octsim.studies.stability.study import stability, summary

with job(snakemake) as config, look():
    measured = stability(without_grid(config, "stability"), snakemake.threads, end_with_the_run)
    write(measured, snakemake.output.stability[0])
    for file in map(Path, snakemake.output.figures):
        save(stability_figure(measured), file)
    logging.info("%s", summary(measured))
