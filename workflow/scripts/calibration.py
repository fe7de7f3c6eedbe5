"""Target calibration: how far the phase moves with the diameter alone, and how surely."""

import logging
from pathlib import Path

from job import fitted_law, job

from octsim.config.grid import without_grid
from octsim.datasets.files import write
from octsim.figures.calibration import calibration_figure
from octsim.figures.style import look, save
from octsim.stages.spectra import doubts
from octsim.studies.calibration.study import calibration, summary

with job(snakemake) as given, look():
    config = without_grid(given, "calibration")
    law = fitted_law(snakemake, config)
    table = calibration(config, law, snakemake.threads)
    for said in doubts(table):
        logging.warning("octsim: warning: %s", said)
    write(table, snakemake.output.calibration[0])
    for file in map(Path, snakemake.output.figures):
        save(calibration_figure(table), file)
    logging.info("%s", summary(table))
