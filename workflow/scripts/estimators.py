"""Target estimators: phases and diameters by each estimator, under noise and of other scenes."""

import logging
from pathlib import Path

from job import job

from octsim.comparison import estimators, summary
from octsim.datasets import read, write
from octsim.figures.estimators import estimators_figure
from octsim.figures.style import look, save

with job(snakemake) as config, look():
    law = read(snakemake.input.focus_law, "focus_law", config) if snakemake.input else None
    compared = estimators(config, law, snakemake.threads)
    write(compared, snakemake.output.estimators[0])
    for file in map(Path, snakemake.output.figures):
        save(estimators_figure(compared), file)
    logging.info("%s", summary(compared))
