"""How far a stage is: a bar with rate and time left on a terminal, a line a minute in the log."""

import io
import logging
from collections.abc import Iterator

from tqdm import tqdm

from octsim.datasets.streams import Part, Stream

_BETWEEN_LINES = 60.0  # s
_AFTER = 2.0  # s; what takes less needs no bar


class _Lines(io.StringIO):
    """Takes what a bar writes, and logs it line by line."""

    def write(self, text: str) -> int:
        if said := text.strip():
            logging.info("%s", said)
        return len(text)


def watched(stream: Stream) -> Stream:
    """Return the same stage, telling of its progress as its parts are taken."""
    layout = stream.layout

    def parts() -> Iterator[Part]:
        with (
            tqdm(
                total=layout.points, desc=layout.stage, unit="point", delay=_AFTER, leave=False,
                disable=None, dynamic_ncols=True,
            ) as bar,
            tqdm(
                total=layout.points, desc=layout.stage, unit="point", file=_Lines(), ascii=True,
                mininterval=_BETWEEN_LINES, maxinterval=_BETWEEN_LINES, delay=_BETWEEN_LINES,
                ncols=100,
            ) as lines,
        ):  # fmt: skip
            for part in stream.parts:
                yield part
                bar.update(part.points)
                lines.update(part.points)

    return Stream(layout, parts())
