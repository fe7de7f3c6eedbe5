"""Where double precision no longer suffices: what a user is told of it, with the reason.

The limits are measured: `snakemake stability` compares the tracer with one of 50 digits, and within
them, but for single rays at an edge, no phase is off by more than 1e-9 rad.
"""

from octsim.config.models import Config
from octsim.config.units import format_length

LARGEST_DIAMETER = 1e4
"""Diameter (µm) above which the last digit of the axis's height moves the phase by 1e-9 rad."""
LARGEST_GAP = 1e7
"""Gap, in diameters, above which the last digit of a height turns the cylinder's normal."""


def rounding_remarks(config: Config) -> list[str]:
    """Say, a line each, where rounding can move the phase by more than 1e-9 rad."""
    said = []
    diameters = {
        "sweep.diameters.start": config.sweep.diameters.start,
        "sweep.diameters.stop": config.sweep.diameters.stop,
        "focus_law.diameters.start": config.focus_law.diameters.start,
        "focus_law.diameters.stop": config.focus_law.diameters.stop,
        "focus_scan.diameter": config.focus_scan.diameter,
    }
    key, largest = max(diameters.items(), key=lambda item: item[1])
    if largest > LARGEST_DIAMETER:
        said.append(
            f"{key}: {format_length(largest)} is above {format_length(LARGEST_DIAMETER)}, so "
            "rounding of the cylinder's height can move the phase by more than 1e-9 rad"
        )
    gap = config.scene.gap
    key, smallest = min(diameters.items(), key=lambda item: item[1])
    if gap > LARGEST_GAP * smallest:
        said.append(
            f"scene.gap: {format_length(gap)} is above {LARGEST_GAP:g} times {key} = "
            f"{format_length(smallest)}, so rounding of heights can move the phase by more than "
            "1e-9 rad"
        )
    aperture, water = config.objective.numerical_aperture, config.scene.refractive_index.water
    if water < aperture:
        said.append(
            f"objective.numerical_aperture: {aperture} is above the index of water, {water}, so "
            "some rays are close to the critical angle, where rounding can move the phase by more "
            "than 1e-9 rad"
        )
    return said
