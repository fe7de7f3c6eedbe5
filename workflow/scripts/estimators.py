"""Target estimators: phases and diameters by each estimator, under noise and of other scenes."""

import logging
from pathlib import Path

from job import fitted_law, job

from octsim.config.grid import without_grid
from octsim.datasets.files import write
from octsim.figures.estimators import estimators_figure
from octsim.figures.style import look, save
from octsim.studies.estimators.study import estimators, summary

with job(snakemake) as given, look():
    config = without_grid(given, "estimators")
    law = fitted_law(snakemake, config)
    compared = estimators(config, law, snakemake.threads)
    write(compared, snakemake.output.estimators[0])
    for file in map(Path, snakemake.output.figures):
        save(estimators_figure(compared), file)
    logging.info("%s", summary(compared))
