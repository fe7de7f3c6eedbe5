"""What a large grid takes: time a point, memory, and the share of tracing and processing.

Each count of combinations runs in a process of its own, stage by stage, streamed to files as in a
run, without a cache, so that all is traced. `make bench-sweeps`; some minutes on two cores.
"""

import resource
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from octsim.config.load import load_config
from octsim.datasets.files import opened
from octsim.datasets.reader import Stored
from octsim.datasets.streams import Part, Stream
from octsim.datasets.writer import write_stream
from octsim.stages.detections import detections
from octsim.stages.fourier import fourier
from octsim.stages.paths import light_paths
from octsim.stages.phase_slope import phase_slope
from octsim.stages.spectra import spectra
from octsim.studies.tradeoff.measured_cost import apart

COUNTS = ((10, 4), (25, 10), (25, 40))
THREADS = 2
GRID: dict[str, Any] = {
    "tracing": {"preset": "standard"},
    "sweep": {"focus": {"slope": 0.581, "intercept": "69 nm"}},
}


class Making:
    """Processor time of tracing and processing, apart from what reads and writes files."""

    def __init__(self) -> None:
        self.seconds = 0.0
        read = Stored.part

        def timed_read(*arguments: Any, **keywords: Any) -> Any:
            begin = time.process_time()
            part = read(*arguments, **keywords)
            self.seconds -= time.process_time() - begin
            return part

        Stored.part = timed_read  # type: ignore[method-assign]

    def timed(self, stream: Stream) -> Stream:
        """Give the same stage, adding up what its parts take but for what they read."""

        def parts() -> Iterator[Part]:
            left = iter(stream.parts)
            while True:
                begin = time.process_time()
                part = next(left, None)
                self.seconds += time.process_time() - begin
                if part is None:
                    return
                yield part

        return Stream(stream.layout, parts())


def measure(cores: int, gaps: int, folder: Path) -> list[str]:
    """Run a grid of so many core diameters and gaps, and tell what it took, stage by stage."""
    warnings.simplefilter("ignore")
    begin_all, cpu_all = time.monotonic(), time.process_time()
    config = load_config(
        GRID,
        {
            "grid": {
                "detector.core_diameter": {"start": "3.5 um", "stop": "5 um", "num": cores},
                "scene.gap": {"start": "0 nm", "stop": "50 nm", "num": gaps},
            }
        },
    )
    told, making = [], Making()

    def stage(name: str, make: Callable[[Any], Stream], source: str | None) -> None:
        before, cpu, made = time.monotonic(), time.process_time(), making.seconds
        if source is None:
            write_stream(making.timed(make(None)), folder / f"{name}.nc")
        else:
            with opened(folder / f"{source}.nc", source, config) as dataset:
                write_stream(making.timed(make(dataset)), folder / f"{name}.nc")
        cpu, made = time.process_time() - cpu, making.seconds - made
        told.append(
            f"  {name:12} {time.monotonic() - before:7.1f} s, processor {cpu:7.1f} s, of which "
            f"tracing and processing {100 * made / cpu:3.0f} %, file "
            f"{(folder / f'{name}.nc').stat().st_size / 1e6:7.0f} MB"
        )

    stage("detections", lambda _: detections.stream(config, None, THREADS), None)
    stage("spectra", lambda d: spectra.stream(config, d, THREADS), "detections")
    stage("paths", lambda d: light_paths.stream(config, d), "detections")
    stage("fourier", lambda d: fourier.stream(config, d), "spectra")
    stage("phase_slope", lambda d: phase_slope.stream(config, d), "fourier")
    count = cores * gaps
    cpu, points = time.process_time() - cpu_all, count * config.sweep.diameters.num
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return [
        f"{count} combinations, {points} points: {time.monotonic() - begin_all:.0f} s, processor "
        f"{cpu:.0f} s = {1e3 * cpu / points:.2f} ms a point, tracing "
        f"and processing {100 * making.seconds / cpu:.0f} %, largest memory {memory:.0f} MiB",
        *told,
    ]


def main() -> None:
    """Print what each count of combinations takes; the first compiles what it needs."""
    with tempfile.TemporaryDirectory(dir=sys.argv[1] if len(sys.argv) > 1 else None) as folder:
        apart(None, measure, 1 + 1, 2, Path(folder))
        for cores, gaps in COUNTS:
            print(*apart(None, measure, cores, gaps, Path(folder)), sep="\n", flush=True)


if __name__ == "__main__":
    main()
