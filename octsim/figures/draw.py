"""Figures of datasets, drawn and saved: several at a time, each in a process of its own."""

from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import xarray as xr
from matplotlib.figure import Figure

from octsim.base.files import whole
from octsim.base.named import called, named
from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.datasets.files import read
from octsim.datasets.gallery import FORMS, Drawn
from octsim.figures.caption import caption_of
from octsim.figures.style import look, save

_read: dict[str, xr.Dataset] = {}  # a forked process has what was read


def draw(
    figures: Mapping[str, Drawn],
    datasets: Mapping[str, Path],
    folder: Path,
    config: Config,
    threads: int = 1,
    prepare: Callable[[], None] | None = None,
) -> None:
    """Draw figures from stored datasets.

    Parameters
    ----------
    figures : mapping
        The figures by their names.
    datasets : mapping
        Files of the datasets that they are drawn from, by their names.
    folder : Path
        Where they go, each in all forms: ``<name>.png`` and others, and its caption,
        ``<name>.txt``.
    config : Config
        The config that the datasets follow from.
    threads : int
        How many are drawn at a time.
    prepare : callable, optional
        What each process does first.

    Raises
    ------
    DatasetError, FileError
        If a dataset can't be read or a figure can't be written.
    """
    left = [name for one in figures.values() for name in one.figure.without]
    wanted = dict.fromkeys(source for one in figures.values() for source in one.sources)
    _read.update({name: read(datasets[name], name, config, left) for name in wanted})
    tasks = [(one, folder, config) for one in figures.values()]
    if threads == 1 or len(tasks) == 1:
        for task in tasks:
            _draw(task)
        return
    for one in figures.values():  # before there are several processes, which would each load them
        named(one.figure.draw)
    with ProcessPoolExecutor(threads, get_context("fork"), prepare) as pool:
        list(pool.map(_draw, tasks))


def figure_of(one: Drawn, datasets: Mapping[str, xr.Dataset], processing: Processing) -> Figure:
    """Return a figure of the datasets that it is drawn from, by their names."""
    sources = (datasets[name] for name in one.sources)
    figure: Figure = called(named(one.figure.draw), *sources, processing=processing)
    return figure


def _draw(task: tuple[Drawn, Path, Config]) -> None:
    one, folder, config = task
    with look():
        figure = figure_of(one, _read, config.processing)
        for form in FORMS:
            file = folder / f"{one.figure.name}.{form}"
            if form == "txt":
                with whole(file) as temporary:
                    temporary.write_text(caption_of(one, figure, config), encoding="utf-8")
            else:
                save(figure, file)
