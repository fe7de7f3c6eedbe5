"""Target causes: what makes the phase slope scatter, and spike."""

import logging
from pathlib import Path

from job import job

from octsim.datasets import read, write
from octsim.figures.causes import FIGURES
from octsim.figures.style import look, save
from octsim.grid import without_grid
from octsim.spike import causes, summary

with job(snakemake) as config, look():
    law_file = snakemake.input.get("focus_law", config)
    law = read(law_file[0], "focus_law", config) if law_file else None
    found = causes(without_grid(config, "causes"), law, snakemake.threads)
    write(found, snakemake.output.causes[0])
    for file in map(Path, snakemake.output.figures):
        save(FIGURES[file.stem](found), file)
    logging.info("%s", summary(found))
