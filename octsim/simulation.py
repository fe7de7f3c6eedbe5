"""A config's instrument at work: a diameter and a focus in, detected rays or intensity out."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from octsim.beam import vogel_beam
from octsim.config import Config
from octsim.detection import detector_of
from octsim.scene import neuron_on_glass
from octsim.spectrum import intensity, wavenumbers
from octsim.threads import each
from octsim.tracing import Detections, trace


def tracer(config: Config) -> Callable[[float, float], Detections]:
    """Make the function of diameter and focus (µm) that traces a config's instrument."""
    beam = vogel_beam(config.objective, config.tracing, config.scene.refractive_index.glass)
    detector = detector_of(config)

    def at(diameter: float, focus: float) -> Detections:
        scene = neuron_on_glass(config.scene, diameter)
        tracing = config.tracing
        return trace(scene, beam, detector, focus, tracing.max_intersections, tracing.min_amplitude)

    return at


def mean_intensities(
    config: Config, diameters: NDArray[np.float64], foci: NDArray[np.float64], threads: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Intensity as a mean over the band, and number of detected rays, for points (P,) in µm.

    Returns
    -------
    intensity : ndarray, shape (P,)
        Mean over the wavenumbers.
    rays_detected : ndarray, shape (P,)
        Number of rays that reach the detector.
    """
    trace_at, k = tracer(config), wavenumbers(config.spectrum)

    def measure(point: tuple[float, float]) -> tuple[float, int]:
        found = trace_at(*point)
        spectrum = intensity(found.amplitude, found.optical_path_length, k)
        return float(spectrum.mean()), found.amplitude.size

    measured = each(measure, zip(diameters.tolist(), foci.tolist(), strict=True), threads)
    means, counts = zip(*measured, strict=True)
    return np.array(means), np.array(counts)
