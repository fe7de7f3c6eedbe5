"""Measure octsim's speed, as ratios within one run, and write them to a dataset and the docs.

Run by `make bench`. What is compared takes turns; medians are given, as these machines are noisy.
"""

import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import waves
import xarray as xr
from same import numpy_tree, same_tree
from trees import NoCompilerError, scalar_tree, simd_tree

import octsim
from octsim.base.threads import each
from octsim.datasets.catalog import STAGES
from octsim.datasets.files import write
from octsim.instrument.build import detector_of, scene_of
from octsim.instrument.instrument import Instrument
from octsim.instrument.point_store import PointStore
from octsim.instrument.points import Points
from octsim.optics.beam import vogel_beam
from octsim.schemes.field_sum import intensity
from octsim.tracing.tree import trace

ROOT = Path(__file__).parent.parent
ROUNDS = 41
CORES = os.cpu_count() or 1
POINTS = 16  # enough that handing them out does not show
Work = Callable[[], object]


def take_turns(works: dict[str, Work], rounds: int) -> dict[str, list[float]]:
    """Time some works in turn, round after round; seconds of each."""
    seconds: dict[str, list[float]] = {name: [] for name in works}
    for work in works.values():
        work()
    for _ in range(rounds):
        for name, work in works.items():
            began = time.perf_counter()
            work()
            seconds[name].append(time.perf_counter() - began)
    return seconds


def ratio(seconds: dict[str, list[float]], of: str, to: str) -> float:
    """Median over the rounds of how many times longer one took than another."""
    return statistics.median(a / b for a, b in zip(seconds[of], seconds[to], strict=True))


def trees() -> list[tuple[str, float, float]]:
    """Measure the ray tree: name, segments a second, speed of octsim's on one core over it."""
    config = octsim.load_config()
    scene, detector, focus = scene_of(config, 1.4), detector_of(config), 0.876
    beam = vogel_beam(config.tracing.rays, detector.objective_radius, detector.focus_distance)
    arguments = (scene, beam, detector, focus)
    octsim_tree = partial(trace, *arguments)
    octsim_name = "octsim, one core"
    works: dict[str, Work] = {
        octsim_name: octsim_tree,
        f"octsim, {CORES} cores": lambda: list(each(lambda _: octsim_tree(), range(POINTS), CORES)),
        "numpy, breadth first": partial(numpy_tree, *arguments),
    }
    by_c: dict[str, Work] = {
        "C, same arithmetic, scalar": partial(same_tree, "same_scalar", *arguments),
        "C, same arithmetic, SIMD": partial(same_tree, "same_lanes", *arguments),
        "C, this scene's invariants, scalar": partial(scalar_tree, *arguments),
        "C, this scene's invariants, SIMD": partial(simd_tree, *arguments),
    }
    try:
        by_c["C, same arithmetic, scalar"]()
        works |= by_c
    except NoCompilerError as error:
        print(f"the C trees are left out: {error}", file=sys.stderr)
    expected = octsim_tree()
    for name, work in works.items():
        found = work()
        if name not in list(works)[:2]:
            assert found.segments == expected.segments, name
            assert math.isclose(found.amplitude.sum(), expected.amplitude.sum(), rel_tol=1e-9), name
    seconds = take_turns(works, ROUNDS)
    traced = {name: expected.segments * (POINTS if name == list(works)[1] else 1) for name in works}
    return [
        (
            name,
            traced[name] / statistics.median(seconds[name]),
            ratio(seconds, name, octsim_name) * traced[octsim_name] / traced[name],
        )
        for name in works
    ]


