"""Path tracing and Metropolis sampling beside scheme paths: error of the spectrum over time."""

import statistics
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from peers.others import table
from peers.ray_job import DIAMETER, FOCUS, MEETINGS, job_of
from peers.walk import metropolis, path_tracing, setting_of

import octsim
from octsim.instrument.instrument import Instrument
from octsim.optics.beam import Beam, aim
from octsim.schemes.field_sum import intensity
from octsim.tracing.tree import trace

JOB = job_of(3000)
WAVENUMBERS = octsim.load_config().spectrum.wavenumbers()
SEEDS = 7
EQUAL = 1e-3
"""Error at which all are compared."""
Spectrum = NDArray[np.float64]


class Method(NamedTuple):
    """A way to a spectrum."""

    name: str
    effort: str
    spectrum: Callable[[int], Spectrum]
    """From a seed."""
    order: float
    """Power of the time by which the error falls; 0 where it is asked for."""


def by_scheme(scheme: str, **options: float) -> Callable[[int], Spectrum]:
    """Return a scheme of octsim's, by an instrument that has kept nothing from the last time."""
    config = octsim.load_config({"tracing": {"scheme": scheme, **options}})
    return lambda _: Instrument(config).spectrum(DIAMETER, FOCUS).intensity


def random_rays(rays: int) -> Callable[[int], Spectrum]:
    """Return the ray tree of rays drawn at random over the aperture."""

    def spectrum(seed: int) -> Spectrum:
        draw = np.random.default_rng(seed)
        radius = JOB.detector.objective_radius * np.sqrt(draw.random(rays))
        turn = 2 * np.pi * draw.random(rays)
        along = aim(radius * np.cos(turn), radius * np.sin(turn), JOB.detector.focus_distance)
        beam = Beam(*along, np.full(rays, 1 / rays), np.arange(rays))
        found = trace(JOB.scene, beam, JOB.detector, FOCUS, MEETINGS)
        return intensity(found.amplitude, found.optical_path_length, WAVENUMBERS)

    return spectrum


def random_paths(samples: int, power: float) -> Callable[[int], Spectrum]:
    """Return path tracing."""
    setting = setting_of(JOB)
    return lambda seed: intensity(*path_tracing(setting, samples, power, seed)[:2], WAVENUMBERS)


def chain(samples: int, power: float) -> Callable[[int], Spectrum]:
    """Return Metropolis sampling."""
    setting = setting_of(JOB)
    return lambda seed: intensity(*metropolis(setting, samples, power, seed), WAVENUMBERS)


METHODS = (
    Method("scheme paths", "accuracy 3e-2", by_scheme("paths", accuracy=3e-2), 0),
    Method("scheme paths", "accuracy 1e-3", by_scheme("paths", accuracy=EQUAL), 0),
    Method("scheme paths", "accuracy 1e-4", by_scheme("paths", accuracy=1e-4), 0),
    Method("ray tree, spiral", "3000 rays", by_scheme("vogel", rays=3000), 0.9),
    Method("ray tree, rays at random", "3000 rays", random_rays(3000), 0.5),
    Method("ray tree, rays at random", "100 000 rays", random_rays(100_000), 0.5),
    Method("path tracing, chosen by energy", "1e6 paths", random_paths(10**6, 2), 0.5),
    Method("path tracing, chosen by amplitude", "1e6 paths", random_paths(10**6, 1), 0.5),
    Method("Metropolis, chosen by energy", "3e5 proposals", chain(300_000, 2), 0.5),
    Method("Metropolis, chosen by amplitude", "3e5 proposals", chain(300_000, 1), 0.5),
)


def measured(method: Method, truth: Spectrum) -> tuple[float, float]:
    """Return the error and the seconds of a method, medians over seeds."""
    method.spectrum(0)  # compiled
    errors, seconds = [], []
    for seed in range(SEEDS):
        began = time.perf_counter()
        found = method.spectrum(seed)
        seconds.append(time.perf_counter() - began)
        errors.append(float(np.abs(found - truth).max() / truth.max()))
    return statistics.median(errors), statistics.median(seconds)


def section() -> str:
    """Measure, and write the page's part."""
    truth = by_scheme("paths", accuracy=1e-8)(0)
    results = [measured(method, truth) for method in METHODS]
    least = results[1][1]
    rows = []
    for method, (error, seconds) in zip(METHODS, results, strict=True):
        equal = seconds * (error / EQUAL) ** (1 / method.order) if method.order else seconds
        rows.append([
            method.name, method.effort, f"{error:.2g}", f"{seconds * 1e3:.3g}",
            f"{equal:.2g}" if method.order else "", f"{equal / least:.2g}" if method.order else "",
        ])  # fmt: skip
    head = [
        "method", "effort", "max abs(ΔI) / max I", "ms a spectrum",
        "s to an error of 1e-3", "times what scheme paths takes to it",
    ]  # fmt: skip
    return table(head, rows)
