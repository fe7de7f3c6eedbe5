"""Target action_potential: a neuron that fires, through the instrument and back."""

import logging
from pathlib import Path

from job import job

from octsim.datasets import read, write
from octsim.figures.action_potential import action_potential_figure
from octsim.figures.style import look, save
from octsim.firing import action_potential, summary

with job(snakemake) as config, look():
    law_file = snakemake.input.get("focus_law")
    law = read(law_file, "focus_law", config) if law_file else None
    table = read(snakemake.input.calibration, "calibration", config)
    fired = action_potential(config, table, law, snakemake.threads)
    write(fired, snakemake.output.action_potential[0])
    for file in map(Path, snakemake.output.figures):
        save(action_potential_figure(fired, table), file)
    logging.info("%s", summary(fired))
