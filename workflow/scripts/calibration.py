"""Target calibration: how far the phase moves with the diameter alone, and how surely."""

import logging
from pathlib import Path

from job import job

from octsim.calibrate import calibration, summary
from octsim.datasets import read, write
from octsim.figures.calibration import calibration_figure
from octsim.figures.style import look, save
from octsim.sweep import unreached

with job(snakemake) as config, look():
    law_file = snakemake.input.get("focus_law")
    law = read(law_file, "focus_law", config) if law_file else None
    table = calibration(config, law, snakemake.threads)
    if said := unreached(table):
        logging.warning("octsim: warning: %s", said)
    write(table, snakemake.output.calibration[0])
    for file in map(Path, snakemake.output.figures):
        save(calibration_figure(table), file)
    logging.info("%s", summary(table))
