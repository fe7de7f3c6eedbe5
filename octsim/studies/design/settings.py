"""What is tried: apertures, fills, foci and bands, and the instrument with one thing off."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from octsim.base.errors import OctsimError
from octsim.config.abilities import as_far_as
from octsim.config.derive import changed
from octsim.config.models import Config
from octsim.config.source import unlit
from octsim.config.units import format_length
from octsim.optics.band import wavenumbers
from octsim.phase.derivatives import Array
from octsim.schemes.table import FULL_WAVE
from octsim.studies.calibration.tolerances import moved

ACCURACY = 1e-3
"""Of the spectra: it moves slopes over `STEP` by less than 0.1 %, as neighbours share its error."""
STEP = 0.01
"""Half the difference of diameters that a slope is of, µm."""
CONFIGS = ("neuron", "water", "gap", "numerical_aperture")
"""Tolerances whose change is one of the config, but for the pupil."""
PARAMETERS = ("diameter", "focus", "fill", *CONFIGS)
"""What is not known exactly, by the name of its tolerance."""


class Band(NamedTuple):
    """Wavelengths, µm, and evenly spaced wavenumbers (K,), 1/µm."""

    name: str
    wavenumber: Array


def bands_of(config: Config) -> list[Band]:
    """Return the configured band, and those that are tried beside it.

    Raises
    ------
    OctsimError
        If the source does not light one.
    """
    for place, tried in enumerate(config.design.bands):
        for problem in unlit(config.spectrum.source, tried):
            raise OctsimError(f"design.bands.{place}: {problem}")
    own, samples = config.spectrum.wavelength, config.spectrum.samples
    pairs = dict.fromkeys(
        [(own.min, own.max), *((one.min, one.max) for one in config.design.bands)]
    )
    return [
        Band(f"{1e3 * low:g}-{1e3 * high:g} nm", wavenumbers(low, high, samples))
        for low, high in pairs
    ]


def apertures_of(config: Config) -> list[float]:
    """Return the configured aperture, and those that are tried beside it, increasing.

    Raises
    ------
    OctsimError
        If one is not below the water's index with its tolerance, as the scheme needs it.
    """
    own, water = config.objective.numerical_aperture, config.host_index
    tolerances = config.calibration.tolerances
    most = water - tolerances.water - tolerances.numerical_aperture
    keys = {"objective.numerical_aperture": [own], "design.apertures": config.design.apertures}
    for key, given in keys.items():
        for aperture in given:
            if not aperture < most:
                raise OctsimError(
                    f"design: {key} {aperture:g} given, but scheme fullwave needs it below the "
                    f"index of {config.scene.host_medium} less both tolerances, {most:g}; give less"
                )
    return sorted({own, *config.design.apertures})


def waves(config: Config, aperture: float) -> Config:
    """Return the config solved by scheme fullwave, of an aperture, over all bands that are tried.

    Parameters
    ----------
    config : Config
    aperture : float
        Numerical aperture.
    """
    own, others = config.spectrum.wavelength, config.design.bands
    low, high = min([own.min, *(o.min for o in others)]), max([own.max, *(o.max for o in others)])
    return changed(
        as_far_as(FULL_WAVE, config),
        {
            "tracing": {"preset": None, "scheme": FULL_WAVE.name, "accuracy": ACCURACY},
            "objective": {"numerical_aperture": aperture, "pupil": None},
            "spectrum": {"wavelength": {"min": format_length(low), "max": format_length(high)}},
        },
    )


def filled(config: Config, fill: float) -> Config:
    """Return a config, without a pupil of its own, whose pupil a Gaussian fills."""
    return changed(config, {"objective": {"pupil": {"gaussian": fill}}})


def configs_off(config: Config) -> Iterator[tuple[str, Config]]:
    """Return the config with each of `CONFIGS` off by its tolerance, by name."""
    tolerances: Mapping[str, float] = dict(config.calibration.tolerances)
    for name in CONFIGS:
        yield name, moved(config, {name: tolerances[name]}, 0.0).config
