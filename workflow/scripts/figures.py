"""Draw the figures of a run from its datasets."""

from pathlib import Path

from job import job

from octsim.datasets import read
from octsim.figures import FIGURES
from octsim.figures.style import look, save

with job(snakemake), look():
    datasets = {stage: read(file, stage) for stage, file in snakemake.input.items()}
    folder = Path(snakemake.output[0]).parent
    for name, (draw, stages) in FIGURES.items():
        figure = draw(*(datasets[stage] for stage in stages))
        save(figure, folder / f"{name}.png")
        save(figure, folder / f"{name}.svg")
