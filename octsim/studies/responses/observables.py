"""The phases that a lab may watch: of the whole band, of parts of it, and of depths."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import ConfigError
from octsim.config.calibration import Band
from octsim.config.derive import calibrating
from octsim.config.models import Config
from octsim.config.processing import Processing
from octsim.phase.derivatives import Array, wrapped
from octsim.phase.estimators.series import series_phases
from octsim.phase.transform import fourier_components, optical_depths, without_source
from octsim.schemes.light import Found, Waves
from octsim.studies.sides import SIDES, side_fields

WHOLE = "whole"
COMPONENTS = 2
"""Of the Fourier transform, the strongest."""
_FEWEST = 16
"""Samples of a band."""


class Observer(NamedTuple):
    """What phases are looked for in spectra of one neuron."""

    wavenumber: Array
    """(K,), 1/µm."""
    depth: float
    """Nominal optical depth of the neuron, µm."""
    parts: tuple[NDArray[np.bool_], ...]
    """Samples of each sub-band, (K,)."""
    components: NDArray[np.int64]
    """Of the Fourier transform, that are watched, (C,)."""
    processing: Processing
    """The run's, with the calibration's estimator."""
    transform: Processing
    """The run's, for its Fourier transform."""
    power: Array | None = None
    """Of the source, (K,); None of a flat one."""

    @property
    def groups(self) -> tuple[str, ...]:
        """What each phase of a spectrum is of: the whole band, its bands, or components."""
        parts, components = len(self.parts), self.components.size
        return (WHOLE, *["bands"] * parts, *["components"] * components)

    @property
    def depths(self) -> Array:
        """Optical depths that the phases of spectra are of, (M,), µm."""
        of_components = optical_depths(self.wavenumber)[self.components]
        return np.concatenate([np.full(1 + len(self.parts), self.depth), of_components])

    def phases(self, intensity: Array) -> Array:
        """Return the phases of spectra (S, K), wrapped, rad, (S, M)."""
        k = self.wavenumber
        whole = series_phases(intensity, k, self.depth, self.processing, self.power)
        of_parts = [
            series_phases(
                intensity[:, part], k[part], self.depth, self.processing,
                None if self.power is None else self.power[part],
            )
            for part in self.parts
        ]  # fmt: skip
        bare = without_source(intensity, self.power)
        transformed = fourier_components(bare, self.transform)[:, self.components]
        return np.column_stack([whole, *of_parts, np.angle(transformed)])


def observables_of(config: Config) -> list[str]:
    """Return the names of the phases: those of spectra, then those of each side's light."""
    bands = [f"band_{number + 1}" for number in range(len(bands_of(config)))]
    components = [f"component_{number + 1}" for number in range(COMPONENTS)]
    return [WHOLE, *bands, *components, *(f"{side}_side" for side in SIDES)]


def bands_of(config: Config) -> tuple[Band, ...]:
    """Return the sub-bands, µm: those of ``expansion.bands``, or the halves of the band in k."""
    if config.expansion.bands:
        return config.expansion.bands
    whole, middle = config.spectrum.wavelength, 2 * np.pi / config.spectrum.middle
    return (whole.min, middle), (middle, whole.max)


def observer_of(config: Config, rest: Array, depth: float) -> Observer:
    """Return what is watched of a neuron whose spectrum at rest is known, (K,).

    Raises
    ------
    ConfigError
        If a band has too few samples.
    """
    k = config.spectrum.wavenumbers()
    parts = []
    for place, (least, most) in enumerate(bands_of(config)):
        part = (k >= 2 * np.pi / most * (1 - _ROUNDING)) & (
            k <= 2 * np.pi / least * (1 + _ROUNDING)
        )
        if part.sum() < _FEWEST:
            raise ConfigError(
                f"expansion.bands.{place}: {part.sum()} of spectrum.samples are in it, and "
                f"{_FEWEST} are needed; give a wider band, or more samples"
            )
        parts.append(part)
    power = config.spectrum.power()
    bare = without_source(rest[np.newaxis], power)
    magnitude = np.abs(fourier_components(bare, config.processing)[0])
    magnitude[0] = -1  # of no depth
    strongest = np.argsort(magnitude)[::-1][:COMPONENTS]
    return Observer(
        k, depth, tuple(parts), strongest, calibrating(config), config.processing, power
    )


_ROUNDING = 1e-9


def side_advances(rest: Found, moved: list[Found], wavenumber: float) -> Array:
    """Return by how much each side's light turns from rest, rad, (S, 2); NaN of rays."""
    if not isinstance(rest, Waves):
        return np.full((len(moved), len(SIDES)), np.nan)
    here = side_fields(rest, wavenumber)
    turned = [
        [np.angle(np.vdot(here[side], there[side])) for side in SIDES]
        for there in (side_fields(light, wavenumber) for light in moved)
    ]
    return wrapped(np.array(turned, float).reshape(len(moved), len(SIDES)))
