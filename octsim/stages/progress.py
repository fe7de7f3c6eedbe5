"""How far a stage is: shown on a terminal as it goes, and a line a minute in the log."""

import io
import logging
import time
from collections.abc import Iterator

from tqdm import tqdm

from octsim.base.compile_time import compiled_for
from octsim.base.say import note
from octsim.datasets.streams import Part, Stream

_BETWEEN_LINES = 60.0  # s
_BETWEEN_NOTES = 0.5  # s


class _Lines(io.StringIO):
    """Takes what a bar writes, and logs it line by line."""

    def write(self, text: str) -> int:
        if said := text.strip():
            logging.info("%s", said)
        return len(text)


def words(done: int, points: int, seconds: float) -> str:
    """Return how many points are done, and how long the others take at this rate."""
    left = (
        f", {tqdm.format_interval(seconds / done * (points - done))} left"
        if 0 < done < points
        else ""
    )
    return f"{done} of {points} points{left}"


def watched(stream: Stream) -> Stream:
    """Return the same stage, telling of its progress as its parts are taken."""
    layout = stream.layout

    def parts() -> Iterator[Part]:
        with tqdm(
            total=layout.points, desc=layout.stage, unit="point", file=_Lines(), ascii=True,
            mininterval=_BETWEEN_LINES, maxinterval=_BETWEEN_LINES, delay=_BETWEEN_LINES,
            ncols=100,
        ) as lines:  # fmt: skip
            compiled_for()  # before this
            began, noted = time.monotonic(), -_BETWEEN_NOTES
            for part in stream.parts:
                yield part
                # they begin when tracing did, after what compiling has taken
                spent = compiled_for()
                began += spent
                lines.start_t, lines.last_print_t = (
                    lines.start_t + spent,
                    lines.last_print_t + spent,
                )
                lines.update(part.points)
                if (now := time.monotonic()) - noted > _BETWEEN_NOTES:
                    note(words(int(lines.n), layout.points, now - began))
                    noted = now

    return Stream(layout, parts())
