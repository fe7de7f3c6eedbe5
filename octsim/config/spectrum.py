"""The part of the config on the spectrum: its band, its samples and its source."""

from math import pi
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from octsim.config.fields import Section, Wavelength
from octsim.config.fields import key as _key
from octsim.config.source import SourceConfig, source_of
from octsim.optics.band import wavenumbers

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Wavelengths(Section):
    """The band, in vacuum."""

    min: Wavelength = _key("650 nm", "shortest wavelength")
    max: Wavelength = _key("900 nm", "longest wavelength")


class Spectrum(Section):
    """The spectrum of the source and the samples taken of it."""

    wavelength: Wavelengths = Wavelengths()
    samples: Annotated[int, Field(ge=2, le=1_000_000)] = _key(
        1000, "wavenumbers, evenly spaced, both ends included"
    )
    source: SourceConfig = _key(
        "flat",
        "its power at each wavelength: flat, {gaussian: {centre: 840 nm, fwhm: 50 nm}}, or a CSV "
        "file of wavelength and power",
    )

    def wavenumbers(self) -> "NDArray[np.float64]":
        """Return the wavenumbers 2π/λ, evenly spaced and increasing, shape (K,), 1/µm."""
        return wavenumbers(self.wavelength.min, self.wavelength.max, self.samples)

    def power(self) -> "NDArray[np.float64] | None":
        """Return the source's power at the wavenumbers, over its largest, (K,); None of a flat one.

        It is that of each sample, as a spectrometer counts: no factor dλ/dk is applied.
        """
        source = source_of(self.source)
        return None if source is None else source.power(self.wavenumbers())

    @property
    def middle(self) -> float:
        """Wavenumber in the middle of the band, 1/µm."""
        band = self.wavelength
        return (2 * pi / band.max + 2 * pi / band.min) / 2
