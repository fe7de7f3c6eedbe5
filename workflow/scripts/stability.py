"""Target stability: the tracer's rounding at the extremes, measured against 50 digits."""

import logging
import sys
from pathlib import Path

from job import end_with_the_run, job

from octsim.datasets import write
from octsim.figures.stability import stability_figure
from octsim.figures.style import look, save
from octsim.grid import without_grid

with job(snakemake) as config, look():
    # ahead of this script's folder, as it has this script's own name
    sys.path.insert(0, str(Path(snakemake.scriptdir).parents[1] / "benchmarks"))
    from stability import stability, summary

    measured = stability(without_grid(config, "stability"), snakemake.threads, end_with_the_run)
    write(measured, snakemake.output.stability[0])
    for file in map(Path, snakemake.output.figures):
        save(stability_figure(measured), file)
    logging.info("%s", summary(measured))
