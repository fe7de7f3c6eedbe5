"""A config's instrument at work: a diameter and a focus in, detected light and intensity out."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.config.models import Config
from octsim.optics.band import wavenumbers
from octsim.schemes.field_sum import sum_paths, sum_rays
from octsim.schemes.light import AccuracyStatus, Light
from octsim.schemes.paths.integrate import path_tracer
from octsim.schemes.vogel import spiral_tracer

Tracer = Callable[[float, float], Light]
"""Gives the detected light of a diameter and a focus, µm."""


def tracer(config: Config) -> Tracer:
    """Make the function of diameter and focus (µm) that traces a config's instrument."""
    return spiral_tracer(config) if config.tracing.scheme == "vogel" else path_tracer(config)


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


Spectrometer = Callable[[float, float], tuple[NDArray[np.float64], float, AccuracyStatus]]
"""Gives spectrum (K,), its error and status of a diameter and a focus, µm."""


def spectrometer(config: Config) -> Spectrometer:
    """Make the function of diameter and focus (µm) that traces and sums a config's spectrum."""
    trace_at, sum_light = tracer(config), summer(config)

    def at(diameter: float, focus: float) -> tuple[NDArray[np.float64], float, AccuracyStatus]:
        light = trace_at(diameter, focus)
        return *sum_light(light), light.status

    return at


class Brightness(NamedTuple):
    """Intensity of one point, as a mean over the band."""

    mean: float
    """Mean over the wavenumbers."""
    error: float
    """Estimate of its error, relative to it."""
    status: AccuracyStatus
    """Whether that is as asked."""


def meter(config: Config) -> Callable[[Light], Brightness]:
    """Make the function that gives the mean intensity of a config's light."""
    sum_light = summer(config)

    def measure(light: Light) -> Brightness:
        spectrum, error = sum_light(light)
        mean = float(spectrum.mean())
        relative = error * float(spectrum.max()) / mean if mean > 0 else error
        return Brightness(mean, relative, light.status)

    return measure
