"""Target action_potential: a neuron that fires, through the instrument and back."""

import logging
from pathlib import Path

from job import fitted_law, job

from octsim.config.grid import without_grid
from octsim.datasets.files import read, write
from octsim.figures.action_potential import action_potential_figure
from octsim.figures.style import look, save
from octsim.studies.calibration.action_potential import action_potential, summary

with job(snakemake) as given, look():
    config = without_grid(given, "action_potential")
    law = fitted_law(snakemake, config)
    table = read(snakemake.input.calibration, "calibration", config)
    fired = action_potential(config, table, law, snakemake.threads)
    write(fired, snakemake.output.action_potential[0])
    for file in map(Path, snakemake.output.figures):
        save(action_potential_figure(fired, table), file)
    logging.info("%s", summary(fired))
