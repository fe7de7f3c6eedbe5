"""Target causes: what makes the phase slope scatter, and spike."""

import logging
from pathlib import Path

from job import fitted_law, job

from octsim.config.grid import without_grid
from octsim.datasets.files import write
from octsim.figures.causes import FIGURES
from octsim.figures.style import look, save
from octsim.studies.causes.study import causes, summary

with job(snakemake) as given, look():
    config = without_grid(given, "causes")
    law = fitted_law(snakemake, config)
    found = causes(config, law, snakemake.threads)
    write(found, snakemake.output.causes[0])
    for file in map(Path, snakemake.output.figures):
        save(FIGURES[file.stem](found), file)
    logging.info("%s", summary(found))
