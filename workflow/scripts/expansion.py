"""Target expansion: a measured series of phases to nanometres."""

import logging
from pathlib import Path

from job import job

from octsim.config.grid import without_grid
from octsim.datasets.files import read, write
from octsim.figures.expansion import expansion_figure
from octsim.figures.style import look, save
from octsim.studies.calibration.expansion import series_expansion, series_of, summary

with job(snakemake) as given, look():
    config = without_grid(given, "expansion")
    series = series_of(config)
    table = read(snakemake.input.calibration, "calibration", config)
    found = series_expansion(config, series, table)
    write(found, snakemake.output.expansion[0])
    for file in map(Path, snakemake.output.figures):
        save(expansion_figure(found), file)
    logging.info("%s", summary(found))
