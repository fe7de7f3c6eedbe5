"""What happens around the spike: converged spectra, their level, and what it leaks."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from octsim.phase.transform import centred_by
from octsim.studies.causes.moved_spectra import MovedSpectra
from octsim.studies.causes.switches import (
    ALL,
    Reading,
    signal,
    slopes,
    strongest,
    true_level,
    weights,
)

Array = NDArray[np.float64]
_REACH, _NUM = 0.02, 81  # µm to each side, and how many spectra


def diameters_around(spike: float) -> Array:
    """Return diameters around a spike's, µm, (N,)."""
    side = min(_REACH, spike / 2)
    return np.linspace(spike - side, spike + side, _NUM)


def spike_variables(spectra: MovedSpectra, reading: Reading) -> dict[str, Any]:
    """Return the dataset's variables of spectra around a spike, read at the same diameters."""
    present = ALL - {"rays", "step"}
    stencil, processing = spectra.chosen(present), reading.processing
    intensity = stencil.at.intensity()
    subtracted = (intensity - centred_by(intensity, processing))[:, 0]
    level_error = subtracted - true_level(stencil.at, processing)[:, 0]
    window = weights(processing, reading.wavenumber.size)
    full = signal(stencil.at, ALL, processing)
    component = strongest(full)
    read = np.fft.fft(full)[np.arange(component.size), component]
    # what a constant gives in that component, through the window
    leaked = -level_error * np.fft.fft(window)[component]
    without_centre = slopes(stencil, present - {"centre"}, reading)
    of_diameter: dict[str, Any] = {
        "component": component,
        "maximum": reading.wavenumber[intensity.argmax(axis=1)],
        "minimum": reading.wavenumber[intensity.argmin(axis=1)],
        "level_error": level_error,
        "amplitude": np.abs(stencil.at.beat) @ window,
        "leakage": np.abs(leaked / read),
        "leaked_phase": np.angle(read * (read - leaked).conj()),
        "phase_slope": slopes(stencil, present, reading),
        "phase_slope_without_centre": without_centre,
    }
    return {
        "spike_intensity": (("spike_neighbour", "wavenumber"), intensity),
        **{f"spike_{name}": ("spike_neighbour", values) for name, values in of_diameter.items()},
    }
