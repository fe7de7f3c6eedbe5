"""A job of the workflow: one or more datasets of the catalog, made, kept and told of."""

import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from octsim.base.errors import ConfigError
from octsim.base.named import called, named, names
from octsim.config.grid import without_grid
from octsim.config.models import Config
from octsim.datasets.files import opened, read, write
from octsim.datasets.stage import Stage
from octsim.datasets.streams import Streamed
from octsim.datasets.writer import write_stream
from octsim.stages.progress import watched
from octsim.stages.scatter import WHOLE, Share, gathered, notes_of, write_share

if TYPE_CHECKING:
    from octsim.instrument.points import Points


class Job(NamedTuple):
    """What is to be made, and with what."""

    rows: tuple[Stage, ...]
    """Datasets to make, one after the other."""
    inputs: Mapping[str, Path]
    """Files of the datasets that they are made from, by their names, as far as they are needed."""
    outputs: Mapping[str, Path]
    """Files of the datasets to make, by their names; of a share, the share's."""
    threads: int = 1
    share: Share = WHOLE
    """The share of a scattered stage that is to be made."""
    shares: tuple[Path, ...] = ()
    """Files of all shares of a scattered stage, that it is gathered from."""
    prepare: Callable[[], None] | None = None
    """What each process that work is handed to does first."""


def perform(job: Job, config: Config) -> dict[str, int]:
    """Make the datasets of a job, and log what they come to.

    Returns
    -------
    dict
        How many points were traced and how many were kept from before, if any were needed:
        ``points_traced`` and ``points_from_cache``.

    Raises
    ------
    OctsimError
        If something is wrong that a user can mend.
    """
    files = dict(job.inputs)
    with _points(job, config) as points:
        for row in job.rows:
            _make(row, job, config, files, points)
            files[row.name] = job.outputs[row.name]
            if job.share == WHOLE:
                _tell(row, files[row.name], config)
    if job.shares:
        return notes_of(job.shares)
    return points.counts() if points else {}


@contextmanager
def _points(job: Job, config: Config) -> Iterator["Points | None"]:
    """Open the point cache for a job that traces."""
    if job.shares or not any(row.needs_light for row in job.rows):
        yield None  # nor is numba imported
        return
    from octsim.instrument.point_store import open_store
    from octsim.instrument.points import Points

    points = Points(open_store(config.cache))
    try:
        yield points
    finally:
        points.keep()


def _make(
    row: Stage, job: Job, config: Config, files: Mapping[str, Path], points: "Points | None"
) -> None:
    work, output = named(row.make), job.outputs[row.name]
    if isinstance(work, Streamed):
        with ExitStack() as stack:
            sources = {
                name: stack.enter_context(opened(files[name], name, config))
                for name in row.after
                if name in files
            }
            _stream(row, work, job, config, sources, points)
        return
    single = without_grid(config, row.name)
    if not row.serves(config):
        raise ConfigError(
            f"scene.cylinders: [] given, but {row.name} needs a cylinder; ask for it in a config "
            "with one"
        )
    tables = [read(files[name], name, single) if name in files else None for name in row.after]
    found = called(work, single, *tables, threads=job.threads, points=points, prepare=job.prepare)
    write(found, output)


def _stream(
    row: Stage, work: Streamed[Any], job: Job, config: Config, sources: Mapping[str, Any],
    points: "Points | None",
) -> None:  # fmt: skip
    """Write a dataset part by part, or a share of its parts, or gather them from all shares."""
    output = job.outputs[row.name]
    # a source is a keyword where the function has its name; of two kinds of light one is there
    in_order = [sources.get(name) for name in row.after if not names(work.stream, name)]
    stream = called(
        work.stream, config, *in_order, **sources, threads=job.threads, points=points,
        share=job.share,
    )  # fmt: skip
    if job.shares:
        write_stream(gathered(stream, job.shares), output)
    elif job.share != WHOLE and points:
        write_share(watched(stream), job.share, output, points.counts)
    else:
        write_stream(watched(stream), output)


def _tell(row: Stage, file: Path, config: Config) -> None:
    """Log what a dataset comes to, and where it is not what one would want."""
    if not (row.summary or row.doubts):
        return
    with opened(file, row.name, config) as dataset:
        for doubt in row.doubts_of(dataset):
            logging.warning("octsim: warning: %s", doubt)
        if row.summary:
            logging.info("octsim: %s", named(row.summary)(dataset))
