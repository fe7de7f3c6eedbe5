"""Draw the figures of a run from its datasets."""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from job import end_with_the_run, job

from octsim.datasets.files import read
from octsim.datasets.gallery import NOT_DRAWN
from octsim.figures import FIGURES
from octsim.figures.style import look, save


def draw(name: str) -> None:
    """Draw one figure in all its forms; a forked process has what was read."""
    figure = FIGURES[name](stages, config.processing)
    for file in map(Path, snakemake.output):
        if file.stem == name:
            save(figure, file)


with job(snakemake) as config, look():
    names = dict.fromkeys(Path(file).stem for file in snakemake.output)
    left = [variable for name in names for variable in NOT_DRAWN.get(name, ())]
    stages = {stage: read(file, stage, config, left) for stage, file in snakemake.input.items()}
    folder = Path(snakemake.output[0]).parent
    ends = (end_with_the_run, (folder.parent,))
    with ProcessPoolExecutor(snakemake.threads, get_context("fork"), *ends) as pool:
        list(pool.map(draw, names))
    for stale in set(FIGURES) - set(names):  # of the config before
        for file in folder.glob(f"{stale}.*"):
            file.unlink()
