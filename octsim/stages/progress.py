"""How far a stage is: a bar with rate and time left on a terminal, a line a minute in the log."""

import io
import logging
from collections.abc import Iterator
from typing import Any

from tqdm import tqdm

from octsim.base.compile_time import compiled_for
from octsim.datasets.streams import Part, Stream

_BETWEEN_LINES = 60.0  # s
_AFTER = 2.0  # s; what takes less needs no bar


class _Lines(io.StringIO):
    """Takes what a bar writes, and logs it line by line."""

    def write(self, text: str) -> int:
        if said := text.strip():
            logging.info("%s", said)
        return len(text)


def _leave_out(seconds: float, *bars: "tqdm[Any]") -> None:
    """Have bars begin when tracing did, after what compiling has taken."""
    for bar in bars:
        if not bar.disable:
            bar.start_t, bar.last_print_t = bar.start_t + seconds, bar.last_print_t + seconds


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
            compiled_for()  # before these bars
            for part in stream.parts:
                yield part
                _leave_out(compiled_for(), bar, lines)
                bar.update(part.points)
                lines.update(part.points)

    return Stream(layout, parts())
