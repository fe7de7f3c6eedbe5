"""Draw the figures of a run from its datasets."""

from pathlib import Path

from job import job

from octsim.datasets import read
from octsim.figures import FIGURES
from octsim.figures.style import look, save

with job(snakemake) as config, look():
    stages = {stage: read(file, stage, config) for stage, file in snakemake.input.items()}
    for file in map(Path, snakemake.output):
        save(FIGURES[file.stem](stages, config.processing), file)
