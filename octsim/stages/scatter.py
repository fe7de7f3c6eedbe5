"""A stage scattered over several jobs, each with a share of its blocks, and gathered again."""

import json
import zipfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import DatasetError
from octsim.base.failures import said_in_a_line
from octsim.base.files import require_regular, whole
from octsim.config.grid import Combination
from octsim.config.models import Config
from octsim.datasets.keys import differing
from octsim.datasets.layout import Layout
from octsim.datasets.streams import Part, Stream, arrays
from octsim.stages.workload import work_of

Block = tuple[Combination, slice]
_INDEX = "index.json"
_REMEDY = "remove it and run again"


class Share(NamedTuple):
    """One of the jobs that a stage is scattered over."""

    number: int = 1
    """Its number, from 1."""
    of: int = 1
    """How many there are."""

    def blocks(self, layout: Layout) -> list[Block]:
        """Return this share's blocks of a stage that traces."""
        stage = layout.stage
        every = layout.blocks(lambda config: work_of(stage, config).together)
        # of a grid over schemes, a stage has the light of some
        own = (block for block in every if work_of(stage, block[0].config).points)
        return self.among(own, lambda config: work_of(stage, config).seconds)

    def among(self, blocks: Iterable[Block], seconds: Callable[[Config], float]) -> list[Block]:
        """Return the blocks of this share: neighbours, and about as much to trace as any other's.

        Parameters
        ----------
        blocks : iterable of Block
            All there are.
        seconds : callable
            Processor time of a point of a config.
        """
        every = list(blocks)
        ends = [0.0, *accumulate(seconds(at.config) * _length(span) for at, span in every)]
        # a block is in the share that its middle is in
        middles = (0.5 * (begin + end) / ends[-1] for begin, end in pairwise(ends))
        return [
            block
            for block, middle in zip(every, middles, strict=True)
            if int(middle * self.of) == self.number - 1
        ]


def _length(span: slice) -> int:
    return int(span.stop - span.start)


WHOLE = Share()
"""All of a stage, in one job."""


def write_share(
    stream: Stream, share: Share, path: Path, notes: Callable[[], Mapping[str, int]]
) -> None:
    """Write a share's parts, one after the other, so that the file is there whole or not at all.

    It is a zip of numpy's arrays, as `numpy.load` reads it, with an index in JSON.

    Parameters
    ----------
    stream : Stream
        The stage, with the share's parts alone.
    share : Share
        Which share that is.
    path : path
        The file.
    notes : callable
        Returns numbers to keep beside the parts, once all of them are made.

    Raises
    ------
    FileError
        If it can't be written; what stood at `path` before is still there.
    """
    layout = stream.layout
    index: dict[str, Any] = {
        "stage": layout.stage, "number": share.number, "of": share.of,
        "config": layout.config.to_dict(), "parts": [],
    }  # fmt: skip
    with whole(path) as temporary, zipfile.ZipFile(temporary, "w") as file:
        for row, part in enumerate(stream.parts):
            variables = {}
            for name, (dimensions, values, *attributes) in arrays(part.variables):
                with file.open(f"{row}/{name}.npy", "w", force_zip64=True) as member:
                    np.lib.format.write_array(member, values, allow_pickle=False)
                variables[name] = [dimensions, _plain(attributes[0] if attributes else {})]
            index["parts"].append([part.at.position, part.first, part.points, variables])
        index["notes"] = dict(notes())
        file.writestr(_INDEX, json.dumps(index))


def gathered(stage: Stream, files: Iterable[Path]) -> Stream:
    """Return a stage with the parts that its shares hold, in the order of the whole stage.

    Parameters
    ----------
    stage : Stream
        The whole stage; its own parts are not asked for.
    files : iterable of path
        Of its shares, in their order.

    Raises
    ------
    DatasetError
        When the parts are taken, if a file is missing, damaged, of another stage or config, or not
        in its place.
    """
    return Stream(stage.layout, _gathered(stage, list(files)))


def _gathered(stage: Stream, files: Sequence[Path]) -> Iterator[Part]:
    layout = stage.layout
    at = {combination.position: combination for combination in layout.combinations}
    for number, path in enumerate(files, start=1):
        with _opened(path) as (file, index):
            if (index["stage"], index["number"], index["of"]) != (layout.stage, number, len(files)):
                what = f"share {number} of {len(files)} of {layout.stage}"
                raise DatasetError(f"{path}: not {what}; {_REMEDY}")
            if keys := differing(layout.stage, layout.config, index["config"]):
                told = ", ".join(keys)
                raise DatasetError(f"{path}: made from another config ({told} differ); {_REMEDY}")
            for row, (position, first, points, variables) in enumerate(index["parts"]):
                found = {
                    name: (tuple(dimensions), _values(file, row, name), _arrays(attributes))
                    for name, (dimensions, attributes) in variables.items()
                }
                yield Part(at[tuple(position)], first, points, found)


def notes_of(files: Iterable[Path]) -> dict[str, int]:
    """Add up the numbers that were kept beside the parts of some shares.

    Raises
    ------
    DatasetError
        If a file is missing or damaged.
    """
    total: Counter[str] = Counter()
    for path in files:
        with _opened(path) as (_, index):
            total.update(index["notes"])
    return dict(total)


@contextmanager
def _opened(path: Path) -> Iterator[tuple[zipfile.ZipFile, dict[str, Any]]]:
    with said_in_a_line(str(path), _REMEDY, DatasetError):
        require_regular(path)
        with zipfile.ZipFile(path) as file:
            yield file, json.loads(file.read(_INDEX))


def _values(file: zipfile.ZipFile, row: int, name: str) -> NDArray[Any]:
    with file.open(f"{row}/{name}.npy") as member:
        values: NDArray[Any] = np.lib.format.read_array(member, allow_pickle=False)
    return values


def _plain(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Write attributes as JSON can hold them."""
    return {
        name: [value.dtype.str, value.tolist()] if isinstance(value, np.ndarray) else value
        for name, value in attributes.items()
    }


def _arrays(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Read back what `_plain` wrote."""
    return {
        name: np.array(value[1], value[0]) if isinstance(value, list) else value
        for name, value in attributes.items()
    }