def spectrum_sum() -> tuple[float, float]:
    """Measure the sum over wavenumbers: speed over naive numpy, error over the peak."""
    config = octsim.load_config()
    detector = detector_of(config)
    beam = vogel_beam(config.tracing.rays, detector.objective_radius, detector.focus_distance)
    found = trace(scene_of(config, 1.4), beam, detector, 0.876)
    k, path = config.spectrum.wavenumbers(), found.optical_path_length

    def naive() -> object:
        return np.abs((found.amplitude * np.exp(1j * np.outer(k, path))).sum(axis=1)) ** 2

    fast = partial(intensity, found.amplitude, path, k)
    seconds = take_turns({"octsim": fast, "naive": naive}, ROUNDS)
    rays = list(zip(found.amplitude.tolist(), path.tolist(), strict=True))
    exact = [
        math.fsum(a * math.cos(x * p) for a, p in rays) ** 2
        + math.fsum(a * math.sin(x * p) for a, p in rays) ** 2
        for x in k.tolist()
    ]
    spectrum = fast()
    return ratio(seconds, "naive", "octsim"), float(np.abs(spectrum - exact).max() / max(exact))


def point_from_cache() -> float:
    """Measure what a point from the cache takes, over tracing it."""
    config = octsim.load_config()
    with tempfile.TemporaryDirectory() as folder:
        points = Points(PointStore(Path(folder), 1))
        kept, traced = Instrument(config, points).light, Instrument(config).light
        kept(1.4, 0.876)
        works: dict[str, Work] = {
            "kept": partial(kept, 1.4, 0.876), "traced": partial(traced, 1.4, 0.876),
        }  # fmt: skip
        return ratio(take_turns(works, ROUNDS), "kept", "traced")


def seconds_of(command: list[str], folder: Path) -> float:
    """Time a command in a folder."""
    began = time.perf_counter()
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return time.perf_counter() - began


def pipeline(rounds: int = 3) -> dict[str, float]:
    """Measure the whole pipeline: medians of a few runs of the default config, in seconds."""
    python = sys.executable
    snakemake = [python, "-m", "snakemake", "--cores", "2"]
    stages = ", ".join(f"octsim.stages.{name}" for name in STAGES)
    modules = f"{stages}, octsim.figures, octsim.config.load"
    taken: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        shutil.copy(ROOT / "Snakefile", folder)
        for part in ("workflow", "profiles"):
            shutil.copytree(ROOT / part, folder / part)
        every, results = ("results", ".octsim"), ("results",)
        steps: dict[str, tuple[tuple[str, ...], list[str]]] = {
            "from nothing": (every, snakemake),
            "nothing to do": ((), snakemake),
            "figures alone": ((), [*snakemake, "--forcerun", "figures"]),
            "imports of one job": ((), [python, "-c", f"import {modules}"]),
            "from nothing, but all points in the cache": (results, snakemake),
        }
        for _ in range(rounds):
            for name, (removed, command) in steps.items():
                for part in removed:
                    shutil.rmtree(folder / part, ignore_errors=True)
                taken.setdefault(name, []).append(seconds_of(command, folder))
            jobs = (folder / "results" / "thesis" / "benchmarks").glob("*.tsv")
            whole = sum(float(job.read_text().splitlines()[1].split("\t")[0]) for job in jobs)
            taken.setdefault("all jobs together", []).append(whole)
        taken["from nothing, by preset exact"] = [waves.of_the_pipeline(folder)]
    return {name: statistics.median(seconds) for name, seconds in taken.items()}


def report(dataset: xr.Dataset) -> str:
    """Write the page of what was measured."""
    rows = "\n".join(
        f"| {name} | {float(rate) / 1e6:.0f} | {float(speed):.2f} |"
        for name, rate, speed in zip(
            dataset["tree"].values, dataset["segment_rate"], dataset["octsim_speed"], strict=True
        )
    )
    steps = "\n".join(
        f"| {name} | {float(seconds):.1f} |"
        for name, seconds in zip(dataset["step"].values, dataset["step_time"], strict=True)
    )
    return TEMPLATE.format(
        rows=rows,
        steps=steps,
        cores=CORES,
        sum_speed=float(dataset["sum_speed"]),
        sum_error=float(dataset["sum_error"]),
        kept=float(dataset["kept_time"]),
        points=", ".join(f"{float(ratio):.0f}" for ratio in dataset["waves_point_time"]),
        point=float(dataset["waves_point_time"].mean()),
        diameters=", ".join(f"{float(d):g}" for d in dataset["diameter"]),
        scan=float(dataset["waves_scan_time"]),
        foci=octsim.load_config().focus_scan.focus.num,
        bar_of_a_point=waves.BAR_OF_A_POINT,
        bar_of_a_scan=waves.BAR_OF_A_SCAN,
        bar_of_all=waves.BAR_OF_ALL,
    )


