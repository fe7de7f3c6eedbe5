"""A config's instrument at work: a diameter and a focus in, detected light or intensity out."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from octsim.beam import vogel_beam
from octsim.config import Config
from octsim.detection import detector_of
from octsim.integration import integrate
from octsim.light import AccuracyStatus, Light
from octsim.scene import neuron_on_glass
from octsim.spectrum import sum_paths, sum_rays, wavenumbers
from octsim.threads import each
from octsim.tracing import Detections, trace

Point = tuple[float, float]
"""A diameter and a focus, µm."""


def vogel_tracer(config: Config) -> Callable[[float, float], Detections]:
    """Make the function of diameter and focus (µm) that traces the thesis's spiral of rays."""
    beam = vogel_beam(config.objective, config.tracing, config.scene.refractive_index.glass)
    detector, tracing = detector_of(config), config.tracing

    def at(diameter: float, focus: float) -> Detections:
        scene = neuron_on_glass(config.scene, diameter)
        return trace(scene, beam, detector, focus, tracing.max_intersections, tracing.min_amplitude)

    return at


def _spiral_light(found: Detections) -> Light:
    """Weigh a spiral's rays; the rougher rule is every second one: a spiral of half the rays."""
    return Light(
        found.path,
        found.amplitude,
        np.where(found.ray % 2 == 0, 2 * found.amplitude, 0.0),
        found.optical_path_length,
        0.0,
        found.segments,
        AccuracyStatus.NOT_CONTROLLED,
        found.outcomes,
    )


def tracer(config: Config) -> Callable[[float, float], Light]:
    """Make the function of diameter and focus (µm) that traces a config's instrument."""
    if config.tracing.scheme == "vogel":
        trace_at = vogel_tracer(config)
        return lambda diameter, focus: _spiral_light(trace_at(diameter, focus))
    detector, tracing, k = detector_of(config), config.tracing, wavenumbers(config.spectrum)

    def at(diameter: float, focus: float) -> Light:
        scene = neuron_on_glass(config.scene, diameter)
        band = float(k[0]), float(k[-1])
        return integrate(scene, detector, focus, band, tracing.accuracy, tracing.max_intersections)

    return at


def summer(config: Config) -> Callable[[Light], tuple[NDArray[np.float64], float]]:
    """Make the function that sums a config's light to a spectrum, and estimates its error."""
    k, accuracy = wavenumbers(config.spectrum), config.tracing.accuracy
    if config.tracing.scheme == "vogel":
        return lambda light: sum_rays(
            light.amplitude, light.rough_amplitude, light.optical_path_length, k
        )
    return lambda light: sum_paths(
        light.path,
        light.amplitude,
        light.rough_amplitude,
        light.optical_path_length,
        light.missing,
        k,
        accuracy,
    )


def mean_intensities(
    config: Config, diameters: NDArray[np.float64], foci: NDArray[np.float64], threads: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Intensity as a mean over the band, for points (P,) in µm.

    Returns
    -------
    intensity : ndarray, shape (P,)
        Mean over the wavenumbers.
    error : ndarray, shape (P,)
        Estimate of its error, relative to it.
    status : ndarray, shape (P,)
        `AccuracyStatus` of each point.
    """
    trace_at, sum_light = tracer(config), summer(config)

    def measure(point: Point) -> tuple[float, float, int]:
        light = trace_at(*point)
        spectrum, error = sum_light(light)
        mean = float(spectrum.mean())
        relative = error * float(spectrum.max()) / mean if mean > 0 else error
        return mean, relative, light.status

    points = zip(diameters.tolist(), foci.tolist(), strict=True)
    means, errors, status = zip(*each(measure, points, threads), strict=True)
    return np.array(means), np.array(errors), np.array(status)
