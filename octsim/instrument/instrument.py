"""A config's instrument at work: a diameter and a focus in, detected light and intensity out."""

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from octsim.base.errors import OctsimError
from octsim.base.provenance import source_digest
from octsim.base.threads import each
from octsim.config.models import Config
from octsim.config.scheme import options_of, rate_name, scheme_of, traced_keys
from octsim.instrument.build import optics_of, scene_of
from octsim.instrument.point_keys import instrument_key
from octsim.instrument.points import Points
from octsim.schemes.field_sum import spectrum_of
from octsim.schemes.light import AccuracyStatus, Found, Light, LightAt, Optics, Sampled, attenuated
from octsim.schemes.table import LIGHT_PATHS


class PointSpectrum(NamedTuple):
    """The intensity of one point over the wavenumbers."""

    intensity: NDArray[np.float64]
    """(K,); 1 is what `UNIT_OF_INTENSITY` says."""
    error: float
    """Estimate of max |ΔI| / max I."""
    status: AccuracyStatus
    """Whether that is as asked."""


class Brightness(NamedTuple):
    """Intensity of one point, as a mean over the band."""

    mean: float
    """Mean over the wavenumbers."""
    error: float
    """Estimate of its error, relative to it."""
    status: AccuracyStatus
    """Whether that is as asked."""


class Instrument:
    """What a config describes: its scene, objective, detector and scheme.

    It can be used from several threads.

    Parameters
    ----------
    config : Config
        Without a grid, or one of its combinations.
    points : Points, optional
        Where light that was found before is kept; without, all is found anew.
    """

    def __init__(self, config: Config, points: Points | None = None) -> None:
        self.config, self.scheme = config, scheme_of(config)
        self.wavenumber = config.spectrum.wavenumbers()
        """Evenly spaced wavenumbers, (K,), 1/µm."""
        self.power = config.spectrum.power()
        """Of the source at these, over its largest, (K,); None of a flat one."""
        self._points = points
        self._options = options_of(config)

    def nominal_depth(self, diameter: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the optical depth n d of neurons' far sides by the group index, all in µm."""
        return self.config.swept_group_index * diameter

    def light(self, diameter: float, focus: float) -> Found:
        """Return the detected light of a diameter at a focus, both µm."""
        light = self._light_at(diameter, focus)
        if isinstance(light, Light) and light.lengths is not None:
            middle = sum(self._optics.band) / 2
            return attenuated(light, scene_of(self.config, diameter), middle)
        return light

    def rays(self, diameter: float, focus: float) -> Light:
        """Return the detected rays of a diameter at a focus, both µm.

        Raises
        ------
        OctsimError
            If the light of this instrument's scheme is none of rays.
        """
        light = self.light(diameter, focus)
        if isinstance(light, Light):
            return light
        if isinstance(light, Sampled):
            return light.rays
        raise OctsimError(
            f"tracing.scheme: {self.scheme.name} given, whose light is no rays, which are needed "
            f"here; give tracing.scheme: {LIGHT_PATHS.name}"
        )

    def sum(self, light: Found) -> PointSpectrum:
        """Sum light of this instrument to its spectrum."""
        return self.over(light, self.wavenumber)

    def over(self, light: Found, wavenumber: NDArray[np.float64]) -> PointSpectrum:
        """Sum light of this instrument over wavenumbers (K,), 1/µm, within its band."""
        field = self.scheme.field(light, wavenumber, self._optics, self._options)
        found = PointSpectrum(*spectrum_of(field), light.status)
        spectrum = self.config.spectrum
        if spectrum.plain:
            return found
        return _recorded(found, *spectrum.recorded(found.intensity, wavenumber))

    def spectrum(self, diameter: float, focus: float) -> PointSpectrum:
        """Return the spectrum of a diameter at a focus, both µm."""
        return self.sum(self.light(diameter, focus))

    def spectra(
        self, diameters: Iterable[float], foci: Iterable[float], threads: int = 1
    ) -> NDArray[np.float64]:
        """Return the spectra (D, K) of diameters and their foci (D,), µm."""
        points = zip(np.asarray(diameters).tolist(), np.asarray(foci).tolist(), strict=True)
        return np.stack(list(each(lambda at: self.spectrum(*at).intensity, points, threads)))

    def brightness(self, light: Found) -> Brightness:
        """Return the intensity of light of this instrument, as a mean over the band."""
        intensity, error, status = self.sum(light)
        mean = float(intensity.mean())
        relative = error * float(intensity.max()) / mean if mean > 0 else error
        return Brightness(mean, relative, status)

    @cached_property
    def _optics(self) -> Optics:
        return optics_of(self.config)

    @cached_property
    def _tracer(self) -> LightAt:
        return self.scheme.tracer(self._optics, self._options)

    def _find(self, diameter: float, focus: float) -> Found:
        return self._tracer(scene_of(self.config, diameter), focus)

    @cached_property
    def _light_at(self) -> Callable[[float, float], Found]:
        if self._points is None:
            return self._find
        return self._points.keeping(self._find, self._key, rate_name(self.config))

    def _key(self) -> bytes:
        code = source_digest(
            self.scheme.module, "octsim.instrument.build", "octsim.instrument.point_entries"
        )
        return instrument_key(traced_keys(self.config), code)


def _recorded(
    found: PointSpectrum, intensity: NDArray[np.float64], brightest: float
) -> PointSpectrum:
    """Return the spectrum of a point as it is recorded, (K,), by a source of some largest power."""
    largest = float(intensity.max())
    # an error may be anywhere in the band
    scale = float(found.intensity.max() * brightest) / largest if largest > 0 else 1.0
    return PointSpectrum(intensity, found.error * scale, found.status)