TEMPLATE = """# Speed

Written by `make bench`; do not edit. Medians of one run on a machine with {cores} cores; the ratios
say more than the rates, as what is compared took turns.

## The ray tree

The full tree of 3000 rays, d = 1.4 µm. All find the same rays and count the same segments.

| tree | million segments a second | octsim on one core is so many times as fast |
| --- | --- | --- |
{rows}

The numpy tree and the C trees of the *same arithmetic* say what the language and the compiler cost.
Those of *this scene's invariants* say what is left on the table: they trace in the plane across the
cylinder, use that every chord of one cylinder is alike, and count segments that they need not make;
they know one scene only.

## The sum over 1000 wavenumbers

{sum_speed:.0f} times as fast as `(E * exp(1j * outer(k, path))).sum(axis=1)` in numpy; its error
against an exactly rounded sum is {sum_error:.1e} of the peak.

## A point from the cache

takes {kept:.1%} of the time that tracing it takes (3000 rays).

## Maxwell's equations

A point by preset exact, alone, takes {points} times the processor time of one of 3000 rays at
diameters of {diameters} µm: {point:.0f} on average (to stay within {bar_of_a_point}). The scan of
{foci} foci (figure 6) takes {scan:.1f} s of it (within {bar_of_a_scan}).

## The pipeline, default config, two cores

| | seconds |
| --- | --- |
{steps}

*By preset exact* is to stay within {bar_of_all} s.

*Imports of one job* is a process that imports what all jobs need together and does nothing else.
A run does that once: its jobs are forks of one such process.
"""


def main() -> None:
    """Measure everything, and write `results/bench/bench.nc` and `docs/speed.md`."""
    measured = trees()
    sum_speed, sum_error = spectrum_sum()
    points = waves.of_a_point(ROUNDS)
    steps = pipeline()

    def of(value: object, units: str, long_name: str, *dimensions: str) -> tuple[object, ...]:
        return dimensions, value, {"units": units, "long_name": long_name}

    dataset = xr.Dataset(
        {
            "segment_rate": of([m[1] for m in measured], "s-1", "segments traced a second", "tree"),
            "octsim_speed": of([m[2] for m in measured], "1", "speed of octsim over this", "tree"),
            "sum_speed": of(sum_speed, "1", "speed of the sum over naive numpy"),
            "sum_error": of(sum_error, "1", "error of the sum over its peak"),
            "kept_time": of(point_from_cache(), "1", "time of a point from the cache over tracing"),
            "waves_point_time": of(
                list(points.values()), "1", "time of a point by waves over 3000 rays", "diameter"
            ),
            "waves_scan_time": of(waves.of_a_scan(), "s", "time of a scan of foci by waves"),
            "step_time": of(list(steps.values()), "s", "time of a step", "step"),
        },
        {
            "tree": of([m[0] for m in measured], "1", "ray tree", "tree"),
            "diameter": of(list(points), "um", "diameter of the neuron", "diameter"),
            "step": of(list(steps), "1", "step of the pipeline", "step"),
        },
        {"title": "Speed of octsim", "octsim_version": octsim.__version__, "stage": "bench"},
    )
    write(dataset, ROOT / "results" / "bench" / "bench.nc")
    page = report(dataset)
    (ROOT / "docs" / "speed.md").write_text(page, encoding="utf-8")
    print(page)


if __name__ == "__main__":
    main()
