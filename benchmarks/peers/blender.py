"""Blender's Cycles beside octsim: the part of the light that returns to the objective."""

import math
import time

from peers.others import asked, environment, table
from peers.ray_job import DIAMETER, FOCUS, MEETINGS, job_of
from peers.walk import path_tracing, setting_of
from trees import indices

SAMPLES = (16, 256, 1024)
OWN_PATHS = 4_000_000
OWN_RUNS = 4


def section() -> str:
    """Measure, and write the page's part."""
    job = job_of(1)
    asked_of_it = {
        "indices": indices(job.scene), "gap": job.cylinder.z - DIAMETER / 2, "diameter": DIAMETER,
        "focus": FOCUS, "focus_distance": job.detector.focus_distance,
        "objective_radius": job.detector.objective_radius, "meetings": MEETINGS,
        "samples": [1, *SAMPLES],
    }  # fmt: skip
    found = asked(environment("cycles"), "cycles_run.py", asked_of_it)
    setting = setting_of(job)
    path_tracing(setting, 1, 1.0, 0)  # compiled
    began = time.perf_counter()
    runs = [path_tracing(setting, OWN_PATHS, 1.0, seed)[2] for seed in range(OWN_RUNS)]
    rate = OWN_RUNS * OWN_PATHS / (time.perf_counter() - began)
    mean = sum(runs) / OWN_RUNS
    error = math.sqrt(sum((run - mean) ** 2 for run in runs) / (OWN_RUNS - 1) / OWN_RUNS)
    rows = [
        [
            f"{result['rays']:,}", f"{result['mean']:.5f} ± {result['error']:.5f}",
            f"{(result['mean'] - mean) / math.hypot(error, result['error']):+.1f}",
            f"{result['seconds']:.3g}", f"{result['rays'] / result['seconds'] / 1e3:.3g}",
        ]
        for result in found["results"][1:]
    ]  # fmt: skip
    head = [
        "rays of Cycles", "light that returns through the objective", "standard errors from ours",
        "seconds, one thread", "thousand rays a second",
    ]  # fmt: skip
    return (
        f"Blender {found['version']}. By octsim's own formulas {mean:.5f} ± {error:.5f} returns "
        f"({OWN_RUNS * OWN_PATHS:,} random paths of `walk.py`, {rate / 1e3:,.0f} thousand a "
        f"second).\n\n{table(head, rows)}"
    )
