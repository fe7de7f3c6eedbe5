"""How cost grows with the work: points, rays, wavenumbers and combinations, each on its own.

Run by `make bench-growth`, which writes docs/sweeps.md and docs/figures/growth.svg; minutes. Each
size is measured in a process of its own; sizes that are left out are not shown.
"""

import argparse
import resource
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from marked import write_part
from matplotlib.figure import Figure

from octsim.config.load import load_and_tell, load_config
from octsim.datasets.files import opened
from octsim.datasets.writer import write_stream
from octsim.figures.style import look, save
from octsim.stages.detections import detections
from octsim.stages.spectra import spectra
from octsim.studies.tradeoff.measured_cost import apart

ROOT = Path(__file__).parents[1]
FIGURE = ROOT / "docs" / "figures" / "growth.svg"
SIZES = {
    "points": (10, 100, 1_000, 10_000, 100_000),
    "rays": (1_000, 10_000, 100_000, 1_000_000, 10_000_000),
    "wavenumbers": (1_000, 10_000, 100_000, 1_000_000),
    "combinations": (10, 100, 1_000, 10_000, 100_000),
}
WHAT = {
    "points": "traced by 300 rays, summed at 64 wavenumbers, written",
    "rays": "of one point, traced and kept",
    "wavenumbers": "at which 3000 rays are summed",
    "combinations": "of two zipped keys, checked before a run",
}


class Took(NamedTuple):
    """What a size took."""

    seconds: float
    """Processor time."""
    megabytes: float
    """Largest memory of the process."""


def overlay(points: int, rays: int, samples: int) -> dict[str, Any]:
    """Return a config of so many points, rays and wavenumbers, without a cache."""
    return {
        "tracing": {"rays": rays},
        "spectrum": {"samples": samples},
        "sweep": {
            "diameters": {"start": "1 um", "stop": "2 um", "num": points},
            "focus": {"slope": 0.581, "intercept": "69 nm"},
        },
        "cache": {"gigabytes": 0},
    }


def trace_and_sum(config: dict[str, Any], folder: Path, sums: bool) -> None:
    """Trace a sweep, and sum it."""
    read = load_config(config)
    write_stream(detections.stream(read, None, 1), folder / "detections.nc")
    if sums:
        with opened(folder / "detections.nc", "detections", read) as light:
            write_stream(spectra.stream(read, light, 1), folder / "spectra.nc")


def zipped(count: int) -> dict[str, Any]:
    """Return a grid of so many combinations."""
    lengths = {
        "scene.gap": [f"{5 + 1e-4 * n:.6g} nm" for n in range(count)],
        "detector.core_diameter": [f"{3.5 + 1e-6 * n:.8g} um" for n in range(count)],
    }
    return {"grid": {"combine": "zip", **lengths}}


def measured(name: str, size: int, folder: Path) -> Took:
    """Measure one size, beyond what the smallest takes that compiles and imports before it."""
    warnings.simplefilter("ignore")
    trace_and_sum(overlay(2, 100, 64), folder, sums=True)
    load_and_tell(zipped(2))
    work: dict[str, Callable[[], object]] = {
        "points": lambda: trace_and_sum(overlay(size, 300, 64), folder, sums=True),
        "rays": lambda: trace_and_sum(overlay(2, size, 64), folder, sums=False),
        "wavenumbers": lambda: trace_and_sum(overlay(2, 3000, size), folder, sums=True),
        "combinations": lambda: load_and_tell(zipped(size)),
    }
    of = 2 if name in ("rays", "wavenumbers") else 1  # points, as a sweep has two at least
    begin = time.process_time()
    work[name]()
    seconds = (time.process_time() - begin) / of
    return Took(seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def lines(found: dict[str, dict[int, Took]]) -> list[str]:
    """Return the part's lines: a table of each, with where it bends."""
    told = [
        "Processor time of one thread, and the largest memory of its process, each measured once:",
        "",
        "| | | seconds | of one, µs | memory, MiB |",
        "| --- | --- | --- | --- | --- |",
    ]
    for name, sizes in found.items():
        for size, took in sizes.items():
            what = f"{name}, {WHAT[name]}" if size == min(sizes) else ""
            told.append(
                f"| {what} | {size:,} | {took.seconds:.3g} | {1e6 * took.seconds / size:.3g} | "
                f"{took.megabytes:.0f} |"
            )
    told += ["", "![Cost over the size of the work](figures/growth.svg)", ""]
    for name, sizes in found.items():
        largest = max(sizes)
        each = {size: took.seconds / size for size, took in sizes.items()}
        linear = [size for size in sizes if each[size] <= 1.5 * min(each.values())]
        left = [size for size in SIZES[name] if size > largest]
        missing = f"; {', '.join(f'{size:,}' for size in left)} not measured" if left else ""
        told.append(
            f"- {name}: within 1.5 times the least for each from {min(linear):,} to "
            f"{max(linear):,}{missing}."
        )
    return told


def draw(found: dict[str, dict[int, Took]]) -> None:
    """Draw what each took over its size."""
    with look():
        figure = Figure(figsize=(12, 3))
        _draw(figure, found)
        save(figure, FIGURE)


def _draw(figure: Figure, found: dict[str, dict[int, Took]]) -> None:
    every = figure.subplots(1, len(found), sharey=True)
    for axes, (name, sizes) in zip(every, found.items(), strict=True):
        axes.loglog(list(sizes), [took.seconds for took in sizes.values()], "o-", color="black")
        last = max(sizes)
        rate = sizes[last].seconds / last
        axes.loglog([min(sizes), last], [rate * min(sizes), rate * last], ":", color="gray")
        axes.set_xlabel(name)
    every[0].set_ylabel("processor time (s)")


def main() -> None:
    """Measure, draw and write."""
    parser = argparse.ArgumentParser(description=__doc__, prog="growth.py")
    parser.add_argument(
        "--longest", type=float, default=60.0, help="no size after one of so many s"
    )
    parser.add_argument("--write", action="store_true", help="write docs/sweeps.md and its figure")
    asked = parser.parse_args()
    found: dict[str, dict[int, Took]] = {}
    for name, sizes in SIZES.items():
        found[name] = {}
        for size in sizes:
            with tempfile.TemporaryDirectory() as folder:
                took = apart(None, measured, name, size, Path(folder))
            print(name, size, took, flush=True)
            found[name][size] = took
            if took.seconds > asked.longest / 10:  # the next takes ten times as long
                break
    print(*lines(found), sep="\n")
    if asked.write:
        draw(found)
        write_part(ROOT / "docs" / "sweeps.md", "growth", lines(found))


if __name__ == "__main__":
    sys.exit(main())
